#include "tools/runs/safety_conformance.h"

#include <cmath>
#include <functional>

#include "controller/safety/transition_table.h"

namespace flexarm {
namespace {

std::string Text(const SafetyStatus& status) {
  std::string text = ToString(status.state);
  if (status.cause != TripCause::kNone) text += std::string(" (") + ToString(status.cause) + ")";
  return text;
}

// Of the row that requires the decision.
std::string Text(const TableRow& row) {
  return "row " + std::string(row.from) + ", " + std::string(row.when) + ": " + std::string(row.to);
}

// In the time of the log.
double TimeOf(const RunContents& run, std::int64_t time_ns) {
  return static_cast<double>(time_ns - run.info.start_ns) * 1e-9;
}

// What is wrong with a record, given the one before it; empty if nothing is.
using RecordRule = std::function<std::string(const SafetyRecord* before, const SafetyRecord& now)>;

ConformanceCheck ForEveryRecord(const std::string& name, const RunContents& run,
                                const RecordRule& rule) {
  const auto& records = run.safety;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const std::string wrong = rule(i > 0 ? &records[i - 1] : nullptr, records[i]);
    if (wrong.empty()) continue;
    const double time_s = TimeOf(run, records[i].due_ns);
    return {name, false, "record " + std::to_string(i + 1) + ": " + wrong, time_s,
            static_cast<std::int64_t>(i) + 1};
  }
  return {name, true, ""};
}

std::string ObeysTable(const SafetyRecord*, const SafetyRecord& now) {
  const TableVerdict table = ApplyTable(now.before, now.facts);
  if (now.after != table.decision.status) {
    const std::string rule = table.transition < kTransitions
                                 ? Text(kTransitionRows[table.transition])
                                 : "no row holds: the state stays";
    return Text(now.before) + " to " + Text(now.after) + ", request " +
           ToString(now.facts.request) + "; the table requires " + Text(table.decision.status) +
           " (" + rule + ")";
  }
  if (now.refusal == table.decision.refusal) return "";
  const std::string rule = table.refusal < kRefusals ? Text(kRefusalRows[table.refusal])
                                                     : "no row holds: refused if there is one";
  return std::string("request ") + ToString(now.facts.request) + " in " + Text(now.before) +
         " has the answer " + ToString(now.refusal) + "; the table requires " +
         ToString(table.decision.refusal) + " (" + rule + ")";
}

std::string FollowsTheOneBefore(const SafetyRecord* before, const SafetyRecord& now) {
  if (before == nullptr) return "";
  if (now.due_ns <= before->due_ns) return "not later than the one before";
  if (now.before == before->after) return "";
  return "begins in " + Text(now.before) + ", the one before ended in " + Text(before->after);
}

std::string TripStaysLatched(const SafetyRecord*, const SafetyRecord& now) {
  if (!CauseLatched(now.before.state)) return "";
  const bool reset = now.before.state == SafetyState::kTripped &&
                     now.facts.request == RequestKind::kReset && now.facts.reset_pressed != 0 &&
                     now.facts.at_rest != 0 && now.facts.present == 0;
  if (CauseLatched(now.after.state)) {
    if (TorqueAllowed(now.after.state) && !TorqueAllowed(now.before.state)) {
      return "torque after a trip";
    }
    return now.after.cause == now.before.cause ? "" : "another cause than the first is latched";
  }
  if (!reset) return "a trip ends without the button and the operator's reset";
  return now.after.state == SafetyState::kIdle ? "" : "a reset leads to " + Text(now.after);
}

std::string RunningWasGranted(const SafetyRecord*, const SafetyRecord& now) {
  const bool begins =
      now.after.state == SafetyState::kRunning && now.before.state != SafetyState::kRunning;
  if (!begins) return "";
  if (now.facts.request != RequestKind::kRun || now.refusal != Refusal::kNone) {
    return "Running begins without a granted run";
  }
  return now.request_number != 0 ? "" : "the granted run has no number";
}

using StateRule = std::function<bool(SafetyState state)>;

// The states that the records give. The ends of the intervals must be asked in the order of time.
class RecordedStates {
 public:
  explicit RecordedStates(const std::vector<SafetyRecord>& records) : records_(records) {}

  // A state of the rule held at some instant in [from_ns, end_ns).
  bool AnyHeld(std::int64_t from_ns, std::int64_t end_ns, const StateRule& rule) {
    while (next_ < records_.size() && records_[next_].due_ns < end_ns) ++next_;
    for (std::size_t i = next_; i > 0; --i) {
      if (rule(records_[i - 1].after.state)) return true;
      if (records_[i - 1].due_ns <= from_ns) return false;
    }
    return rule(records_.front().before.state);
  }

 private:
  const std::vector<SafetyRecord>& records_;
  std::size_t next_ = 0;  // the first that is not before the end
};

std::int64_t PermitTimeoutNs(const RigConfig& config) {
  return std::llround(1e6 * config.safety.permit_timeout_ms);
}

// What is wrong with a tick; empty if nothing is.
using RuleOfTick = std::function<std::string(const TickRecord& tick)>;

ConformanceCheck ForEachTickOf(const std::string& name, const RunContents& run,
                               const RuleOfTick& rule) {
  for (const TickRecord& tick : run.tick) {
    const std::string wrong = rule(tick);
    if (wrong.empty()) continue;
    return {name, false, "tick " + std::to_string(tick.input.tick) + ": " + wrong,
            TimeOf(run, tick.input.now_ns)};
  }
  return {name, true, ""};
}

// The state in which the loop worked. A permit may be as old as the gate accepts.
RuleOfTick WorksInARecordedState(const RunContents& run, const RigConfig& config) {
  return [permit_ns = PermitTimeoutNs(config),
          recorded = RecordedStates(run.safety)](const TickRecord& tick) mutable {
    const StepInput& input = tick.input;
    const bool held = recorded.AnyHeld(input.now_ns - permit_ns, input.now_ns,
                                       [&](SafetyState is) { return is == input.safety_state; });
    return held ? std::string()
                : std::string("works in ") + ToString(input.safety_state) +
                      ", which no safety record gives at that time";
  };
}

// A torque that was applied belongs to the period before the frame.
RuleOfTick NoTorqueWhereNoneIsAllowed(const RunContents& run, const RigConfig& config) {
  const std::int64_t period_ns = std::llround(1e6 * config.loop.period_ms);
  return [period_ns, permit_ns = PermitTimeoutNs(config),
          recorded = RecordedStates(run.safety)](const TickRecord& tick) mutable {
    const StepInput& input = tick.input;
    const std::int64_t end_ns = input.sampling_instant_ns;
    const bool was_allowed =
        recorded.AnyHeld(end_ns - period_ns - permit_ns, end_ns, TorqueAllowed);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      if (!TorqueAllowed(input.safety_state) && tick.output.torque_nm[joint] != 0) {
        return std::string("torque asked in ") + ToString(input.safety_state);
      }
      if (!was_allowed && input.applied_torque_nm[joint] != 0) {
        return std::string("torque applied in a period without a state that allows it");
      }
    }
    return std::string();
  };
}

}  // namespace

std::vector<ConformanceCheck> CheckSafety(const RunContents& run, const RigConfig& config) {
  if (run.safety.empty()) {
    return {{"safety-table", false, "there are no safety records"}};
  }
  return {ForEveryRecord("safety-table", run, ObeysTable),
          ForEveryRecord("safety-chain", run, FollowsTheOneBefore),
          ForEveryRecord("trip-latched", run, TripStaysLatched),
          ForEveryRecord("running-was-granted", run, RunningWasGranted),
          ForEachTickOf("state-from-safety", run, WorksInARecordedState(run, config)),
          ForEachTickOf("torque-only-where-allowed", run, NoTorqueWhereNoneIsAllowed(run, config))};
}

}  // namespace flexarm
