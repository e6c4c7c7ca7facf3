#include "controller/host/run_judge.h"

#include <algorithm>
#include <cmath>

#include "controller/design/design_verdict.h"
#include "controller/design/run_design.h"
#include "controller/host/simulation.h"
#include "controller/operator/run_command.h"
#include "controller/operator/trip_channel.h"
#include "controller/types/rejected_error.h"
#include "controller/types/rounded_text.h"
#include "model/units.h"

namespace flexarm {
namespace {

constexpr std::size_t kMostKept = 16;
constexpr double kRounding_kg = 1e-9;
constexpr const char* kWhichLaw = "docs/laws.md";

// Tried first where an experiment does not say which laws it is for.
constexpr std::array kUsual = {ControllerKind::kGainScheduled, ControllerKind::kSobel,
                               ControllerKind::kRecedingHorizon};

std::string Quoted(ControllerKind law) { return std::string("\"") + LawOf(law).name + "\""; }

std::string List(const std::vector<ControllerKind>& laws) {
  std::string text;
  for (const ControllerKind law : laws) text += (text.empty() ? "" : ", ") + Quoted(law);
  return text;
}

std::string RangeText(const std::array<double, 2>& kg) {
  return RoundedText(kg[0], 4) + " to " + RoundedText(kg[1], 4) + " kg";
}

bool IsOneOf(ControllerKind law, const std::vector<ControllerKind>& laws) {
  return std::find(laws.begin(), laws.end(), law) != laws.end();
}

std::vector<ControllerKind> Candidates(const Experiment& experiment) {
  if (!experiment.laws.empty()) return experiment.laws;
  std::vector<ControllerKind> laws(kUsual.begin(), kUsual.end());
  for (const LawRow& law : kLaws) {
    if (!IsOneOf(law.kind, laws)) laws.push_back(law.kind);
  }
  return laws;
}

UnmetCondition Objection(const char* refusal, std::string found, std::string remedy) {
  return {.name = kExperimentCondition,
          .refusal = refusal,
          .found = std::move(found),
          .remedy = std::move(remedy),
          .may_override = true};
}

// "1954 microstrain, limit 1900".
std::string ValueText(TripCause cause, const Evidence& evidence) {
  if (evidence.limit == 0.0) return {};
  double unit = 1.0;
  const char* name = "";
  if (cause == TripCause::kBendingStrain1 || cause == TripCause::kBendingStrain2) {
    unit = 1e6;
    name = " microstrain";
  } else if (cause == TripCause::kSoftLimit1 || cause == TripCause::kSoftLimit2 ||
             cause == TripCause::kFollowingError1 || cause == TripCause::kFollowingError2) {
    unit = 1.0 / kRadPerDeg;
    name = " deg";
  } else if (cause == TripCause::kHubRate1 || cause == TripCause::kHubRate2) {
    name = " rad/s";
  }
  return ": " + RoundedText(unit * evidence.value, 4) + name + ", limit " +
         RoundedText(unit * evidence.limit, 4);
}

std::string TripText(const SimulatedTrip& trip, const SensorConfig& sensors) {
  const std::string channel = TripChannelName(trip.cause, trip.evidence.channel, sensors);
  return std::string(ToString(trip.cause)) + (channel.empty() ? "" : " (" + channel + ")") +
         " after " + RoundedText(trip.at_s, 2, true) + " s" + ValueText(trip.cause, trip.evidence);
}

// Events that would trip, freeze or kill are the point of their experiment, not of its prediction.
Experiment WithoutEvents(Experiment experiment) {
  std::erase_if(experiment.sim_event,
                [](const SimEvent& event) { return !event.payload_kg.has_value(); });
  return experiment;
}

std::vector<double> CheckedPayloads(const std::array<double, 2>& kg) {
  if (kg[0] == kg[1]) return {kg[0]};
  return {kg[0], 0.5 * (kg[0] + kg[1]), kg[1]};
}

}  // namespace

std::optional<std::array<double, 2>> PayloadsOf(const Experiment& experiment,
                                                const RigConfig& config) {
  if (!experiment.payload_kg) return std::nullopt;
  const auto [least, most] = *experiment.payload_kg;
  const auto [rig_least, rig_most] = config.controller.payload_range_kg;
  return std::array{std::max(least, rig_least), std::min(most, rig_most)};
}

std::optional<UnmetCondition> PayloadObjection(const Experiment& experiment,
                                               const RigConfig& config, double payload_kg) {
  const auto kg = PayloadsOf(experiment, config);
  if (!kg) return std::nullopt;
  const bool inside =
      payload_kg >= (*kg)[0] - kRounding_kg && payload_kg <= (*kg)[1] + kRounding_kg;
  if (inside) return std::nullopt;
  return Objection("payload-not-for-experiment",
                   "a payload of " + RoundedText(payload_kg, 4) + " kg: this experiment is for " +
                       RangeText(*experiment.payload_kg) + " (payload_kg), this rig for " +
                       RangeText(config.controller.payload_range_kg) +
                       " (controller.payload_range_kg)",
                   "use a payload that is in both ranges");
}

std::optional<UnmetCondition> RunJudge::Judge(const Experiment& experiment,
                                              const std::array<double, 2>& start_rad,
                                              const std::stop_token& stop) {
  if (experiment.laws.empty() && !experiment.payload_kg) return std::nullopt;
  for (const Verdict& kept : kept_) {
    const bool same_place = std::fabs(kept.start_rad[0] - start_rad[0]) <= kSamePlace_rad &&
                            std::fabs(kept.start_rad[1] - start_rad[1]) <= kSamePlace_rad;
    if (same_place && kept.text == experiment.text) return kept.objection;
  }
  const Experiment predicted = WithoutEvents(experiment);
  Case judged{.experiment = &predicted, .start_rad = start_rad, .payload_kg = {}, .stop = &stop};
  if (const auto kg = PayloadsOf(experiment, config_)) {
    if ((*kg)[0] > (*kg)[1]) {
      return Objection("payload-not-for-rig",
                       "this experiment is for payloads of " + RangeText(*experiment.payload_kg) +
                           ", this rig for " + RangeText(config_.controller.payload_range_kg) +
                           " (controller.payload_range_kg)",
                       "use an experiment for payloads of this rig");
    }
    judged.payload_kg = CheckedPayloads(*kg);
  }
  std::optional<UnmetCondition> objection = Find(judged);
  if (kept_.size() == kMostKept) kept_.pop_front();
  kept_.push_back({.text = experiment.text, .start_rad = start_rad, .objection = objection});
  return objection;
}

std::optional<UnmetCondition> RunJudge::Find(const Case& judged) const {
  const ControllerKind law = config_.controller.kind;
  const std::vector<ControllerKind>& laws = judged.experiment->laws;
  if (!laws.empty() && !IsOneOf(law, laws)) {
    return Objection(
        "law-not-for-experiment",
        "this experiment is not for controller.name = " + Quoted(law) + "; its laws: " + List(laws),
        OtherLaw(judged));
  }
  const std::string trips = Trips(config_, judged);
  if (trips.empty()) return std::nullopt;
  return Objection("predicted-trip", "with controller.name = " + Quoted(law) + trips,
                   OtherLaw(judged) + "; or make it slower, or state lighter payloads");
}

std::string RunJudge::Trips(const RigConfig& config, const Case& judged) const {
  for (const double payload_kg : judged.payload_kg) {
    const SimulationResult run = Simulate({.config = config,
                                           .experiment = *judged.experiment,
                                           .payload_kg = payload_kg,
                                           .log = std::nullopt,
                                           .start_rad = judged.start_rad},
                                          [&judged](double) {
                                            if (judged.stop->stop_requested())
                                              throw RejectedError("the run was cancelled");
                                          });
    if (run.completed) continue;
    const std::string how = run.trip_found ? TripText(*run.trip_found, config.sensors)
                                           : std::string(ToString(run.trip));
    return " the predicted run with " + RoundedText(payload_kg, 4) + " kg trips by " + how;
  }
  return {};
}

std::string RunJudge::OtherLaw(const Case& judged) const {
  Case tried = judged;
  if (tried.payload_kg.empty()) tried.payload_kg = {config_.arm.payload_mass_kg};
  std::string why;
  for (const ControllerKind law : Candidates(*judged.experiment)) {
    if (law == config_.controller.kind || !with_law_) continue;
    const std::string not_that = WhyNot(law, tried);
    if (judged.stop->stop_requested()) throw RejectedError("the run was cancelled");
    if (not_that.empty()) {
      return "controller.name = " + Quoted(law) + " completes it (" + kWhichLaw + ")";
    }
    if (why.empty()) why = std::string(LawOf(law).name) + ": " + not_that;
  }
  if (why.empty()) return std::string("choose one of the laws that it is for: ") + kWhichLaw;
  return "no other law completes it on this rig (" + why + ")";
}

std::string RunJudge::WhyNot(ControllerKind law, const Case& judged) const {
  try {
    const RigConfig config = with_law_(config_, LawOf(law).name);
    const DesignVerdict design = JudgeDesign(config, DesignFor(config));
    if (design.result == DesignVerdict::Result::kRejected) {
      return "its design is rejected: " + design.found;
    }
    return Trips(config, judged);
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace flexarm
