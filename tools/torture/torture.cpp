#include "tools/torture/torture.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "controller/runlog/replay.h"
#include "controller/step/control_step.h"
#include "model/units.h"
#include "tools/runs/safety_conformance.h"
#include "tools/torture/detection.h"

namespace flexarm {
namespace {

constexpr std::int64_t kFirstArmNs = 700 * kMs;  // the arm has been at rest for half a second
constexpr std::int64_t kRestNs = 4'000 * kMs;    // an arm without torque comes to rest
constexpr std::int64_t kEndNs = 1'500 * kMs;     // of a shutdown, beyond safety.stop_timeout_s

bool HasFaultOf(const TortureScenario& scenario, FaultPlace place) {
  return std::any_of(scenario.faults.begin(), scenario.faults.end(),
                     [place](const Fault& fault) { return fault.place == place; });
}

class Scenario {
 public:
  Scenario(const TorturedRig& rig, const TortureScenario& scenario, const Peaks& envelope,
           ActivationGuard* guard)
      : rig_(rig), scenario_(scenario), session_(rig, scenario, RulesOf(rig, scenario, envelope)) {
    session_.Watch(guard);
  }

  TortureOutcome Run() {
    out_.reached = Reach();
    if (!out_.reached) {
      session_.watch().Add(session_.now_ns(), "situation-reached",
                           std::string(ToString(scenario_.situation)) + ": it is " +
                               ToString(session_.state()) + ", " +
                               ToString(session_.stack().status().cause));
    } else {
      Trouble();
      if (scenario_.recovers) Recover();
    }
    End();
    out_.violations = session_.watch().violations();
    out_.simulated_ns = session_.now_ns();
    return std::move(out_);
  }

 private:
  static WatchRules RulesOf(const TorturedRig& rig, const TortureScenario& scenario,
                            const Peaks& envelope) {
    // Within a millisecond the drive has the permit of the tick that changed the state: the next
    // slice has no torque. With a fault of the safety thread, the permit must be too old.
    const auto permit_ns = std::llround(rig.config.safety.permit_timeout_ms * 1e6);
    Peaks most = envelope;
    if (HasFaultOf(scenario, FaultPlace::kTorque) ||
        scenario.situation == Situation::kFaultStopping) {
      most.angle_share = std::max(most.angle_share, kAngleShareWithTorqueFault);
      most.rate_share = std::max(most.rate_share, kRateShareWithTorqueFault);
    }
    return {.torque_after_ns = HasFaultOf(scenario, FaultPlace::kSafety) ? permit_ns + 2 * kMs : -1,
            .most = most,
            .angle_hidden = {HideAngle(rig.config, scenario.faults, 0),
                             HideAngle(rig.config, scenario.faults, 1)}};
  }

  bool Reach() {
    switch (scenario_.situation) {
      case Situation::kStarting:
        session_.RunUntil(scenario_.after_ns);
        return true;
      case Situation::kIdle:
        session_.RunUntil(kFirstArmNs);
        return session_.state() == SafetyState::kIdle && Wait(scenario_.after_ns);
      case Situation::kArmed:
        return Arm() && Wait(scenario_.after_ns);
      case Situation::kRunning:
        return Start() && Wait(scenario_.after_ns);
      case Situation::kStopping:
        if (!Start() || !Wait(std::llround(0.4e9 * scenario_.move_s))) return false;
        session_.Command("stop");
        return session_.RunUntilState(SafetyState::kStopping, 100 * kMs) &&
               Wait(scenario_.after_ns);
      case Situation::kDisarming:
        if (!Arm()) return false;
        session_.Command("disarm");
        return session_.RunUntilState(SafetyState::kDisarming, 100 * kMs);
      case Situation::kTripped:
        if (!Start() || !Wait(std::llround(0.4e9 * scenario_.move_s))) return false;
        session_.Press("emergency-stop", 0);
        return session_.RunUntilState(SafetyState::kTripped, 100 * kMs) && Wait(scenario_.after_ns);
      case Situation::kFaultStopping:
        return Start() && Wait(std::llround(0.4e9 * scenario_.move_s)) && session_.BreakALimit();
    }
    return false;
  }

  bool Wait(std::int64_t ns) {
    session_.RunFor(ns);
    return true;
  }

  bool Arm() {
    session_.RunUntil(kFirstArmNs);
    constexpr int kTries = 20;  // a lost frame may hide that the arm is at rest
    for (int i = 0; i < kTries && session_.state() != SafetyState::kArmed; ++i) {
      session_.Command("arm");
      session_.RunUntilAnswered(200 * kMs);
    }
    return session_.state() == SafetyState::kArmed;
  }

  bool Start() {
    if (!Arm()) return false;
    session_.RunMove();
    return session_.RunUntilState(SafetyState::kRunning, 2'000 * kMs);
  }

  void Trouble() {
    const SafetyState before = session_.state();
    out_.began_in = before;
    session_.watch().Restart();
    session_.BeginFaults();
    const std::int64_t begin_ns = session_.now_ns();
    for (const TimedCommand& command : scenario_.commands) {
      session_.RunUntil(begin_ns + std::max<std::int64_t>(command.at_ns, 0));
      session_.Send(command.text);
    }
    std::int64_t watched_ns = kWatchedNs;
    if (scenario_.is_clean()) watched_ns += std::llround(1e9 * scenario_.move_s);
    session_.RunUntil(begin_ns + watched_ns);
    // A fault that can be seen only just now has its three ticks too.
    if (const auto to_be_named = MustBeNamed(before);
        to_be_named && to_be_named->by_ns > session_.now_ns()) {
      session_.RunUntil(to_be_named->by_ns);
    }
    out_.tip_m = session_.watch().tip_m();
    const std::int64_t last_ns = session_.watch().last_torque_ns();
    if (last_ns != INT64_MIN) out_.last_torque_ns = last_ns - begin_ns;
    out_.peaks = session_.watch().peaks();
    Judge(before, begin_ns);
  }

  // What has tripped, whether it had to, and by what name.
  void Judge(SafetyState before, std::int64_t begin_ns) {
    SessionWatch& watch = session_.watch();
    if (const auto& latched = watch.first_cause()) {
      out_.cause = latched->cause;
      out_.latched_ns = latched->at_ns - begin_ns;
      if (scenario_.faults.empty()) {
        watch.Add(latched->at_ns, "no-false-trip", ToString(latched->cause));
      }
      TripCauses names = 0;
      for (const Fault& fault : scenario_.faults) names |= NamesOf(fault);
      // A sample that lacks a gauge and one whose frame is lost are two without a reading.
      if (LosesFrames()) names |= CauseBit(TripCause::kNoCounterReading);
      if (!scenario_.faults.empty() && (CauseBit(latched->cause) & names) == 0) {
        watch.Add(latched->at_ns, "named-rightly", ToString(latched->cause));
      }
    }
    const auto to_be_named = MustBeNamed(before);
    if (!to_be_named) return;
    const auto [seen_ns, by_ns] = *to_be_named;
    out_.observable_ns = seen_ns - begin_ns;
    const bool in_time = out_.latched_ns != INT64_MAX && begin_ns + out_.latched_ns <= by_ns;
    if (!in_time) {
      watch.Add(seen_ns, "named-in-time",
                Text(session_.faults().front()) + ": " +
                    (out_.latched_ns == INT64_MAX
                         ? std::string("no trip")
                         : "after " + std::to_string((begin_ns + out_.latched_ns - seen_ns) / kMs) +
                               " ms"));
    }
  }

  struct ToBeNamed {
    std::int64_t seen_ns;  // since when the fault can be seen
    std::int64_t by_ns;    // until when it must have latched
  };
  // Of a session with one fault; nothing: it need not be named.
  std::optional<ToBeNamed> MustBeNamed(SafetyState before) {
    if (scenario_.faults.size() != 1) return std::nullopt;
    const Fault& fault = session_.faults().front();
    const std::int64_t within_ns = NamedWithinNs(rig_.config, fault);
    if (within_ns == INT64_MAX || CauseLatched(before) || before == SafetyState::kStarting) {
      return std::nullopt;
    }
    const bool is_reading = fault.place <= FaultPlace::kFrame;
    const std::int64_t seen_ns = is_reading ? session_.stack().seen_ns() : fault.from_ns;
    if (seen_ns == INT64_MAX) return std::nullopt;
    std::int64_t by_ns = seen_ns + within_ns + scenario_.wake_ups.latest_ns + kMs;
    const std::int64_t granted_ns = session_.watch().granted_ns();
    if (fault.place == FaultPlace::kCounter && IsAlone(rig_.config, fault.index)) {
      // One frame shows it, to a loop that has seen the one before; a hub that stands still without
      // a torque may be held.
      const bool forgotten = granted_ns != INT64_MIN && granted_ns >= seen_ns && granted_ns < by_ns;
      const bool may_be_held = fault.kind == FaultKind::kStuck &&
                               session_.watch().last_torque_ns() < by_ns &&
                               !session_.watch().first_cause();
      if (forgotten || may_be_held) return std::nullopt;
    }
    if (is_reading && granted_ns >= seen_ns && granted_ns < by_ns) {
      // The loop forgets all samples in the first one of a run.
      by_ns += granted_ns + rig_.config.loop.period_ns() - seen_ns;
    }
    if (fault.to_ns < by_ns) return std::nullopt;
    return ToBeNamed{.seen_ns = seen_ns, .by_ns = by_ns};
  }

  // From every state there is a way back to Idle.
  void Recover() {
    session_.EndFaults();
    session_.RunFor(100 * kMs);
    if (session_.state() != SafetyState::kTripped) {
      session_.Command("stop");
      session_.RunFor(std::max(kRestNs, StopTimeoutNs()));
      session_.Command("disarm");
      session_.RunUntilState(SafetyState::kIdle, 300 * kMs);
    }
    if (session_.state() == SafetyState::kTripped) LeaveTripped();
    // Beyond a limit switch a person must move the arm first.
    if (session_.state() != SafetyState::kIdle && !BeyondLimit()) {
      session_.watch().Add(session_.now_ns(), "way-back", ToString(session_.state()));
    }
  }

  // docs/safety.md, "After a trip".
  void LeaveTripped() {
    session_.Press("emergency-stop", 1);
    session_.RunFor(kRestNs);
    session_.Press("reset-button", 1);
    session_.RunFor(100 * kMs);
    session_.watch().ButtonPressed();
    session_.Press("reset-button", 0);
    session_.RunFor(100 * kMs);
    // A link may swing for long, an elbow in its backlash for longer.
    constexpr int kTries = 60;
    for (int i = 0; i < kTries && session_.state() != SafetyState::kIdle; ++i) {
      session_.Command("reset");
      session_.RunUntilAnswered(3'000 * kMs);
      if (session_.state() == SafetyState::kIdle) return;
      session_.RunFor(1'000 * kMs);
      if (i % 5 == 1) ZeroWhereItStands();
    }
  }

  // Counts that were wrong for a time may have lost turns: a person measures the angles.
  void ZeroWhereItStands() {
    const PlantTruth truth = session_.stack().arm().rig().truth();
    session_.Send(nlohmann::json{
        {"command", "zero"},
        {"angle_deg", {truth.hub_angle_rad[0] / kRadPerDeg, truth.hub_angle_rad[1] / kRadPerDeg}}}
                      .dump());
    session_.RunUntilAnswered(10'000 * kMs);
  }

  std::int64_t StopTimeoutNs() const {
    return std::llround(1e9 * rig_.config.safety.stop_timeout_s);
  }

  bool LosesFrames() const {
    return std::any_of(scenario_.plant.begin(), scenario_.plant.end(), [](const std::string& set) {
      return set.starts_with("sim.lost_frame_fraction");
    });
  }

  bool BeyondLimit() {
    const PlantTruth truth = session_.stack().arm().rig().truth();
    const std::array<double, 2> limit_rad = SoftAngleRad(rig_.config.safety);
    return std::fabs(truth.hub_angle_rad[0]) > limit_rad[0] ||
           std::fabs(truth.hub_angle_rad[1]) > limit_rad[1];
  }

  void End() {
    const bool stuck =
        HasFaultOf(scenario_, FaultPlace::kOperator) || HasFaultOf(scenario_, FaultPlace::kSafety);
    const bool answered = session_.RunUntilAnswered(20'000 * kMs);
    if (!stuck && !answered) {
      session_.watch().Add(session_.now_ns(), "each-command-is-answered",
                           std::to_string(session_.sent()) + " sent, " +
                               std::to_string(session_.answered()) + " answered");
    }
    const std::int64_t limit_ns = StopTimeoutNs() + kEndNs;
    const bool done = session_.ShutDown(limit_ns);
    if (!done && !stuck) {
      session_.watch().Add(session_.now_ns(), "ends",
                           "not within " + std::to_string(limit_ns / kMs) + " ms");
    }
    if (!stuck && session_.stack().Sample().told.relay_closed) {
      session_.watch().Add(session_.now_ns(), "ends", "the relay is closed at the end");
    }
    session_.Finish();
    CheckLogs();
  }

  void CheckLogs() {
    if (session_.log_errors() != 0) {
      session_.watch().Add(session_.now_ns(), "log-complete",
                           std::to_string(session_.log_errors()) + " errors");
    }
    for (const RunContents& run : session_.runs()) {
      CheckReplay(run);
      CheckTable(run);
    }
  }

  // By the transition table of docs/safety.md, not by the product's code.
  void CheckTable(const RunContents& run) {
    // While the thread of bus and drives stands, so does the arm: what acts then belongs to earlier
    // instants. SessionWatch judges torque in the arm's time.
    const bool arm_stands = HasFaultOf(scenario_, FaultPlace::kPlant);
    for (const ConformanceCheck& check : CheckSafety(run, rig_.config)) {
      if (check.passed || (arm_stands && check.name == "torque-only-where-allowed")) continue;
      session_.watch().Add(session_.now_ns(), "obeys-the-table", check.name + ": " + check.detail);
    }
  }

  void CheckReplay(const RunContents& run) {
    ControlStep step(rig_.config, rig_.design);
    Replay replay([&step](const StepInput& input) { return step.Step(input); }, false);
    for (const TickRecord& tick : run.tick) replay.Tick(tick);
    for (const SafetyRecord& record : run.safety) replay.Safety(record);
    const ReplayResult result = replay.Result();
    out_.records += result.ticks;
    const bool loop_stands = HasFaultOf(scenario_, FaultPlace::kControl);
    if (!result.bit_exact.value_or(true) || !result.safety_exact.value_or(true)) {
      session_.watch().Add(session_.now_ns(), "replay-is-exact",
                           "tick " + std::to_string(result.first_different_tick.value_or(-1)));
    }
    if (result.first_gap_tick && !loop_stands) {
      session_.watch().Add(session_.now_ns(), "log-complete",
                           "tick " + std::to_string(*result.first_gap_tick) + " is missing");
    }
  }

  const TorturedRig& rig_;
  const TortureScenario& scenario_;
  TortureSession session_;
  TortureOutcome out_;
};

}  // namespace

TorturedRigs::TorturedRigs(const std::function<RigConfig(const std::string& law)>& with_law,
                           const std::vector<std::string>& laws) {
  for (const std::string& law : laws) rigs_.try_emplace(law, with_law(law));
}

TortureOutcome RunScenario(const TorturedRigs& rigs, const TortureScenario& scenario,
                           const Peaks& envelope, ActivationGuard* guard) {
  return Scenario(rigs.Of(scenario.law), scenario, envelope, guard).Run();
}

}  // namespace flexarm
