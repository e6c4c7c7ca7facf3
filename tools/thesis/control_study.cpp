#include "tools/thesis/control_study.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "controller/host/simulation.h"
#include "controller/types/rejected_error.h"
#include "tools/support/parallel_for.h"
#include "tools/sweep/sweep_summary.h"
#include "tools/thesis/rig_needs.h"

namespace flexarm {
namespace {

constexpr const char* kIdealEstimator = "estimator.name=ideal";

constexpr double kTwoOverPi = 2.0 / std::numbers::pi;

std::string Text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.12g", value);
  return text.data();
}

template <std::size_t N>
void AddPayloads(const ControlCase& of, const std::array<double, N>& payloads_kg,
                 std::vector<ControlCase>* cases) {
  for (const double payload_kg : payloads_kg) {
    cases->push_back(of);
    cases->back().payload_kg = payload_kg;
  }
}

void AddAlphas(std::vector<ControlCase>* cases) {
  for (const double alpha : kAlphas) {
    AddPayloads(AlphaCase(alpha, 0.1), kTestedPayloads_kg, cases);
    AddPayloads(Ideal(AlphaCase(alpha, 0.1)), kTestedPayloads_kg, cases);
  }
  for (const char* alpha : {"0", "3"}) {
    const ControlCase plain = WithoutBlend(alpha, 0.1);
    AddPayloads(plain, kTestedPayloads_kg, cases);
    AddPayloads(Ideal(plain), kTestedPayloads_kg, cases);
  }
  for (const char* sign : {"printed", "corrected"}) {
    for (const double vartheta : kVarthetas) {
      cases->push_back(VarthetaCase(vartheta, sign));
      cases->push_back(Ideal(cases->back()));
    }
  }
}

// The nominal models other than the config's; T16 has two modes a link.
std::vector<Overrides> OtherModels(const RigConfig& config) {
  std::vector<Overrides> models = {{"controller.nominal=T12"}};
  if (LacksTwoModes(config).empty()) models.push_back({"controller.nominal=T16"});
  return models;
}

std::vector<ControlCase> Cases(const RigConfig& config) {
  std::vector<ControlCase> cases;
  AddAlphas(&cases);
  for (const Overrides& changed :
       std::vector<Overrides>{{"controller.name=sobel-original"},
                              {"controller.name=lqr-cgt"},
                              {"controller.prediction=false"},
                              {"estimator.name=difference"},
                              {"estimator.name=difference", "sensors.strain_input.filter_hz=0",
                               "controller.alpha=2"}}) {
    AddPayloads(ChangedCase(changed, 0.1), kTestedPayloads_kg, &cases);
  }
  for (const Overrides& changed : std::vector<Overrides>{{}, {"controller.name=sobel-original"}}) {
    AddPayloads(Ideal(ChangedCase(changed, 0.1)), kTestedPayloads_kg, &cases);
  }
  for (const Overrides& changed : OtherModels(config)) {
    AddPayloads(ChangedCase(changed, 0.1), kTestedPayloads_kg, &cases);
    AddPayloads(Ideal(ChangedCase(changed, 0.1)), kTestedPayloads_kg, &cases);
  }
  for (const ControlCase& sine : {SineCase(0.1), SmallSineCase(0.1)}) {
    AddPayloads(sine, kTestedPayloads_kg, &cases);
  }
  AddPayloads(ChangedCase({}, 0.1), kAllPayloads_kg, &cases);
  AddPayloads(ChangedCase(kShippedLaw, 0.1), kTestedPayloads_kg, &cases);
  AddPayloads(ChangedCase({"controller.adaptation=false"}, 0.1), kAllPayloads_kg, &cases);
  for (const char* modes : {"2", "3", "6"}) {
    cases.push_back(ChangedCase({std::string("sim.plant_modes=") + modes}, 0.1));
    cases.push_back(Ideal(cases.back()));
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
                     .experiment = ControlCommand(of.shape, of.move_deg),
                     .payload_kg = of.payload_kg,
                     .log = {}});
  } catch (const RejectedError&) {
    return {};
  }
}

// The thesis's law does nothing special at rest.
RigConfig WithThesisLaw(const RigConfig& config) {
  if (config.controller.kind != ControllerKind::kSobel) return config;
  return WithOverrides(config, {"controller.name=sobel-thesis"});
}

OverSeeds OverSeedsOf(const std::vector<double>& values) {
  if (values.empty()) return {};
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return {.median = MedianOf(values), .least = *least, .most = *most};
}

double OrNever(const std::optional<double>& time_s) {
  return time_s.value_or(std::numeric_limits<double>::infinity());
}

ControlFigures FiguresOf(const std::vector<SimulationResult>& results) {
  ControlFigures figures;
  figures.runs = results.size();
  const auto over_seeds = [&](const auto& value_of) {
    std::vector<double> values;
    for (const SimulationResult& result : results) {
      if (result.completed) values.push_back(value_of(result.metrics));
    }
    return OverSeedsOf(values);
  };
  for (const SimulationResult& result : results) figures.completed += result.completed ? 1 : 0;
  for (std::size_t i = 0; i < 2; ++i) {
    figures.rms_deg[i] = over_seeds([i](const auto& m) { return m.joint_rms_error_deg[i]; });
    figures.final_deg[i] = over_seeds([i](const auto& m) { return m.joint_final_error_deg[i]; });
    figures.peak_nm[i] = over_seeds([i](const auto& m) { return m.peak_torque_nm[i]; });
    figures.torque_rms_nm[i] = over_seeds([i](const auto& m) { return m.torque_rms_nm[i]; });
    figures.peak_bending_mm[i] = over_seeds([i](const auto& m) { return m.peak_bending_mm[i]; });
    figures.peak_angle_deg[i] = over_seeds([i](const auto& m) { return m.peak_angle_deg[i]; });
    figures.roughness_rad_s2[i] =
        over_seeds([i](const auto& m) { return m.joint_roughness_rad_s2[i]; });
    figures.lag_s[i] = over_seeds([i](const auto& m) { return m.joint_lag_s[i]; });
  }
  figures.rms_sum_deg =
      over_seeds([](const auto& m) { return m.joint_rms_error_deg[0] + m.joint_rms_error_deg[1]; });
  figures.worst_final_deg = over_seeds([](const auto& m) {
    return std::max(m.joint_final_error_deg[0], m.joint_final_error_deg[1]);
  });
  figures.still_15mm_s =
      over_seeds([](const auto& m) { return OrNever(m.tip_still_within_15mm_s); });
  figures.still_5mm_s = over_seeds([](const auto& m) { return OrNever(m.tip_still_within_5mm_s); });
  figures.residual_mm = over_seeds([](const auto& m) { return m.tip_residual_rms_mm; });
  figures.last_second_mm = over_seeds([](const auto& m) { return m.tip_last_second_rms_mm; });
  return figures;
}

// Without noise one run says all.
int SeedsOf(const ControlCase& of) {
  const bool ideal =
      std::find(of.overrides.begin(), of.overrides.end(), kIdealEstimator) != of.overrides.end();
  return ideal ? 1 : ControlStudy::kSeeds;
}

}  // namespace

Experiment ControlCommand(DoubletShape shape, double move_deg) {
  return {.name = shape == DoubletShape::kSquare ? "square" : "sine",
          .text = "",
          .duration_s = 6.0,
          .doublet = {Turn(0.0, move_deg, shape), Turn(3.0, -move_deg, shape)},
          .sim_event = {}};
}

ControlCase ChangedCase(const Overrides& overrides, double payload_kg) {
  return {.overrides = overrides, .payload_kg = payload_kg};
}

ControlCase SineCase(double payload_kg) {
  return {.overrides = {}, .payload_kg = payload_kg, .shape = DoubletShape::kSine};
}

ControlCase SmallSineCase(double payload_kg) {
  ControlCase sine = SineCase(payload_kg);
  sine.move_deg = kTwoOverPi * kMove_deg;
  return sine;
}

ControlCase AlphaCase(double alpha, double payload_kg) {
  return ChangedCase({"controller.alpha=" + Text(alpha)}, payload_kg);
}

ControlCase WithoutBlend(const char* alpha, double payload_kg) {
  return ChangedCase({std::string("controller.alpha=") + alpha, "controller.vartheta=0"},
                     payload_kg);
}

ControlCase VarthetaCase(double vartheta, const char* sign) {
  return ChangedCase(
      {"controller.vartheta=" + Text(vartheta), std::string("controller.feedforward_sign=") + sign},
      0.1);
}

ControlCase Ideal(ControlCase of) {
  of.overrides.emplace_back(kIdealEstimator);
  return of;
}

ControlStudy::ControlStudy(const RigConfig& config, int first_seed,
                           const std::function<void(std::size_t)>& progress)
    : config_(WithThesisLaw(config)), first_seed_(first_seed) {
  struct Job {
    const ControlCase* of;
    int seed;
  };
  const std::vector<ControlCase> cases = Cases(config);
  std::vector<Job> jobs;
  for (const ControlCase& of : cases) {
    for (int i = 0; i < SeedsOf(of); ++i) jobs.push_back({&of, first_seed + i});
  }
  std::vector<SimulationResult> results(jobs.size());
  ParallelFor(
      jobs.size(), [&](std::size_t i) { results[i] = RunOf(config_, *jobs[i].of, jobs[i].seed); },
      progress);
  std::map<ControlCase, std::vector<SimulationResult>> by_case;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    by_case[*jobs[i].of].push_back(std::move(results[i]));
  }
  for (const auto& [of, runs] : by_case) figures_[of] = FiguresOf(runs);
}

std::size_t ControlStudy::Runs(const RigConfig& config) {
  std::size_t runs = 0;
  for (const ControlCase& of : Cases(config)) runs += static_cast<std::size_t>(SeedsOf(of));
  return runs;
}

}  // namespace flexarm
