#include "tools/torture/session_watch.h"

#include <algorithm>
#include <cmath>

#include "controller/types/loop_grid.h"
#include "model/units.h"

namespace flexarm {
namespace {

constexpr std::size_t kMostViolations = 8;  // kept of a session: the first tell enough
constexpr double kRounding = 1e-9;
constexpr std::size_t kKept = 4096;  // milliseconds: a thread of the arm may hang for as long

}  // namespace

void Raise(const Peaks& by, Peaks* most) {
  most->torque_share = std::max(most->torque_share, by.torque_share);
  most->angle_share = std::max(most->angle_share, by.angle_share);
  most->rate_share = std::max(most->rate_share, by.rate_share);
  most->strain_share = std::max(most->strain_share, by.strain_share);
}

void SessionWatch::Add(std::int64_t at_ns, const char* rule, const std::string& what) {
  if (violations_.size() < kMostViolations) {
    violations_.push_back({.at_ns = at_ns, .rule = rule, .what = what});
  }
}

void SessionWatch::Look(std::int64_t now_ns, const WatchSample& sample) {
  const bool before = forbidden_since_ns_.empty() || forbidden_since_ns_.back() == INT64_MAX;
  const std::int64_t tick_ns =
      now_ns - kMs + phase_ns_;  // the tick of the safety task that is seen
  const std::int64_t since_ns = before ? tick_ns : forbidden_since_ns_.back();
  if (forbidden_since_ns_.size() == kKept) forbidden_since_ns_.pop_front();
  forbidden_since_ns_.push_back(TorqueAllowed(sample.status.state) ? INT64_MAX : since_ns);
  LookAtTorque(now_ns, sample);
  LookAtArm(now_ns, sample);
  LookAtState(now_ns, sample);
}

void SessionWatch::LookAtTorque(std::int64_t now_ns, const WatchSample& sample) {
  const std::array<double, 2>& torque_nm = sample.torque_nm;
  // An arm whose thread catches up may take several commands between two looks, and may be without
  // power for a moment.
  const std::int64_t moved_ns = std::max(sample.arm_ns - arm_ns_, kMs);
  const bool unseen = moved_ns > kMs;
  const double commands =
      std::ceil(static_cast<double>(moved_ns) / static_cast<double>(config_.loop.period_ns()));
  // The torque of a slice acts from its begin on; the newest look is at the millisecond before now.
  const std::int64_t slice_ns = sample.arm_ns - kMs;
  const auto back =
      static_cast<std::size_t>((now_ns - kMs - std::max<std::int64_t>(slice_ns, 0)) / kMs);
  const std::size_t newest = forbidden_since_ns_.size() - 1;
  const std::int64_t since_ns = forbidden_since_ns_[newest - std::min(back, newest)];
  const bool allowed = since_ns == INT64_MAX || slice_ns - since_ns <= rules_.torque_after_ns;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string joint = "joint " + std::to_string(i + 1) + ": ";
    const double torque = torque_nm[i];
    if (!std::isfinite(torque)) Add(now_ns, "finite-torque", joint + "not a number");
    if (torque != 0.0) last_torque_ns_ = now_ns;
    if (torque != 0.0 && !allowed) {
      Add(now_ns, "torque-only-while-permitted",
          joint + std::to_string(torque) + " N m in " + ToString(sample.status.state));
    }
    const double limit_nm = config_.safety.torque_limit_nm[i];
    peaks_.torque_share = std::max(peaks_.torque_share, std::fabs(torque) / limit_nm);
    if (std::fabs(torque) > limit_nm + kRounding) {
      Add(now_ns, "torque-limit", joint + std::to_string(torque) + " N m");
    }
    const double most_nm =
        commands * config_.safety.slew_limit_nm_per_s[i] * config_.loop.period_s();
    const double from_nm =
        unseen && std::fabs(torque) < std::fabs(torque - torque_nm_[i]) ? 0.0 : torque_nm_[i];
    if (torque != 0.0 && std::fabs(torque - from_nm) > most_nm + kRounding) {
      Add(now_ns, "slew-limit",
          joint + "from " + std::to_string(torque_nm_[i]) + " to " + std::to_string(torque));
    }
  }
  torque_nm_ = torque_nm;
}

void SessionWatch::Over(std::int64_t now_ns, const char* what, double share, double most,
                        double* peak) {
  if (!std::isfinite(share)) Add(now_ns, "finite-arm", std::string(what) + " is not a number");
  *peak = std::max(*peak, share);
  if (share > most) {
    Add(now_ns, "envelope",
        std::string(what) + " " + std::to_string(share) + " times its limit, permitted " +
            std::to_string(most));
  }
}

void SessionWatch::LookAtArm(std::int64_t now_ns, const WatchSample& sample) {
  const PlantTruth& truth = sample.truth;
  tip_m_.push_back(truth.tip_m);
  if (!std::isfinite(truth.hub_angle_rad[0] + truth.hub_angle_rad[1])) {
    Add(now_ns, "finite-arm", "the simulated arm is not a number");
  }
  // An arm whose thread catches up moves many milliseconds in one.
  if (sample.arm_ns != arm_ns_ + kMs) hub_rad_.clear();
  arm_ns_ = sample.arm_ns;
  const auto period = static_cast<std::size_t>(config_.loop.period_ns() / kMs);
  hub_rad_.push_back(truth.hub_angle_rad);
  if (hub_rad_.size() > period + 1) hub_rad_.pop_front();
  const std::int64_t acts_ns = config_.loop.period_ns();
  const bool torque_acts = last_torque_ns_ == now_ns;
  if (last_torque_ns_ == INT64_MIN || now_ns - last_torque_ns_ > acts_ns) return;  // it coasts
  for (std::size_t i = 0; i < 2; ++i) {
    const double limit_rad = config_.safety.soft_angle_deg[i] * kRadPerDeg;
    if (torque_acts && !rules_.angle_hidden[i]) {
      Over(now_ns, "hub angle", std::fabs(truth.hub_angle_rad[i]) / limit_rad,
           rules_.most.angle_share, &peaks_.angle_share);
    }
    // Over a whole period, as the loop sees it: a joint that springs back swings faster for a
    // moment.
    if (hub_rad_.size() <= period) continue;
    const double turned_rad = truth.hub_angle_rad[i] - hub_rad_.front()[i];
    const double rate_rad_s = turned_rad / (static_cast<double>(hub_rad_.size() - 1) * 1e-3);
    Over(now_ns, "hub rate", std::fabs(rate_rad_s) / config_.safety.hub_rate_rad_s[i],
         rules_.most.rate_share, &peaks_.rate_share);
  }
  Over(now_ns, "strain", sample.strain_share, rules_.most.strain_share, &peaks_.strain_share);
}

void SessionWatch::LookAtState(std::int64_t now_ns, const WatchSample& sample) {
  using enum SafetyState;
  const SafetyStatus& status = sample.status;
  const SafetyState before = status_.state;
  const bool changed = status != status_;
  if (CauseLatched(status.state) && !CauseLatched(before) && !first_cause_) {
    first_cause_ = Latched{.cause = status.cause, .at_ns = now_ns};
  }
  if (status.state == kTripped && sample.told.relay_closed) {
    Add(now_ns, "trip-opens-the-relay", "Tripped with the relay told to be closed");
  }
  if (changed && before == kTripped) {
    const bool may = status.state == kIdle && button_ && TakeSent("reset");
    if (!may) Add(now_ns, "latched", std::string("left Tripped to ") + ToString(status.state));
    button_ = false;
  }
  if (changed && before == kFaultStopping && status.state != kTripped) {
    Add(now_ns, "latched", std::string("left FaultStopping to ") + ToString(status.state));
  }
  if (changed && before == kIdle && DrivesEnabled(status.state) && !TakeSent("arm")) {
    Add(now_ns, "arms-by-itself", "no arm was sent");
  }
  if (changed && status.state == kRunning) granted_ns_ = now_ns;
  if (changed && status.state == kRunning && !(before == kArmed && TakeSent("run"))) {
    Add(now_ns, "runs-by-itself", std::string("from ") + ToString(before));
  }
  if (status.state == kTripped && before != kTripped) button_ = false;
  status_ = status;
}

}  // namespace flexarm
