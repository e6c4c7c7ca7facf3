// Section 7.4: the simulations. The thesis's know the state and have no delay.

#include <algorithm>
#include <cmath>
#include <complex>

#include "controller/design/design_controller.h"
#include "controller/law/design.h"
#include "model/arm/linearization.h"
#include "model/math/dense_decompositions.h"
#include "tools/thesis/chapter7_parts.h"
#include "tools/thesis/control_text.h"
#include "tools/thesis/rest_statements.h"
#include "tools/thesis/rig_needs.h"

namespace flexarm {
namespace {

constexpr double kVibration_rad_s = 20.0;  // half the lowest torque mode
constexpr double kPeakAlpha = 3.2;         // 7.3.3: more degrades the performance

const auto kSquare = [](double kg) { return ChangedCase({}, kg); };

double BestAlphaOf(const ControlStudy& study, LoopKind loop, double kg) {
  const auto rms = [&](double alpha) {
    const ControlFigures& f = FiguresOf(study, loop, AlphaCase(alpha, kg));
    return f.all_completed() ? f.rms_sum_deg.median : std::numeric_limits<double>::infinity();
  };
  return *std::min_element(kAlphas.begin(), kAlphas.end(),
                           [&](double a, double b) { return rms(a) < rms(b); });
}

Statement BestAlpha(const ControlStudy& study) {
  std::vector<double> best;
  std::string text = "the sum of the rms errors is least at alpha =";
  for (const LoopKind loop : {LoopKind::kIdeal, LoopKind::kSensors}) {
    text += (loop == LoopKind::kIdeal ? " " : "; with sensors ") +
            PerPayload(kTestedPayloads_kg,
                       [&](double kg) {
                         best.push_back(BestAlphaOf(study, loop, kg));
                         return Figure(best.back(), 2) + EndOfGrid(best.back(), kAlphas);
                       }) +
            (loop == LoopKind::kIdeal ? " with known state" : "");
  }
  std::string grid;
  for (const double alpha : kAlphas) grid += (grid.empty() ? "alpha " : ", ") + Figure(alpha, 2);
  return {"7.3", "the best alpha is near 3",
          text + AtPayloads(kTestedPayloads_kg) + BothSettings(study, grid),
          NearRule(best, 2.5, 3.5)};
}

Statement LargeAlpha(const ControlStudy& study) {
  const ControlCase reference = AlphaCase(kPeakAlpha, 0.1),
                    largest = AlphaCase(kAlphas.back(), 0.1);
  std::vector<Contrast> cases;
  std::string text;
  for (const LoopKind loop : {LoopKind::kIdeal, LoopKind::kSensors}) {
    cases = Joined(cases, Contrasts(study, loop, largest, reference, kTestedPayloads_kg,
                                    &ControlFigures::rms_sum_deg));
    text += loop == LoopKind::kIdeal ? "known state" : "; sensors";
    for (const double alpha : kAlphas) {
      if (alpha < kPeakAlpha) continue;
      text += (alpha == kPeakAlpha ? ": alpha " : ", ") + Figure(alpha, 2) + ": " +
              PerPayload(kTestedPayloads_kg, [&](double kg) {
                const ControlFigures& f = FiguresOf(study, loop, AlphaCase(alpha, kg));
                return f.all_completed()
                           ? Figure(f.rms_sum_deg.median)
                           : Count(static_cast<std::ptrdiff_t>(f.completed)) + " of " +
                                 Count(static_cast<std::ptrdiff_t>(f.runs)) + " complete";
              });
    }
  }
  return {"7.3", "the performance degrades for alpha above 3.2",
          "sum of the rms errors, deg, " + text + AtPayloads(kTestedPayloads_kg) +
              BothSettings(study, "alpha " + Figure(kPeakAlpha, 2) + " to " +
                                      Figure(kAlphas.back(), 2) + ", judged at the last"),
          WorseRule(cases)};
}

// The lowest and the highest frequency of the links' vibrations in the nominal closed loop, rad/s:
// the oscillations faster than the joint dynamics of the regulator.
std::array<double, 2> ClosedLoopModes(const RigConfig& config, double alpha) {
  const RigConfig at = WithOverrides(config, AlphaCase(alpha, 0.1).overrides);
  const Design design = DesignController(at);
  const double period_s = at.loop.period_s();
  const Eigen::MatrixXd closed = design.A - design.B * design.K;
  const Eigen::VectorXcd z = closed.eigenvalues();
  std::vector<double> frequency;
  for (const std::complex<double>& pole : z) {
    const std::complex<double> s = std::log(pole) / period_s;
    if (s.imag() > 0.0 && std::abs(s) > kVibration_rad_s) frequency.push_back(std::abs(s));
  }
  std::sort(frequency.begin(), frequency.end());
  return {frequency.front(), frequency.back()};
}

Statement AlphaAndFrequency(const ControlStudy& study) {
  const auto slow = ClosedLoopModes(study.config(), 0.0),
             fast = ClosedLoopModes(study.config(), kAlphas.back());
  constexpr double kMore = 1.1;
  return {"7.3", "a larger alpha raises the frequency of the vibrations",
          "the links' vibrations in the nominal closed loop, lowest and highest: " +
              Figure(slow[0]) + " and " + Figure(slow[1]) + " rad/s with alpha 0, " +
              Figure(fast[0]) + " and " + Figure(fast[1]) + " with alpha " +
              Figure(kAlphas.back(), 2) + " [poles of A - B K, payload of the config]",
          VerdictOf({fast[0] > kMore * slow[0], fast[1] > kMore * slow[1]})};
}

std::string IdealRmsErrors(const ControlStudy& study) {
  return "rms errors of joints 1 and 2, deg, " +
         PerPayload(kSimulatedPayloads_kg,
                    [&](double kg) {
                      return PairText(FiguresOf(study, LoopKind::kIdeal, kSquare(kg)).rms_deg);
                    }) +
         AtPayloads(kSimulatedPayloads_kg) + IdealSettings(study);
}

Statement BestAtNominal(const ControlStudy& study) {
  std::vector<std::array<OverSeeds, 3>> joints;
  for (const std::size_t joint : {0U, 1U}) {
    const auto rms = [&](double kg) {
      return FiguresOf(study, LoopKind::kIdeal, kSquare(kg)).rms_deg[joint];
    };
    joints.push_back({rms(0.01), rms(0.1), rms(0.2)});
  }
  return {"7.4", "the performance is best with the payload that the nominal model has, 0.1 kg",
          IdealRmsErrors(study), BestInMiddleRule(joints)};
}

Statement SecondLink(const ControlStudy& study) {
  std::vector<Contrast> cases;
  for (const double kg : kSimulatedPayloads_kg) {
    const ControlFigures& f = FiguresOf(study, LoopKind::kIdeal, kSquare(kg));
    cases.push_back({f.Of(f.rms_deg[0]), f.Of(f.rms_deg[1])});
  }
  return {"7.4", "link 2 performs much better than link 1", IdealRmsErrors(study),
          WorseRule(cases)};
}

LoadFigures LoadOf(const ControlStudy& study, LoopKind loop, double payload_kg) {
  const ControlFigures& f = FiguresOf(study, loop, kSquare(payload_kg));
  ArmParameters arm = study.config().arm;
  arm.payload_mass_kg = payload_kg;
  return {.torque_nm = f.torque_rms_nm,
          .bending_mm = f.peak_bending_mm,
          .lowest_hz = FreeMotorFrequenciesHz(ArmModel(arm, {4, 4}), 0.0)[0]};
}

std::string LoadText(const LoadFigures& load) {
  return "torque rms " + PairText(load.torque_nm) + " N m, largest bending " +
         PairText(load.bending_mm) + " mm, lowest frequency " + Figure(load.lowest_hz) + " Hz";
}

Statement HeavierPayload(const ControlStudy& study) {
  const LoadFigures light = LoadOf(study, LoopKind::kIdeal, kSimulatedPayloads_kg.front()),
                    heavy = LoadOf(study, LoopKind::kIdeal, kSimulatedPayloads_kg.back());
  const LoadFigures measured_light = LoadOf(study, LoopKind::kSensors, 0.01),
                    measured_heavy = LoadOf(study, LoopKind::kSensors, 0.2);
  return {"7.4", "a heavier payload asks more torque, with larger bending at lower frequencies",
          "joints and links 1 and 2, at 0.01 kg: " + LoadText(light) + "; at 0.2 kg: " +
              LoadText(heavy) + "; with sensors, bending " + PairText(measured_light.bending_mm) +
              " and " + PairText(measured_heavy.bending_mm) + " mm" + BothSettings(study),
          HeavierRule({{light, heavy}, {measured_light, measured_heavy}})};
}

Statement Spillover(const ControlStudy& study) {
  std::vector<Contrast> cases;
  double largest = 0.0;
  for (const LoopKind loop : {LoopKind::kIdeal, LoopKind::kSensors}) {
    const ControlFigures& four = FiguresOf(study, loop, kSquare(0.1));
    for (const char* modes : {"2", "3", "6"}) {
      const ControlFigures& f =
          FiguresOf(study, loop, ChangedCase({std::string("sim.plant_modes=") + modes}, 0.1));
      cases.push_back({f.Of(f.rms_sum_deg), four.Of(four.rms_sum_deg)});
      for (std::size_t i = 0; i < 2; ++i) {
        largest = std::max(largest, std::abs(f.rms_deg[i].median / four.rms_deg[i].median - 1.0));
      }
    }
  }
  return {"7.4", "a plant with more modes than the nominal model causes no instability",
          "with 2, 3 and 6 modes a link in the plant the joints' rms errors are within " +
              Figure(100.0 * largest, 2) + " % of those with 4, at 0.1 kg" + BothSettings(study),
          AsGoodRule(cases, kSameShare)};
}

// A nominal model of 12 states against T16, four angles and two modes a link.
Statement TwelveStates(const ControlStudy& study, const char* twelve, const char* about) {
  constexpr double kAsGood = 0.1;
  const std::string said =
      std::string("a nominal model of order 12 is as good as one of order 16; 12: ") + about;
  const bool shipped = twelve == std::string("R12");
  const RigConfig& config = study.config();
  const std::string lacks = shipped ? LacksR12(config) : LacksTwoModes(config);
  if (!lacks.empty()) return NotForThisRig("7.4", said, lacks);
  const ControlCase of_twelve = ChangedCase({std::string("controller.nominal=") + twelve}, 0.1),
                    sixteen = ChangedCase({"controller.nominal=T16"}, 0.1);
  const ControlCase own = shipped ? kSquare(0.1) : of_twelve;
  std::vector<Contrast> cases;
  std::string text;
  for (const LoopKind loop : {LoopKind::kIdeal, LoopKind::kSensors}) {
    cases = Joined(cases, Contrasts(study, loop, own, sixteen, kTestedPayloads_kg,
                                    &ControlFigures::rms_sum_deg));
    const auto rms = [&](const ControlCase& of) {
      return PerPayload(kTestedPayloads_kg, [&](double kg) {
        ControlCase at = of;
        at.payload_kg = kg;
        return FigureOrNever(FiguresOf(study, loop, at).rms_sum_deg);
      });
    };
    text += std::string(loop == LoopKind::kIdeal ? "known state" : "; sensors") + ": " + twelve +
            " " + CompletedText(study, loop, own, kTestedPayloads_kg) + ", T16 " +
            CompletedText(study, loop, sixteen, kTestedPayloads_kg) + ", sum of the rms errors " +
            rms(own) + " against " + rms(sixteen) + " deg";
  }
  return {"7.4", said, text + AtPayloads(kTestedPayloads_kg) + BothSettings(study),
          AsGoodRule(cases, kAsGood)};
}

}  // namespace

std::vector<Statement> SimulationStatements(const ControlStudy& study) {
  return {
      BestAlpha(study),
      LargeAlpha(study),
      AlphaAndFrequency(study),
      Damped(study, LoopKind::kIdeal, "7.4", "the vibrations are damped within 2 s of the command"),
      NoFinalError(study, LoopKind::kIdeal, "7.4"),
      BestAtNominal(study),
      SecondLink(study),
      HeavierPayload(study),
      Spillover(study),
      TwelveStates(study, "T12", "four angles and one mode a link, as in the thesis"),
      TwelveStates(study, "R12", "two angles and two modes a link, as shipped")};
}

}  // namespace flexarm
