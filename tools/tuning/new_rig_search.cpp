#include "tools/tuning/new_rig_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "controller/types/law_table.h"
#include "controller/types/rounded_text.h"
#include "tools/tuning/move_check.h"
#include "tools/tuning/tuning_search.h"

namespace flexarm {
namespace {

constexpr int kMostDesigns = 120;
constexpr std::array<double, 3> kStiffer = {1.0, 1.5, 2.2};  // factors on controller.alpha
constexpr std::array<double, 5> kPlanFractions = {0.6, 0.45, 0.3, 0.2, 0.12};
constexpr std::array<std::uint64_t, 3> kSeeds = {1, 2, 3};
constexpr std::array<double, 6> kFastShares = {1.0, 0.85, 0.7, 0.55, 0.4, 0.3};
constexpr std::array<std::uint64_t, 8> kFastSeeds = {11, 12, 13, 14, 15, 16, 17, 18};
// Of the permitted error: other moves may end farther from their targets than these.
constexpr double kShareOfPermitted = 0.7;

using Progress = std::function<void(const std::string&)>;

std::string Rounded(double value) { return RoundedText(value, 3); }

std::vector<double> CheckedPayloads(const RigConfig& config) {
  const auto [least, most] = config.controller.payload_range_kg;
  std::vector<double> payloads = {config.arm.payload_mass_kg, least, most};
  std::sort(payloads.begin() + 1, payloads.end());
  payloads.erase(std::unique(payloads.begin(), payloads.end()), payloads.end());
  return payloads;
}

/// Moves of an arm with less of its limits, or a stiffer law.
struct Pace {
  double fraction;  ///< limits.plan_fraction
  double factor;    ///< on controller.alpha
};

// From fast to slow; at each pace stiffer, as friction holds a joint the farther from its target,
// the softer the law.
std::vector<Pace> Paces(double most) {
  std::vector<Pace> paces;
  for (const double fraction : kPlanFractions) {
    if (fraction > most) continue;
    for (const double factor : kStiffer) paces.push_back({fraction, factor});
  }
  return paces;
}

/// What a rig is made of.
struct Described {
  ArmDescription arm;
  TunedValues tuned;
};

// Looks for the fastest moves that pass. @returns nothing if there are none
std::optional<Described> FindPace(const ArmDescription& arm, const TunedValues& tuned,
                                  const Progress& progress, NewRigResult* result) {
  const double most = arm.Or("plan_fraction", kPlanFractions.front());
  const double alpha = NewRig(arm, tuned).controller.alpha;
  std::string problem;
  for (const auto [fraction, factor] : Paces(most)) {
    ArmDescription slower = arm;
    slower.number["plan_fraction"] = fraction;
    TunedValues stiffer = tuned;
    if (factor != 1.0) stiffer["controller.alpha"] = Rounded(factor * alpha);
    const RigConfig config = NewRig(slower, stiffer);
    if (factor != 1.0 && ScoreOf(config).result != DesignVerdict::Result::kSound) continue;
    progress("simulating moves to random places, with " + Rounded(100.0 * fraction) +
             " % of the limits");
    const MoveCheck check = CheckMoves(config, CheckedPayloads(config), kSeeds, kShareOfPermitted);
    result->text = NewRigText(slower, stiffer);
    result->largest_error_mm = check.largest_error_mm;
    result->permitted_mm = check.permitted_mm;
    if (!check.passed) {
      problem = check.problem;
      continue;
    }
    if (fraction < most || factor != 1.0) {
      result->notes.push_back("limits.plan_fraction = " + Rounded(fraction) +
                              ", controller.alpha = " + Rounded(config.controller.alpha) +
                              ": with a faster or softer one, " + problem);
    }
    return Described{slower, stiffer};
  }
  result->notes.push_back("no simulated moves pass, not even slow ones: " + problem);
  return std::nullopt;
}

// Lowers the shares of the limits that moves of the shortest duration use until they pass. The
// smallest is kept even if they do not: without them the rig is sound.
void FindFastFraction(Described found, const Progress& progress, NewRigResult* result) {
  const RigConfig derived = NewRig(found.arm, found.tuned);
  if (!IsScheduled(derived.controller.kind)) return;
  const auto [light, heavy] = derived.controller.payload->fast_fraction;
  const auto [least_kg, most_kg] = derived.controller.payload_range_kg;
  const std::vector<double> payloads = {least_kg, derived.arm.payload_mass_kg,
                                        0.5 * (least_kg + most_kg), most_kg};
  std::string problem;
  for (const double share : kFastShares) {
    if (share != 1.0) {
      found.tuned["controller.payload.fast_fraction"] =
          "[" + Rounded(share * light) + ", " + Rounded(share * heavy) + "]";
    }
    const RigConfig config = NewRig(found.arm, found.tuned);
    progress("simulating moves as short as the payload allows, with " +
             Rounded(100.0 * share * light) + " % of the limits");
    const std::string with_this = ProblemOfFastMoves(config, payloads, kFastSeeds);
    result->text = NewRigText(found.arm, found.tuned);
    if (with_this.empty() && problem.empty()) return;
    if (with_this.empty()) {
      result->notes.push_back(
          "controller.payload.fast_fraction = " + found.tuned["controller.payload.fast_fraction"] +
          ": with more, " + problem);
      return;
    }
    problem = with_this;
  }
  result->notes.push_back("do not use moves with duration = \"shortest\": " + problem +
                          " even with the least controller.payload.fast_fraction");
}

NewRigResult Try(const ArmDescription& arm, const Progress& progress) {
  NewRigResult result{.passed = false,
                      .text = NewRigText(arm),
                      .design_score = 0.0,
                      .notes = {},
                      .largest_error_mm = 0.0,
                      .permitted_mm = 0.0,
                      .proposal = std::nullopt};
  const RigConfig derived = NewRig(arm);
  progress("designing");
  const DesignScore score = ScoreOf(derived);
  result.design_score = score.value;
  TunedValues tuned;
  if (score.result != DesignVerdict::Result::kSound) {
    result.notes.push_back("the derived values fail: " + score.found);
    const Tuning tuning = TuneDesign(derived, kMostDesigns, [&](int designs, double best) {
      progress("tuning: design " + std::to_string(designs) + ", score " + Rounded(best));
    });
    for (const TunedKey& change : tuning.changed) tuned[change.key] = change.after;
    result.design_score = tuning.after.value;
    result.text = NewRigText(arm, tuned);
    if (tuning.after.result != DesignVerdict::Result::kSound) {
      for (const std::string& obstacle : ObstaclesOf(derived)) result.notes.push_back(obstacle);
      return result;
    }
    result.notes.emplace_back("tuned until every check passed");
  }
  const std::optional<Described> found = FindPace(arm, tuned, progress, &result);
  result.passed = found.has_value();
  if (found) FindFastFraction(*found, progress, &result);
  return result;
}

// With the range of payloads that the owner gave, or the widest about the usual one that passes.
NewRigResult TryPayloads(const ArmDescription& arm, const Progress& progress) {
  NewRigResult result = Try(arm, progress);
  if (result.passed || arm.Has("payload_min_kg") || arm.Has("payload_max_kg")) return result;
  const double usual_kg = arm.At("tip_mass_kg");
  for (const double share : {0.5, 0.2}) {
    ArmDescription narrower = arm;
    narrower.number["payload_min_kg"] = (1.0 - share) * usual_kg;
    narrower.number["payload_max_kg"] = (1.0 + share) * usual_kg;
    NewRigResult other = Try(narrower, progress);
    if (!other.passed) continue;
    other.notes.insert(other.notes.begin(), "for payloads of " + Rounded((1.0 - share) * usual_kg) +
                                                " to " + Rounded((1.0 + share) * usual_kg) +
                                                " kg only: from nothing to twice " +
                                                "the usual one, " + result.notes.back());
    return other;
  }
  return result;
}

/// A change of the description, in words.
struct Change {
  ArmDescription arm;
  std::string what;
};

// Changes of one thing, from small to large.
std::vector<Change> ChangesOf(const ArmDescription& arm) {
  std::vector<Change> changes;
  const auto add = [&](const std::vector<std::string>& keys, double value,
                       const std::string& what) {
    ArmDescription changed = arm;
    for (const std::string& key : keys) changed.number[key] = value;
    changes.push_back({std::move(changed), what});
  };
  const double gauges = arm.At("gauges_per_link");
  if (gauges < 2.0) add({"gauges_per_link"}, 2.0, "gauges_per_link = 2");
  const double counts =
      std::min(arm.At("joint1.encoder_counts_per_turn"), arm.At("joint2.encoder_counts_per_turn"));
  const double finer = 4.0 * counts;
  if (counts < 1e4) {
    add({"joint1.encoder_counts_per_turn", "joint2.encoder_counts_per_turn"}, finer,
        "encoders of " + Rounded(finer) + " counts per turn");
  }
  for (const double rate_hz : {100.0, 200.0, 500.0}) {
    if (rate_hz > 1.2 * arm.At("rate_hz")) {
      add({"rate_hz"}, rate_hz, "rate_hz = " + Rounded(rate_hz));
    }
  }
  return changes;
}

}  // namespace

NewRigResult FindRig(const ArmDescription& arm, const Progress& progress) {
  NewRigResult result = TryPayloads(arm, progress);
  if (result.passed) return result;
  for (const Change& change : ChangesOf(arm)) {
    const NewRigResult other =
        Try(change.arm, [&](const std::string& what) { progress(change.what + ": " + what); });
    if (!other.passed) continue;
    result.proposal = change.what;
    return result;
  }
  return result;
}

}  // namespace flexarm
