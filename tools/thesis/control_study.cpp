#include "tools/thesis/control_study.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <vector>

#include "controller/host/simulation.h"
#include "controller/types/rejected_error.h"
#include "tools/support/parallel_for.h"
#include "tools/sweep/sweep_summary.h"

namespace flexarm {
namespace {

constexpr std::array<double, 3> kFarPayloads_kg = {0.0, 0.5, 1.0};

std::string Text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.12g", value);
  return text.data();
}

void AddPayloads(const ControlCase& of, std::vector<ControlCase>* cases) {
  for (const double payload_kg : kThesisPayloads_kg) {
    cases->push_back(of);
    cases->back().payload_kg = payload_kg;
  }
}

std::vector<ControlCase> Cases() {
  std::vector<ControlCase> cases;
  for (const double alpha : kAlphas) {
    for (const double payload_kg : kThesisPayloads_kg) {
      cases.push_back(AlphaCase(alpha, payload_kg));
    }
  }
  for (const char* sign : {"printed", "corrected"}) {
    for (const double vartheta : kVarthetas) cases.push_back(VarthetaCase(vartheta, sign));
  }
  for (const auto& changed : std::vector<std::vector<std::string>>{
           {},
           {"controller.name=sobel-original"},
           {"controller.name=lqr-cgt"},
           {"controller.adaptation=false"},
           {"controller.prediction=false"},
           {"controller.nominal=T12"},
           {"controller.nominal=T16"},
           {"estimator.name=difference"},
           {"estimator.name=difference", "sensors.strain_input.filter_hz=0",
            "controller.alpha=2"}}) {
    AddPayloads(ChangedCase(changed, 0.1), &cases);
  }
  AddPayloads(SineCase(0.1), &cases);
  for (const double payload_kg : kFarPayloads_kg) {
    cases.push_back(ChangedCase({}, payload_kg));
    cases.push_back(ChangedCase({"controller.adaptation=false"}, payload_kg));
  }
  for (const char* modes : {"2", "3", "6"}) {
    cases.push_back(ChangedCase({std::string("sim.plant_modes=") + modes}, 0.1));
  }
  return cases;
}

Doublet Turn(double start_s, double move_deg, DoubletShape shape) {
  return {.start_s = start_s, .duration_s = 1.0, .shape = shape, .move_deg = {move_deg, move_deg}};
}

// A run whose design failed counts as one that did not complete.
SimulationResult RunOf(const RigConfig& config, const ControlCase& of, int seed) {
  std::vector<std::string> overrides = of.overrides;
  overrides.push_back("sim.seed=" + std::to_string(seed));
  try {
    return Simulate({.config = WithOverrides(config, overrides),
                     .experiment = ControlCommand(of.shape),
                     .payload_kg = of.payload_kg,
                     .log = {}});
  } catch (const RejectedError&) {
    return {};
  }
}

ControlFigures FiguresOf(const std::vector<SimulationResult>& results) {
  ControlFigures figures;
  figures.runs = results.size();
  const auto median = [&](const auto& value_of) {
    std::vector<double> values;
    for (const SimulationResult& result : results) {
      if (result.completed) values.push_back(value_of(result.metrics));
    }
    return MedianOf(values);
  };
  for (const SimulationResult& result : results) figures.completed += result.completed ? 1 : 0;
  for (std::size_t i = 0; i < 2; ++i) {
    figures.rms_deg[i] = median([i](const auto& m) { return m.joint_rms_error_deg[i]; });
    figures.final_deg[i] = median([i](const auto& m) { return m.joint_final_error_deg[i]; });
    figures.peak_nm[i] = median([i](const auto& m) { return m.peak_torque_nm[i]; });
    figures.torque_rms_nm[i] = median([i](const auto& m) { return m.torque_rms_nm[i]; });
    figures.peak_bending_mm[i] = median([i](const auto& m) { return m.peak_bending_mm[i]; });
  }
  figures.settling_s = median([](const auto& m) {
    return m.tip_settling_time_s.value_or(std::numeric_limits<double>::infinity());
  });
  figures.residual_mm = median([](const auto& m) { return m.tip_residual_rms_mm; });
  return figures;
}

}  // namespace

Experiment ControlCommand(DoubletShape shape) {
  return {.name = shape == DoubletShape::kSquare ? "square" : "sine",
          .text = "",
          .duration_s = 6.0,
          .doublet = {Turn(0.0, 30.0, shape), Turn(3.0, -30.0, shape)},
          .sim_event = {}};
}

ControlCase ChangedCase(const std::vector<std::string>& overrides, double payload_kg) {
  return {.overrides = overrides, .payload_kg = payload_kg, .shape = DoubletShape::kSquare};
}

ControlCase SineCase(double payload_kg) {
  return {.overrides = {}, .payload_kg = payload_kg, .shape = DoubletShape::kSine};
}

ControlCase AlphaCase(double alpha, double payload_kg) {
  return ChangedCase({"controller.alpha=" + Text(alpha)}, payload_kg);
}

ControlCase VarthetaCase(double vartheta, const char* sign) {
  return ChangedCase(
      {"controller.vartheta=" + Text(vartheta), std::string("controller.feedforward_sign=") + sign},
      0.1);
}

ControlStudy::ControlStudy(const RigConfig& config,
                           const std::function<void(std::size_t)>& progress)
    : config_(config) {
  const std::vector<ControlCase> cases = Cases();
  std::vector<std::vector<SimulationResult>> results(cases.size(),
                                                     std::vector<SimulationResult>(kSeeds));
  ParallelFor(
      cases.size() * kSeeds,
      [&](std::size_t i) {
        const std::size_t of = i / kSeeds, seed = i % kSeeds;
        results[of][seed] = RunOf(config, cases[of], static_cast<int>(seed) + 1);
      },
      progress);
  for (std::size_t i = 0; i < cases.size(); ++i) figures_[cases[i]] = FiguresOf(results[i]);
}

std::size_t ControlStudy::Runs() { return Cases().size() * kSeeds; }

}  // namespace flexarm
