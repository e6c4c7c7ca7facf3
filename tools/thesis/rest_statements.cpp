#include "tools/thesis/rest_statements.h"

namespace flexarm {
namespace {

constexpr double kDamped_s = 2.0;  // the thesis: within 2 seconds after the command

std::string SettingsOf(const ControlStudy& study, LoopKind loop, const std::string& changed = {}) {
  return loop == LoopKind::kIdeal ? IdealSettings(study, changed) : SensorSettings(study, changed);
}

}  // namespace

Statement Damped(const ControlStudy& study, LoopKind loop, const std::string& section,
                 const std::string& thesis, const Overrides& law) {
  std::vector<RestOutcome> rests;
  for (const double kg : kTestedPayloads_kg) {
    const ControlFigures& f = FiguresOf(study, loop, ChangedCase(law, kg));
    rests.push_back({.completed = f.all_completed(),
                     .within_15mm_s = f.still_15mm_s.median,
                     .within_5mm_s = f.still_5mm_s.median,
                     .last_second_mm = f.last_second_mm.median});
  }
  const auto each = [&](FigureOf figure) {
    return PerPayload(kTestedPayloads_kg, [&](double kg) {
      return FigureOrNever(FiguresOf(study, loop, ChangedCase(law, kg)).*figure, 2);
    });
  };
  return {section, thesis,
          "the tip stays within 15 mm of its resting place after " +
              each(&ControlFigures::still_15mm_s) + " s, within 5 mm after " +
              each(&ControlFigures::still_5mm_s) + " s, and moves by " +
              each(&ControlFigures::last_second_mm) + " mm rms in the last second (at most " +
              Figure(kRestMotion_mm, 1) + " counts as rest)," + AtPayloads(kTestedPayloads_kg) +
              SettingsOf(study, loop, law.empty() ? "" : "law sobel"),
          DampedRule(rests, kDamped_s)};
}

Statement NoFinalError(const ControlStudy& study, LoopKind loop, const std::string& section) {
  const double count_deg = 360.0 / study.config().sensors.encoder.front().counts_per_turn;
  std::vector<Outcome> finals;
  for (const double kg : kTestedPayloads_kg) {
    const ControlFigures& f = FiguresOf(study, loop, ChangedCase({}, kg));
    finals.push_back(f.Of(f.worst_final_deg));
  }
  return {section, "the steady state error is zero",
          "final error of the worse joint " +
              PerPayload(kTestedPayloads_kg,
                         [&](double kg) {
                           return FigureOrNever(
                               FiguresOf(study, loop, ChangedCase({}, kg)).worst_final_deg, 2);
                         }) +
              " deg" + AtPayloads(kTestedPayloads_kg) +
              "; counts as zero up to two counts of the encoder, " + Figure(2.0 * count_deg, 2) +
              " deg" + SettingsOf(study, loop),
          FinalErrorRule(finals, 2.0 * count_deg)};
}

}  // namespace flexarm
