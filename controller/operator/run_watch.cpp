#include "controller/operator/run_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>
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
  speed_.reset();
  seen_.reset();
  stopped_ = false;
  trip_ = TripCause::kNone;
}

// The permit that is read may be older than the answer: then it is of the run before.
void RunWatch::Follow(std::int64_t now_ns, const Permit& permit, const TickRecord& tick,
                      bool shutting_down) {
  if (outcome_ != Outcome::kRunning || permit.run_number != number_) return;
  if (seen_ != permit.change.number) {
    seen_ = permit.change.number;
    const bool changed = permit.change.experiment != nullptr;
    Describe(changed ? permit.change.experiment : permit.run.experiment, Homes(permit.run),
             changed ? tick.sample : 0);
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

// A pause takes time, but no samples: what is left counts from here.
void RunWatch::Describe(const PlannedExperiment* experiment, bool homes, int sample) {
  duration_s_ = 0.0;
  speed_.reset();
  if (experiment == nullptr || homes) return;
  const ReferenceTable& table = experiment->reference;
  const bool ends = table.holds_at() == std::numeric_limits<int>::max();
  if (ends) duration_s_ = elapsed_s_ + (table.periods() - sample) * period_s_;
  if (table.path_plan()) speed_ = table.path_plan()->time.speed();
}

nlohmann::json RunWatch::Json() const {
  if (outcome_ == Outcome::kNone) return nullptr;
  nlohmann::json json{
      {"number", number_},       {"name", name_},         {"outcome", ToString(outcome_)},
      {"elapsed_s", elapsed_s_}, {"duration_s", nullptr}, {"trip", nullptr},
      {"speed_percent", nullptr}};
  if (speed_) json["speed_percent"] = std::round(1e4 * *speed_) / 100.0;
  if (duration_s_ > 0.0) json["duration_s"] = duration_s_;
  if (trip_ != TripCause::kNone) json["trip"] = flexarm::ToString(trip_);
  return json;
}

}  // namespace flexarm
