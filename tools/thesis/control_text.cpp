#include "tools/thesis/control_text.h"

#include <cmath>

namespace flexarm {
namespace {

ControlCase At(ControlCase of, double payload_kg) {
  of.payload_kg = payload_kg;
  return of;
}

std::string SettingsText(const ControlStudy& study, const std::string& changed) {
  if (!changed.empty()) return "; " + changed;
  const ControllerConfig& c = study.config().controller;
  return "; alpha " + Figure(c.alpha, 2) + ", vartheta " + Figure(c.vartheta, 2);
}

std::string SeedText(const ControlStudy& study) {
  return "sensors and delay, seeds " + Count(study.first_seed()) + " to " +
         Count(study.first_seed() + ControlStudy::kSeeds - 1);
}

}  // namespace

const ControlFigures& FiguresOf(const ControlStudy& study, LoopKind loop, const ControlCase& of) {
  return study.Of(loop == LoopKind::kIdeal ? Ideal(of) : of);
}

std::string AtPayloads(std::span<const double> payloads_kg) {
  return " at " + PerPayload(payloads_kg, [](double kg) { return Figure(kg, 1); }) + " kg";
}

std::string SensorSettings(const ControlStudy& study, const std::string& changed) {
  return " [" + SeedText(study) + SettingsText(study, changed) + "]";
}

std::string IdealSettings(const ControlStudy& study, const std::string& changed) {
  return " [known state, no delay" + SettingsText(study, changed) + "]";
}

std::string BothSettings(const ControlStudy& study, const std::string& changed) {
  return " [known state, no delay, and " + SeedText(study) + SettingsText(study, changed) + "]";
}

std::string FigureOrNever(const OverSeeds& value, int digits) {
  if (std::isnan(value.median)) return "no run completes";
  return std::isinf(value.median) ? "never" : Figure(value.median, digits);
}

std::string PairText(const std::array<OverSeeds, 2>& values, int digits) {
  return FigureOrNever(values[0], digits) + " " + FigureOrNever(values[1], digits);
}

std::string CompletedText(const ControlStudy& study, LoopKind loop, const ControlCase& of,
                          std::span<const double> payloads_kg) {
  std::size_t completed = 0, runs = 0;
  for (const double payload_kg : payloads_kg) {
    completed += FiguresOf(study, loop, At(of, payload_kg)).completed;
    runs += FiguresOf(study, loop, At(of, payload_kg)).runs;
  }
  return std::to_string(completed) + " of " + std::to_string(runs) + " runs complete";
}

std::vector<Contrast> Contrasts(const ControlStudy& study, LoopKind loop, const ControlCase& first,
                                const ControlCase& second, std::span<const double> payloads_kg,
                                FigureOf figure) {
  std::vector<Contrast> cases;
  for (const double payload_kg : payloads_kg) {
    const ControlFigures& a = FiguresOf(study, loop, At(first, payload_kg));
    const ControlFigures& b = FiguresOf(study, loop, At(second, payload_kg));
    cases.push_back({a.Of(a.*figure), b.Of(b.*figure)});
  }
  return cases;
}

}  // namespace flexarm
