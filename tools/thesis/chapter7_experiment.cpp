// Section 7.5: the experiments, with sensors and delay; here the simulated rig.

#include <algorithm>
#include <utility>

#include "tools/thesis/chapter7_parts.h"
#include "tools/thesis/control_text.h"
#include "tools/thesis/rest_statements.h"

namespace flexarm {
namespace {

const ControlFigures& Square(const ControlStudy& study, LoopKind loop, double kg) {
  return FiguresOf(study, loop, ChangedCase({}, kg));
}

template <typename F>
std::string InBoth(const ControlStudy& study, std::span<const double> payloads_kg, const F& of) {
  const auto each = [&](LoopKind loop) {
    return PerPayload(payloads_kg, [&](double kg) { return of(Square(study, loop, kg)); });
  };
  return each(LoopKind::kSensors) + ", in the simulation " + each(LoopKind::kIdeal);
}

std::pair<const ControlFigures&, const ControlFigures&> WithSensorsAndIdeal(
    const ControlStudy& study, double kg) {
  return {Square(study, LoopKind::kSensors, kg), Square(study, LoopKind::kIdeal, kg)};
}

Statement Delay(const ControlStudy& study) {
  const ControlCase without = ChangedCase({"controller.prediction=false"}, 0.1);
  std::vector<bool> parts(1, false);
  for (const double kg : kTestedPayloads_kg) {
    const ControlFigures& f = study.Of(ChangedCase(without.overrides, kg));
    parts.front() = parts.front() || !f.all_completed();
    parts.push_back(Square(study, LoopKind::kSensors, kg).all_completed());
  }
  return {"7.5", "the computation's delay can destabilise the loop, and prediction cures it",
          "one sample of delay; completed runs without prediction " +
              PerPayload(kTestedPayloads_kg,
                         [&](double kg) {
                           const ControlFigures& f = study.Of(ChangedCase(without.overrides, kg));
                           return std::to_string(f.completed) + " of " + std::to_string(f.runs);
                         }) +
              AtPayloads(kTestedPayloads_kg) + "; with it " +
              CompletedText(study, LoopKind::kSensors, ChangedCase({}, 0.1), kTestedPayloads_kg) +
              SensorSettings(study),
          parts.front() ? VerdictOf(parts) : Verdict::kDoesNot};
}

Statement Differences(const ControlStudy& study) {
  const ControlCase filtered = ChangedCase({"estimator.name=difference"}, 0.1),
                    open = ChangedCase({"estimator.name=difference",
                                        "sensors.strain_input.filter_hz=0", "controller.alpha=2"},
                                       0.1);
  std::vector<bool> parts;
  for (const ControlCase& of : {filtered, open}) {
    for (const double kg : kTestedPayloads_kg) {
      parts.push_back(study.Of(ChangedCase(of.overrides, kg)).all_completed());
    }
  }
  return {"7.5",
          "backward differences of the fitted coordinates, behind the gauges' 20 Hz filter, are "
          "satisfactory",
          "with the filter " +
              CompletedText(study, LoopKind::kSensors, filtered, kTestedPayloads_kg) +
              "; without it, at alpha 2, " +
              CompletedText(study, LoopKind::kSensors, open, kTestedPayloads_kg) + "," +
              AtPayloads(kTestedPayloads_kg) + SensorSettings(study, "alpha as said"),
          VerdictOf(parts)};
}

// Rotation and bending under a sine against those under the square command.
Statement Sine(const ControlStudy& study, ControlCase (*sine)(double), const std::string& thesis,
               bool rotation) {
  std::vector<Contrast> cases;
  for (const double kg : kSimulatedPayloads_kg) {
    const ControlFigures &of_sine = study.Of(sine(kg)),
                         &square = Square(study, LoopKind::kSensors, kg);
    for (std::size_t i = 0; i < 2; ++i) {
      cases.push_back(
          {square.Of(square.peak_bending_mm[i]), of_sine.Of(of_sine.peak_bending_mm[i])});
      if (!rotation) continue;
      cases.push_back({square.Of(square.peak_angle_deg[i]), of_sine.Of(of_sine.peak_angle_deg[i])});
    }
  }
  const auto each = [&](bool is_sine, const auto& figure, int digits) {
    return PerPayload(kSimulatedPayloads_kg, [&](double kg) {
      return PairText(
          (is_sine ? study.Of(sine(kg)) : Square(study, LoopKind::kSensors, kg)).*figure, digits);
    });
  };
  return {"7.5", thesis,
          "largest angles of joints 1 and 2 " + each(true, &ControlFigures::peak_angle_deg, 3) +
              " deg, square " + each(false, &ControlFigures::peak_angle_deg, 3) +
              " deg; largest bending of links 1 and 2 " +
              each(true, &ControlFigures::peak_bending_mm, 3) + " mm, square " +
              each(false, &ControlFigures::peak_bending_mm, 3) + " mm," +
              AtPayloads(kSimulatedPayloads_kg) + SensorSettings(study),
          WorseRule(cases, 0.0)};
}

Statement SineLag(const ControlStudy& study) {
  std::vector<std::array<double, 2>> lags;
  for (const double kg : kSimulatedPayloads_kg) {
    for (std::size_t i = 0; i < 2; ++i) {
      lags.push_back({study.Of(SmallSineCase(kg)).lag_s[i].median,
                      Square(study, LoopKind::kSensors, kg).lag_s[i].median});
    }
  }
  const auto each = [&](ControlCase (*of)(double)) {
    return PerPayload(kSimulatedPayloads_kg, [&](double kg) {
      const ControlFigures& f = study.Of(of(kg));
      return Figure(1e3 * f.lag_s[0].median, 2) + " " + Figure(1e3 * f.lag_s[1].median, 2);
    });
  };
  return {"7.5", "with the sine the joints lag slightly more behind the reference",
          "lag of joints 1 and 2 that fits the errors best " + each(SmallSineCase) +
              " ms, square " + each([](double kg) { return ChangedCase({}, kg); }) + " ms," +
              AtPayloads(kSimulatedPayloads_kg) + "; slightly: by up to " +
              Figure(1e3 * kSlightLag_s, 1) + " ms; equal amplitude of torque" +
              SensorSettings(study),
          SlightlyMoreLagRule(lags)};
}

Statement WorseThanSimulation(const ControlStudy& study) {
  std::vector<Contrast> cases;
  for (const double kg : kSimulatedPayloads_kg) {
    const auto& [real, ideal] = WithSensorsAndIdeal(study, kg);
    cases.push_back({real.Of(real.rms_sum_deg), ideal.Of(ideal.rms_sum_deg)});
  }
  return {"7.5", "the experiment performs slightly worse than the simulation",
          "sum of the rms errors " +
              InBoth(study, kSimulatedPayloads_kg,
                     [](const ControlFigures& f) { return FigureOrNever(f.rms_sum_deg); }) +
              " deg" + AtPayloads(kSimulatedPayloads_kg) + BothSettings(study),
          WorseRule(cases)};
}

Statement Rougher(const ControlStudy& study) {
  std::vector<Contrast> cases;
  for (const double kg : kSimulatedPayloads_kg) {
    const auto& [real, ideal] = WithSensorsAndIdeal(study, kg);
    for (std::size_t i = 0; i < 2; ++i) {
      cases.push_back({real.Of(real.roughness_rad_s2[i]), ideal.Of(ideal.roughness_rad_s2[i])});
    }
  }
  return {"7.5", "the joints' trajectories are less smooth than in the simulation",
          "rms acceleration of joints 1 and 2 while they come to rest " +
              InBoth(study, kSimulatedPayloads_kg,
                     [](const ControlFigures& f) { return PairText(f.roughness_rad_s2); }) +
              " rad/s2" + AtPayloads(kSimulatedPayloads_kg) + BothSettings(study),
          WorseRule(cases)};
}

Statement LastsAsLong(const ControlStudy& study) {
  std::vector<bool> parts;
  for (const double kg : kSimulatedPayloads_kg) {
    const auto& [real, ideal] = WithSensorsAndIdeal(study, kg);
    parts.push_back(AsLong(real.still_15mm_s.median, ideal.still_15mm_s.median));
    parts.push_back(AsLong(real.still_5mm_s.median, ideal.still_5mm_s.median));
  }
  return {"7.5", "the vibrations last about as long as in the simulation",
          "the tip stays within 15 (5) mm after " +
              InBoth(study, kSimulatedPayloads_kg,
                     [](const ControlFigures& f) {
                       return FigureOrNever(f.still_15mm_s, 2) + " (" +
                              FigureOrNever(f.still_5mm_s, 2) + ")";
                     }) +
              " s" + AtPayloads(kSimulatedPayloads_kg) + BothSettings(study),
          VerdictOf(parts)};
}

std::vector<double> SumsOf(const ControlStudy& study, LoopKind loop) {
  std::vector<double> sums;
  for (const double kg : kSimulatedPayloads_kg) {
    sums.push_back(Square(study, loop, kg).rms_sum_deg.median);
  }
  return sums;
}

Statement PayloadMattersLess(const ControlStudy& study) {
  const auto real = SumsOf(study, LoopKind::kSensors), ideal = SumsOf(study, LoopKind::kIdeal);
  return {"7.5", "the payload matters less to the performance than in the simulation",
          "over 0.01, 0.1 and 0.2 kg the sum of the rms errors spreads by " +
              Figure(100.0 * SpreadShare(real), 2) + " % of the least, in the simulation by " +
              Figure(100.0 * SpreadShare(ideal), 2) + " %" + BothSettings(study),
          LessSpreadRule(real, ideal)};
}

Statement HeavyBetterThanLight(const ControlStudy& study) {
  std::vector<Contrast> cases;
  for (const FigureOf figure : {&ControlFigures::rms_sum_deg, &ControlFigures::last_second_mm}) {
    const ControlFigures &light = Square(study, LoopKind::kSensors, 0.01),
                         &heavy = Square(study, LoopKind::kSensors, 0.2);
    cases.push_back({light.Of(light.*figure), heavy.Of(heavy.*figure)});
  }
  constexpr std::array<double, 2> kEnds_kg = {0.01, 0.2};
  return {"7.5", "the performance with 0.2 kg is better than with 0.01 kg",
          "sum of the rms errors " +
              InBoth(study, kEnds_kg,
                     [](const ControlFigures& f) { return FigureOrNever(f.rms_sum_deg); }) +
              " deg, motion of the tip in the last second " +
              InBoth(study, kEnds_kg,
                     [](const ControlFigures& f) { return FigureOrNever(f.last_second_mm, 2); }) +
              " mm rms" + AtPayloads(kEnds_kg) + BothSettings(study),
          WorseRule(cases)};
}

Statement SimulatedEndsAlike(const ControlStudy& study) {
  const double light = Square(study, LoopKind::kIdeal, 0.01).rms_sum_deg.median,
               heavy = Square(study, LoopKind::kIdeal, 0.2).rms_sum_deg.median;
  constexpr double kSameLevel = 0.25;
  return {"7.5", "in the simulation the errors with 0.01 and 0.2 kg are at the same level",
          "sum of the rms errors " + Figure(light) + " and " + Figure(heavy) +
              " deg; the same level: within " + Figure(100.0 * kSameLevel, 2) + " %" +
              IdealSettings(study),
          VerdictOf({SpreadShare({light, heavy}) <= kSameLevel})};
}

}  // namespace

std::vector<Statement> ExperimentStatements(const ControlStudy& study) {
  return {Damped(study, LoopKind::kSensors, "7.5", "the vibrations are effectively controlled"),
          Damped(study, LoopKind::kSensors, "7.5",
                 "(not in the thesis) so they are by the law of this program", kShippedLaw),
          NoFinalError(study, LoopKind::kSensors, "7.5"),
          Delay(study),
          Differences(study),
          WorseThanSimulation(study),
          Rougher(study),
          LastsAsLong(study),
          PayloadMattersLess(study),
          HeavyBetterThanLight(study),
          SimulatedEndsAlike(study),
          Sine(study, SmallSineCase,
               "with the same amplitude a sinusoidal command turns the joints and bends the links "
               "less than a square one",
               true),
          Sine(study, SineCase, "(not in the thesis) so it does for the same rotation", false),
          SineLag(study)};
}

}  // namespace flexarm
