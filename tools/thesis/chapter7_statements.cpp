#include "tools/thesis/chapter7_statements.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "controller/design/design_controller.h"
#include "controller/law/design.h"
#include "model/arm/linearization.h"
#include "model/math/dense_decompositions.h"

namespace flexarm {
namespace {

using Overrides = std::vector<std::string>;

constexpr double kSettled_s = 2.0;         // the thesis: vibrations are damped within 2 seconds
constexpr double kSame = 0.05;             // smaller relative differences count as equal
constexpr double kVibration_rad_s = 20.0;  // half the lowest torque mode

std::string Percent(double from, double to) { return Figure(100.0 * (to / from - 1.0), 2) + " %"; }

// "1.08 0.71" of both joints.
std::string Pair(const std::array<double, 2>& values) {
  return Figure(values[0]) + " " + Figure(values[1]);
}

// figure(payload) for the thesis's three payloads, with slashes between, and the unit.
template <typename F>
std::string AtPayloads(const F& figure, const std::string& unit = "") {
  std::string text;
  for (const double payload_kg : kThesisPayloads_kg) {
    text += (text.empty() ? "" : " / ") + figure(payload_kg);
  }
  return text + unit + " at 0.01 / 0.1 / 0.2 kg";
}

template <typename F>
bool AtAllPayloads(const F& holds) {
  return std::all_of(kThesisPayloads_kg.begin(), kThesisPayloads_kg.end(), holds);
}

template <typename F>
bool AtAnyPayload(const F& holds) {
  return std::any_of(kThesisPayloads_kg.begin(), kThesisPayloads_kg.end(), holds);
}

std::string CompletedOf(const ControlStudy& study, const Overrides& overrides) {
  std::size_t completed = 0, runs = 0;
  for (const double payload_kg : kThesisPayloads_kg) {
    completed += study.Of(ChangedCase(overrides, payload_kg)).completed;
    runs += study.Of(ChangedCase(overrides, payload_kg)).runs;
  }
  return std::to_string(completed) + " of " + std::to_string(runs) + " runs complete";
}

bool AllComplete(const ControlStudy& study, const Overrides& overrides) {
  return AtAllPayloads([&](double payload_kg) {
    const ControlFigures& f = study.Of(ChangedCase(overrides, payload_kg));
    return f.completed == f.runs;
  });
}

Statement WithoutAlpha(const ControlStudy& study) {
  const auto final_at = [&](double alpha, double payload_kg) {
    return study.Of(AlphaCase(alpha, payload_kg)).worst_final_deg();
  };
  const Overrides none = AlphaCase(0.0, 0.1).overrides;
  const bool bad = AtAllPayloads([&](double payload_kg) {
    return final_at(0.0, payload_kg) > 4.0 * final_at(3.0, payload_kg);
  });
  const bool unstable = !AllComplete(study, none);
  return {"7.3", "without a prescribed degree of stability (alpha = 0) the loop is unstable or bad",
          "final errors, alpha 0 against 3: " +
              AtPayloads(
                  [&](double payload_kg) {
                    return Figure(final_at(0.0, payload_kg)) + " against " +
                           Figure(final_at(3.0, payload_kg), 2);
                  },
                  " deg") +
              "; with alpha 0, " + CompletedOf(study, none),
          bad ? (unstable ? Verdict::kHolds : Verdict::kInPart) : Verdict::kDoesNot};
}

Statement BestAlpha(const ControlStudy& study) {
  const auto best = [&](double payload_kg) {
    return *std::min_element(kAlphas.begin(), kAlphas.end(), [&](double a, double b) {
      return study.Of(AlphaCase(a, payload_kg)).rms_sum_deg() <
             study.Of(AlphaCase(b, payload_kg)).rms_sum_deg();
    });
  };
  const auto near = [&](double payload_kg) {
    return best(payload_kg) >= 2.5 && best(payload_kg) <= 3.5;
  };
  return {"7.4", "the best alpha is near 3",
          "the sum of the joints' rms errors is least at alpha = " +
              AtPayloads([&](double payload_kg) { return Figure(best(payload_kg), 2); }),
          AtAllPayloads(near)  ? Verdict::kHolds
          : AtAnyPayload(near) ? Verdict::kInPart
                               : Verdict::kDoesNot};
}

Statement LargeAlpha(const ControlStudy& study) {
  const auto rms = [&](double alpha, double payload_kg) {
    return study.Of(AlphaCase(alpha, payload_kg)).rms_sum_deg();
  };
  const auto worse = [&](double payload_kg) {
    return !(rms(4.0, payload_kg) < (1.0 + kSame) * rms(3.2, payload_kg));
  };
  return {"7.4", "the performance degrades for alpha above 3.2",
          "from 3.2 to 4 the sum of the rms errors changes by " +
              AtPayloads([&](double payload_kg) {
                return Percent(rms(3.2, payload_kg), rms(4.0, payload_kg));
              }) +
              ", to 5 by " + AtPayloads([&](double payload_kg) {
                return Percent(rms(3.2, payload_kg), rms(5.0, payload_kg));
              }) +
              "; with alpha 5, " + CompletedOf(study, AlphaCase(5.0, 0.1).overrides),
          AtAllPayloads(worse)  ? Verdict::kHolds
          : AtAnyPayload(worse) ? Verdict::kInPart
                                : Verdict::kDoesNot};
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
             fast = ClosedLoopModes(study.config(), 5.0);
  const bool higher = fast[0] > 1.1 * slow[0] && fast[1] > 1.1 * slow[1];
  return {"7.4", "a larger alpha raises the frequency of the vibrations",
          "the links' vibrations in the nominal closed loop, lowest and highest: " +
              Figure(slow[0]) + " and " + Figure(slow[1]) + " rad/s with alpha 0, " +
              Figure(fast[0]) + " and " + Figure(fast[1]) + " with alpha 5",
          higher ? Verdict::kHolds : Verdict::kDoesNot};
}

Statement Blend(const ControlStudy& study, const char* sign, const char* name) {
  const auto rms1 = [&](double vartheta) {
    return study.Of(VarthetaCase(vartheta, sign)).rms_deg[0];
  };
  std::string text = "rms of joint 1 at vartheta 0, 0.25, 0.35, 0.5, 1:";
  for (const double vartheta : kVarthetas) {
    text += (vartheta == 0.0 ? " " : ", ") + Figure(rms1(vartheta));
  }
  const double ends = std::min(rms1(0.0), rms1(1.0));
  return {"7.3", std::string("vartheta = 0.5 is better than 0 and 1, (7.25) ") + name,
          text + " deg",
          rms1(0.5) < 0.8 * ends             ? Verdict::kHolds
          : rms1(0.5) < (1.0 - kSame) * ends ? Verdict::kInPart
                                             : Verdict::kDoesNot};
}

Statement Damped(const ControlStudy& study) {
  const auto settling = [&](double payload_kg) {
    return study.Of(ChangedCase({}, payload_kg)).settling_s;
  };
  return {"7.4", "the vibrations are damped within 2 s of the command",
          "the tip stays within 15 mm of its resting place after " +
              AtPayloads([&](double payload_kg) { return Figure(settling(payload_kg), 2); }, " s"),
          AtAllPayloads([&](double payload_kg) { return settling(payload_kg) < kSettled_s; })
              ? Verdict::kHolds
              : Verdict::kDoesNot};
}

Statement NoFinalError(const ControlStudy& study) {
  const double count_deg = 360.0 / study.config().sensors.encoder.front().counts_per_turn;
  const auto final = [&](double payload_kg) {
    return study.Of(ChangedCase({}, payload_kg)).worst_final_deg();
  };
  return {"7.4", "the steady state error is zero",
          "final error " +
              AtPayloads([&](double payload_kg) { return Figure(final(payload_kg), 2); }, " deg") +
              "; one count of the encoder is " + Figure(count_deg, 2) + " deg",
          AtAllPayloads([&](double payload_kg) { return final(payload_kg) < 2.0 * count_deg; })
              ? Verdict::kHolds
              : Verdict::kDoesNot};
}

Statement BestAtNominal(const ControlStudy& study) {
  const auto rms = [&](double payload_kg, std::size_t joint) {
    return study.Of(ChangedCase({}, payload_kg)).rms_deg[joint];
  };
  const auto best = [&](std::size_t joint) {
    return rms(0.1, joint) < rms(0.01, joint) && rms(0.1, joint) < rms(0.2, joint);
  };
  return {"7.4", "the performance is best with the payload that the nominal model has, 0.1 kg",
          "rms errors " + AtPayloads([&](double kg) {
            return Pair(study.Of(ChangedCase({}, kg)).rms_deg);
          }) + ", deg",
          best(0) && best(1)   ? Verdict::kHolds
          : best(0) || best(1) ? Verdict::kInPart
                               : Verdict::kDoesNot};
}

Statement SecondLink(const ControlStudy& study) {
  const auto better = [&](double payload_kg) {
    const ControlFigures& f = study.Of(ChangedCase({}, payload_kg));
    return f.rms_deg[1] < f.rms_deg[0];
  };
  return {"7.4", "link 2 performs much better than link 1",
          "rms errors of joints 1 and 2 " + AtPayloads([&](double kg) {
            return Pair(study.Of(ChangedCase({}, kg)).rms_deg);
          }) + ", deg: the payload affects joint 2 most",
          AtAllPayloads(better)  ? Verdict::kHolds
          : AtAnyPayload(better) ? Verdict::kInPart
                                 : Verdict::kDoesNot};
}

double LowestFrequencyHz(const RigConfig& config, double payload_kg) {
  ArmParameters arm = config.arm;
  arm.payload_mass_kg = payload_kg;
  return FreeMotorFrequenciesHz(ArmModel(arm, {4, 4}), 0.0)[0];
}

Statement HeavierPayload(const ControlStudy& study) {
  const ControlFigures &light = study.Of(ChangedCase({}, 0.01)),
                       &heavy = study.Of(ChangedCase({}, 0.2));
  const double light_hz = LowestFrequencyHz(study.config(), 0.01),
               heavy_hz = LowestFrequencyHz(study.config(), 0.2);
  const int held = (heavy.torque_rms_nm[1] > light.torque_rms_nm[1] ? 1 : 0) +
                   (heavy.peak_bending_mm[1] > light.peak_bending_mm[1] ? 1 : 0) +
                   (heavy_hz < light_hz ? 1 : 0);
  return {"7.4", "a heavier payload asks more torque, with larger bending at lower frequencies",
          "from 0.01 to 0.2 kg: torque rms " + Pair(light.torque_rms_nm) + " -> " +
              Pair(heavy.torque_rms_nm) + " N m, largest bending " + Pair(light.peak_bending_mm) +
              " -> " + Pair(heavy.peak_bending_mm) + " mm, lowest frequency " + Figure(light_hz) +
              " -> " + Figure(heavy_hz) + " Hz",
          held == 3  ? Verdict::kHolds
          : held > 0 ? Verdict::kInPart
                     : Verdict::kDoesNot};
}

Statement Spillover(const ControlStudy& study) {
  const ControlFigures& four = study.Of(ChangedCase({}, 0.1));
  double largest = 0.0;
  bool complete = true;
  for (const char* modes : {"2", "3", "6"}) {
    const ControlFigures& f = study.Of(ChangedCase({std::string("sim.plant_modes=") + modes}, 0.1));
    complete = complete && f.completed == f.runs;
    for (std::size_t i = 0; i < 2; ++i) {
      largest = std::max(largest, std::abs(f.rms_deg[i] / four.rms_deg[i] - 1.0));
    }
  }
  return {"7.4", "a plant with more modes than the nominal model causes no instability",
          "with 2, 3 and 6 modes a link in the plant the rms errors are within " +
              Figure(100.0 * largest, 2) + " % of those with 4",
          complete && largest < kSame ? Verdict::kHolds : Verdict::kDoesNot};
}

// Compares the models with four angles and one mode a link (12 states) or two (16).
Statement TwelveStates(const ControlStudy& study) {
  const Overrides twelve = {"controller.nominal=T12"}, sixteen = {"controller.nominal=T16"};
  const auto rms = [&](const Overrides& model, double kg) {
    return study.Of(ChangedCase(model, kg)).rms_sum_deg();
  };
  const auto as_good = [&](double kg) { return rms(twelve, kg) < 1.1 * rms(sixteen, kg); };
  return {"7.4", "a nominal model of order 12 is as good as one of order 16",
          "four angles and one mode a link (12): " + CompletedOf(study, twelve) +
              "; two modes a link (16): " + CompletedOf(study, sixteen) +
              ", sums of the rms errors " +
              AtPayloads([&](double kg) { return Figure(rms(sixteen, kg)); }, " deg") +
              "; two angles and two modes a link (12 as well): " + CompletedOf(study, {}) + ", " +
              AtPayloads([&](double kg) { return Figure(rms({}, kg)); }, " deg"),
          AtAllPayloads(as_good)   ? Verdict::kHolds
          : AllComplete(study, {}) ? Verdict::kInPart
                                   : Verdict::kDoesNot};
}

Statement Delay(const ControlStudy& study) {
  const Overrides without = {"controller.prediction=false"};
  const bool destabilises = !AllComplete(study, without), cured = AllComplete(study, {});
  return {"7.5", "the computation's delay can destabilise the loop, and prediction cures it",
          "one sample of delay: without prediction " + AtPayloads([&](double payload_kg) {
            const ControlFigures& f = study.Of(ChangedCase(without, payload_kg));
            return std::to_string(f.completed) + " of " + std::to_string(f.runs);
          }) + " complete, with it all",
          destabilises && cured ? Verdict::kHolds : Verdict::kDoesNot};
}

Statement Differences(const ControlStudy& study) {
  const Overrides filtered = {"estimator.name=difference"},
                  open = {"estimator.name=difference", "sensors.strain_input.filter_hz=0",
                          "controller.alpha=2"};
  return {"7.5",
          "backward differences of the fitted coordinates, behind the gauges' 20 Hz filter, "
          "are satisfactory",
          "with the filter " + CompletedOf(study, filtered) + "; without it, at alpha 2, " +
              CompletedOf(study, open),
          AllComplete(study, filtered) ? Verdict::kHolds
          : AllComplete(study, open)   ? Verdict::kInPart
                                       : Verdict::kDoesNot};
}

Statement Modification(const ControlStudy& study) {
  const Overrides original = {"controller.name=sobel-original"};
  const auto final_of = [&](const Overrides& law, double kg) {
    return study.Of(ChangedCase(law, kg)).worst_final_deg();
  };
  const auto rms_of = [&](const Overrides& law, double kg) {
    return study.Of(ChangedCase(law, kg)).rms_sum_deg();
  };
  const auto better = [&](double kg) {
    return final_of({}, kg) < 0.5 * final_of(original, kg) && rms_of({}, kg) < rms_of(original, kg);
  };
  return {"7.3, 8.3", "the modification improves Sobel's algorithm significantly",
          "final errors of the original " +
              AtPayloads([&](double kg) { return Figure(final_of(original, kg), 2); }, " deg") +
              ", modified " +
              AtPayloads([&](double kg) { return Figure(final_of({}, kg), 2); }, " deg") +
              "; sums of the rms errors " +
              AtPayloads([&](double kg) { return Figure(rms_of(original, kg)); }, " deg") +
              ", modified " + AtPayloads([&](double kg) { return Figure(rms_of({}, kg)); }, " deg"),
          AtAllPayloads(better)  ? Verdict::kHolds
          : AtAnyPayload(better) ? Verdict::kInPart
                                 : Verdict::kDoesNot};
}

Statement Adaptation(const ControlStudy& study) {
  const Overrides off = {"controller.adaptation=false"};
  const auto rms = [&](const Overrides& law, double kg) {
    return study.Of(ChangedCase(law, kg)).rms_sum_deg();
  };
  const auto helps = [&](double kg) { return rms({}, kg) < (1.0 - kSame) * rms(off, kg); };
  return {"7.3", "the adaptation copes with an unknown payload",
          "sums of the rms errors without adaptation " +
              AtPayloads([&](double kg) { return Figure(rms(off, kg)); }, " deg") + ", with it " +
              AtPayloads([&](double kg) { return Figure(rms({}, kg)); }, " deg") +
              "; at 0.5 and 1 kg " + Figure(rms(off, 0.5)) + " and " + Figure(rms(off, 1.0)) +
              " against " + Figure(rms({}, 0.5)) + " and " + Figure(rms({}, 1.0)) + " deg",
          AtAllPayloads(helps)                              ? Verdict::kHolds
          : AtAnyPayload(helps) || helps(0.5) || helps(1.0) ? Verdict::kInPart
                                                            : Verdict::kDoesNot};
}

Statement Sine(const ControlStudy& study) {
  const auto sine = [&](double kg) { return study.Of(SineCase(kg)); };
  const auto smaller = [&](double kg) {
    return sine(kg).peak_bending_mm[0] < study.Of(ChangedCase({}, kg)).peak_bending_mm[0];
  };
  return {"7.5", "a sinusoidal command bends the links less than a square one",
          "for the same rotation, largest bending of link 1 " +
              AtPayloads([&](double kg) { return Figure(sine(kg).peak_bending_mm[0]); }, " mm") +
              ", square " + AtPayloads([&](double kg) {
                return Figure(study.Of(ChangedCase({}, kg)).peak_bending_mm[0]);
              }) +
              " mm. The thesis compares equal amplitudes of torque, which turn the joints less",
          AtAllPayloads(smaller) ? Verdict::kHolds : Verdict::kInPart};
}

}  // namespace

std::vector<Statement> Chapter7Statements(const ControlStudy& study) {
  return {Modification(study),
          WithoutAlpha(study),
          Blend(study, "printed", "as printed"),
          Blend(study, "corrected", "with the sign that follows from its derivation"),
          Adaptation(study),
          BestAlpha(study),
          LargeAlpha(study),
          AlphaAndFrequency(study),
          Damped(study),
          NoFinalError(study),
          BestAtNominal(study),
          SecondLink(study),
          HeavierPayload(study),
          Spillover(study),
          TwelveStates(study),
          Delay(study),
          Differences(study),
          Sine(study)};
}

}  // namespace flexarm
