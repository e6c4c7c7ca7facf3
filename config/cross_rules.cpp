#include "config/cross_rules.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "config/derivation/sensor_scales.h"
#include "estimator/polynomial_fit.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

std::string At(std::string_view key, std::size_t i) { return ProblemList::Element(key, i); }

// True for a whole number of steps; 1e-9 allows for the rounding of decimal fractions.
bool IsMultiple(double value, double step) {
  const double steps = value / step;
  return std::abs(steps - std::nearbyint(steps)) <= 1e-9 * std::max(1.0, steps);
}

void CheckChannelsForFit(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  if (!log->Clear({"sensors.strain", "estimator.modes_per_link", "estimator.name"})) return;
  for (int link = 1; link <= 2; ++link) {
    std::vector<double> positions;
    for (const StrainChannelConfig& s : c.sensors.strain) {
      if (s.link == link) positions.push_back(s.position_m);
    }
    std::sort(positions.begin(), positions.end());
    positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
    if (c.estimator.kind == EstimatorKind::kPolynomial && positions.size() < kPolynomialTerms) {
      out->push_back({"estimator.name", "polynomial",
                      "needs strain at five different positions a link, for its five coefficients: "
                      "link " +
                          NumberText(link) + " has " + NumberText(positions.size())});
    }
    if (positions.size() >= static_cast<std::size_t>(c.estimator.modes_per_link)) continue;
    out->push_back({"estimator.modes_per_link", NumberText(c.estimator.modes_per_link),
                    "must be at most the number of different strain positions of a link: link " +
                        NumberText(link) + " has " + NumberText(positions.size())});
  }
}

// Only what is measured can be differentiated: the Kalman filter estimates the rest.
void CheckNominalModel(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  constexpr const char* kKey = "controller.nominal";
  if (!log->Clear({kKey, "estimator.modes_per_link", "estimator.name", "sensors.encoder"})) return;
  const StateLayout& nominal = c.controller.nominal;
  const bool differentiates = c.estimator.kind == EstimatorKind::kDifference ||
                              c.estimator.kind == EstimatorKind::kPolynomial;
  if (nominal.modes_per_link > c.estimator.modes_per_link && differentiates) {
    out->push_back({kKey, std::string(NameOf(nominal)),
                    "has " + NumberText(nominal.modes_per_link) +
                        " modes a link: with this estimator.name, estimator.modes_per_link = " +
                        NumberText(c.estimator.modes_per_link) +
                        " must be at least as many; \"kalman\" estimates the others"});
  }
  constexpr unsigned kRotors = 0b1100;
  if (nominal.torsion && c.estimator.kind != EstimatorKind::kKalman &&
      c.estimator.kind != EstimatorKind::kIdeal &&
      (c.sensors.counters_present() & kRotors) != kRotors) {
    out->push_back({kKey, std::string(NameOf(nominal)),
                    "has rotor angles: without an encoder on each rotor only estimator.name = "
                    "\"kalman\" can estimate them"});
  }
}

void CheckStateWeight(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  constexpr const char* kKey = "controller.state_weight";
  if (!log->Clear({kKey, "controller.nominal"}) || c.controller.state_weight.empty()) return;
  const auto states = static_cast<std::size_t>(c.controller.nominal.states());
  if (c.controller.state_weight.size() == states) return;
  out->push_back(
      {kKey, NumberText(c.controller.state_weight.size()) + " numbers",
       "must have one weight for each state of controller.nominal: " + NumberText(states)});
}

void CheckPayloadStart(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  constexpr const char* kKey = "estimator.payload.start_kg";
  if (!c.estimator.payload || !log->Clear({kKey, "estimator.payload.max_kg"})) return;
  const PayloadEstimatorConfig& payload = *c.estimator.payload;
  if (payload.start_kg <= payload.max_kg) return;
  out->push_back({kKey, NumberText(payload.start_kg),
                  "must be at most estimator.payload.max_kg = " + NumberText(payload.max_kg) +
                      ": the estimate stays within it"});
}

// The model of the filter has two modes a link and rigid joints.
void CheckPayloadEstimator(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  if (!log->Clear({"controller.name", "estimator.name", "controller.nominal"})) return;
  const bool by_law = IsScheduled(c.controller.kind);
  if (!c.uses_payload_estimator()) return;
  const char* key = by_law ? "controller.name" : "estimator.name";
  const bool plans = PlansAhead(c.controller.kind);
  const char* value = by_law ? LawOf(c.controller.kind).name : "ekf-payload";
  const auto require = [&](bool ok, const char* rule) {
    if (!ok) out->push_back({key, value, rule});
  };
  require(c.estimator.kind != EstimatorKind::kIdeal,
          "estimates the payload, which estimator.name = \"ideal\" does not give");
  require(c.estimator.payload.has_value(), "needs the table [estimator.payload]");
  require(!by_law || c.controller.payload.has_value(), "needs the table [controller.payload]");
  require(!plans || c.controller.plan.has_value(), "needs the table [controller.plan]");
  require(c.controller.nominal == kR12, "needs controller.nominal = \"R12\", the filter's model");
}

// Otherwise the friction would hold and release the arm in turn.
void CheckSettling(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  constexpr const char *kHold = "controller.settling.hold_below_mm",
                       *kRelease = "controller.settling.release_above_mm";
  if (!log->Clear({kHold, kRelease}) || !c.controller.settling) return;
  const SettlingConfig& s = *c.controller.settling;
  if (s.release_above_mm >= s.hold_below_mm) return;
  out->push_back(
      {kRelease, NumberText(s.release_above_mm),
       "must be at least controller.settling.hold_below_mm = " + NumberText(s.hold_below_mm)});
}

// No backend of a hardware rig can read this sensor. Without the noise term for the error of the
// model the filter would give its reading too much weight.
void CheckTipAccelerometer(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  constexpr const char* kTable = "sensors.tip_accelerometer";
  if (!c.sensors.tip_accelerometer) return;
  if (log->Clear({kTable, "hal.backend"}) && c.backend == "wired") {
    out->push_back(
        {kTable, "a table",
         "must be absent with hal.backend = \"wired\": only the simulated rig has this sensor"});
  }
  if (!log->Clear({kTable, "estimator.payload"}) || !c.estimator.payload) return;
  if (c.estimator.payload->tip_extra_sigma_m_s2) return;
  out->push_back({kTable, "a table",
                  "needs the key estimator.payload.tip_extra_sigma_m_s2: the noise for effects "
                  "that the filter's model lacks"});
}

// Between two samples a counter must move by less than half its range, or its direction is
// ambiguous.
void CheckCounters(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  constexpr std::string_view kKey = "estimator.max_joint_rate_rad_s";
  if (!log->Clear({kKey, "loop.period_ms", "sensors.encoder"})) return;
  double slowest = std::numeric_limits<double>::infinity();
  std::size_t row = 0;
  for (std::size_t i = 0; i < c.sensors.encoder.size(); ++i) {
    const EncoderConfig& e = c.sensors.encoder[i];
    const double rate = AmbiguousRate_rad_s(e, c.loop.period_s());
    if (rate < slowest) row = i;
    slowest = std::min(slowest, rate);
  }
  if (c.estimator.max_joint_rate_rad_s < slowest) return;
  out->push_back(
      {std::string(kKey), NumberText(c.estimator.max_joint_rate_rad_s),
       "must be below " + NumberText(std::floor(100.0 * slowest) / 100.0) +
           ": there the counter of " + At("sensors.encoder", row) + " (" +
           NumberText(c.sensors.encoder[row].counter_bits) +
           " bits) moves by half its range in a period, so that its direction is ambiguous"});
}

void CheckRates(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string limit = At("limits.hub_rate_rad_s", i);
    if (!log->Clear({"estimator.max_joint_rate_rad_s", limit})) continue;
    if (c.estimator.max_joint_rate_rad_s > c.safety.hub_rate_rad_s[i]) continue;
    out->push_back({limit, NumberText(c.safety.hub_rate_rad_s[i]),
                    "must be below estimator.max_joint_rate_rad_s = " +
                        NumberText(c.estimator.max_joint_rate_rad_s) +
                        ", or an allowed motion counts as an impossible jump"});
  }
}

void CheckAnglesAndTorques(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string angle = At("limits.soft_angle_deg", i);
    const double switch_deg = c.sim.switch_angle_deg[i];
    if (log->Clear({angle, At("sim.switch_angle_deg", i)}) &&
        c.safety.soft_angle_deg[i] >= switch_deg) {
      out->push_back({angle, NumberText(c.safety.soft_angle_deg[i]),
                      "must be below sim.switch_angle_deg[" + NumberText(i) +
                          "] = " + NumberText(switch_deg) +
                          ": the soft limit must act before the limit switch"});
    }
    const std::string torque = At("limits.torque_limit_nm", i);
    const std::string friction = "joint" + NumberText(i + 1) + ".coulomb_friction_nm";
    const double friction_nm = c.arm.joint[i].coulomb_friction_nm;
    if (log->Clear({torque, friction}) && c.safety.torque_limit_nm[i] <= friction_nm) {
      out->push_back({torque, NumberText(c.safety.torque_limit_nm[i]),
                      "must exceed " + friction + " = " + NumberText(friction_nm) +
                          ", or the joint never moves"});
    }
  }
}

void CheckStrainLimits(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  if (!log->Clear({"sensors.strain", "sensors.strain_input"})) return;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string key = At("limits.strain_limit", i);
    if (!log->Clear({key})) continue;
    for (std::size_t row = 0; row < c.sensors.strain.size(); ++row) {
      const StrainChannelConfig& channel = c.sensors.strain[row];
      const double full_scale = FullScaleStrain(c.sensors, channel);
      if (channel.link != static_cast<int>(i) + 1 || c.safety.strain_limit[i] < full_scale)
        continue;
      out->push_back({key, NumberText(c.safety.strain_limit[i]),
                      "must be below the full scale of every channel of the link, or the amplifier "
                      "saturates before the trip: " +
                          At("sensors.strain", row) + " ends at " + NumberText(full_scale)});
      break;  // one channel is enough for the message
    }
  }
}

void CheckStrainJudgement(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  if (!log->Clear({"sensors.strain", "sensors.strain_input"})) return;
  const double noise = StrainNoise(c.sensors);
  const auto require = [&](const char* key, double value) {
    if (!log->Clear({key}) || value >= 4.0 * noise) return;
    out->push_back({key, NumberText(value),
                    "must be at least four times the noise of a strain channel, " +
                        NumberText(noise) + ", or healthy channels are reported as faulty"});
  };
  require("estimator.strain_family_limit", c.estimator.strain_family_limit);
  require("estimator.strain_stuck_limit", c.estimator.strain_stuck_limit);
}

void CheckGrid(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  const auto require = [&](const char* key, double value) {
    if (!log->Clear({key, "sim.step_ms"}) || IsMultiple(value, c.sim.step_ms)) return;
    out->push_back({key, NumberText(value),
                    "must be a whole number of sim.step_ms = " + NumberText(c.sim.step_ms) +
                        ": the plant is sampled and actuated only between its steps"});
  };
  require("loop.period_ms", c.loop.period_ms);
  require("loop.acquire_before_ms", c.loop.acquire_before_ms);
}

// A frame is complete when its last strain channel has been sampled; each millisecond of the plant
// is integrated after it has passed.
void CheckSkew(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  if (!log->Clear({"sim.channel_skew_us", "loop.acquire_before_ms", "sensors.strain"})) return;
  if (c.sim.channel_skew_us <= 0.0) return;
  const double last_ms =
      1e-3 * c.sim.channel_skew_us * static_cast<double>(c.sensors.strain.size() - 1);
  if (last_ms + 2.0 <= c.loop.acquire_before_ms) return;
  out->push_back(
      {"sim.channel_skew_us", NumberText(c.sim.channel_skew_us),
       "must be so small that the last strain channel is sampled 2 ms before the step is due: " +
           NumberText(last_ms) + " + 2 <= loop.acquire_before_ms = " +
           NumberText(c.loop.acquire_before_ms) + " does not hold"});
}

// The simulated drive accepts a command every millisecond. A bus writes a torque in its exchange.
void CheckOutput(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  const auto require = [&](const char* key, double value) {
    if (!log->Clear({key}) || IsMultiple(value, 1.0)) return;
    out->push_back(
        {key, NumberText(value),
         "must be whole milliseconds: the simulated drive accepts one torque per millisecond"});
  };
  require("sim.transport_delay_ms", c.sim.transport_delay_ms);
  if (c.backend != "wired") {
    if (c.loop.output == OutputTiming::kAtOnce)
      require("loop.output_after_ms", c.loop.output_after_ms);
    return;
  }
  if (!log->Clear({"loop.output"}) || c.loop.output == OutputTiming::kNextTick) return;
  out->push_back({"loop.output", "\"at_once\"",
                  "must be \"next_tick\" with hal.backend = \"wired\": a bus writes and reads in "
                  "one exchange, at the sampling instant"});
}

// A simulated arm in process does not trip on late threads. Where metal moves, a permit that a
// drive may have found too old must trip, and so must one failure in ten, whatever its pattern.
void CheckTimingLimits(const RigConfig& c, ProblemLog* log, std::vector<Problem>* out) {
  if (!log->Clear({"hal.backend"}) || c.backend != "wired") return;
  constexpr const char* kOverrun = "safety.overrun_to_trip_ms";
  if (log->Clear({kOverrun, "safety.permit_timeout_ms"}) &&
      !(c.safety.overrun_to_trip_ms <= c.safety.permit_timeout_ms)) {
    out->push_back(
        {kOverrun, NumberText(c.safety.overrun_to_trip_ms),
         "must be at most safety.permit_timeout_ms = " + NumberText(c.safety.permit_timeout_ms) +
             " with hal.backend = \"wired\": after a longer stall the drives have "
             "lost their torque, and only a reset may give it back"});
  }
  const auto require_a_tenth = [&](const char* key, int limit) {
    if (!log->Clear({key, "safety.window_periods"})) return;
    if (10 * limit <= c.safety.window_periods) return;
    out->push_back({key, NumberText(limit),
                    "must be at most a tenth of safety.window_periods = " +
                        NumberText(c.safety.window_periods) +
                        " with hal.backend = \"wired\": one in ten must trip"});
  };
  require_a_tenth("safety.missed_deadlines_in_window", c.safety.missed_deadlines_in_window);
  require_a_tenth("safety.failed_exchanges_in_window", c.safety.failed_exchanges_in_window);
  require_a_tenth("safety.slow_exchanges_in_window", c.safety.slow_exchanges_in_window);
}

}  // namespace

void CheckCrossRules(const RigConfig& config, ProblemLog* log) {
  std::vector<Problem> problems;
  CheckChannelsForFit(config, log, &problems);
  CheckNominalModel(config, log, &problems);
  CheckStateWeight(config, log, &problems);
  CheckPayloadStart(config, log, &problems);
  CheckPayloadEstimator(config, log, &problems);
  CheckSettling(config, log, &problems);
  CheckTipAccelerometer(config, log, &problems);
  CheckCounters(config, log, &problems);
  CheckRates(config, log, &problems);
  CheckAnglesAndTorques(config, log, &problems);
  CheckStrainLimits(config, log, &problems);
  CheckStrainJudgement(config, log, &problems);
  CheckGrid(config, log, &problems);
  CheckSkew(config, log, &problems);
  CheckOutput(config, log, &problems);
  CheckTimingLimits(config, log, &problems);
  log->AddRules(problems);
}

}  // namespace flexarm
