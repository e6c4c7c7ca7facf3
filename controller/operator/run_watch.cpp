#include "controller/operator/run_watch.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "controller/tasks/planned_experiment.h"

namespace flexarm {

const char* RunWatch::ToString(Outcome outcome) {
  switch (outcome) {
    case Outcome::kNone:
      return "none";
    case Outcome::kRunning:
      return "running";
    case Outcome::kDone:
      return "done";
    case Outcome::kStopped:
      return "stopped";
    case Outcome::kTripped:
      return "tripped";
  }
  return "corrupted";
}

void RunWatch::Answered(const RequestAnswer& answer, const std::string& name) {
  if (answer.refusal != Refusal::kNone) return;
  if (answer.kind == RequestKind::kStop) stopped_ = true;
  if (answer.kind != RequestKind::kRun) return;
  outcome_ = Outcome::kRunning;
  number_ = answer.number;
  name_ = name;
  elapsed_s_ = 0.0;
  duration_s_ = 0.0;
  seen_ = false;
  stopped_ = false;
  trip_ = TripCause::kNone;
}

// The permit that is read may be older than the answer: then it is of the run before.
void RunWatch::Follow(std::int64_t now_ns, const Permit& permit, bool shutting_down) {
  if (outcome_ != Outcome::kRunning || permit.run_number != number_) return;
  if (!seen_) {
    seen_ = true;
    const PlannedExperiment* experiment = permit.run.experiment;
    const bool timed = experiment != nullptr && !Homes(permit.run);
    duration_s_ = timed ? experiment->reference.periods() * period_s_ : 0.0;
  }
  if (CauseLatched(permit.state)) trip_ = permit.cause;
  if (TorqueAllowed(permit.state)) {
    elapsed_s_ =
        static_cast<double>(std::max<std::int64_t>(now_ns - permit.running_since_ns, 0)) / 1e9;
    stopped_ = stopped_ || (shutting_down && permit.state == SafetyState::kRunning);
    return;
  }
  outcome_ = trip_ != TripCause::kNone ? Outcome::kTripped
             : stopped_                ? Outcome::kStopped
                                       : Outcome::kDone;
}

nlohmann::json RunWatch::Json() const {
  if (outcome_ == Outcome::kNone) return nullptr;
  nlohmann::json json{
      {"number", number_},       {"name", name_},         {"outcome", ToString(outcome_)},
      {"elapsed_s", elapsed_s_}, {"duration_s", nullptr}, {"trip", nullptr}};
  if (duration_s_ > 0.0) json["duration_s"] = duration_s_;
  if (trip_ != TripCause::kNone) json["trip"] = flexarm::ToString(trip_);
  return json;
}

}  // namespace flexarm
