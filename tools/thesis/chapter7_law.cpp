// Section 7.3: the modified algorithm, alpha and vartheta.

#include <algorithm>

#include "tools/thesis/chapter7_parts.h"
#include "tools/thesis/control_text.h"

namespace flexarm {
namespace {

const auto kSquareCase = [](double kg) { return ChangedCase({}, kg); };
const ControlCase kOriginal = ChangedCase({"controller.name=sobel-original"}, 0.1);

// "rms 1.8 / 1.9 (original 4.9 / 1.8) at .. kg" of one figure.
std::string AgainstOriginal(const ControlStudy& study, FigureOf figure, int digits) {
  const auto of = [&](const Overrides& law) {
    return PerPayload(kTestedPayloads_kg, [&](double kg) {
      return FigureOrNever(study.Of(ChangedCase(law, kg)).*figure, digits);
    });
  };
  return of({}) + ", original " + of(kOriginal.overrides);
}

Statement Modification(const ControlStudy& study) {
  std::vector<Contrast> cases;
  for (const FigureOf figure : {&ControlFigures::rms_sum_deg, &ControlFigures::worst_final_deg,
                                &ControlFigures::last_second_mm}) {
    cases = Joined(cases, Contrasts(study, LoopKind::kSensors, kOriginal, kSquareCase(0.1),
                                    kTestedPayloads_kg, figure));
  }
  return {"7.3, 8.3", "the modification improves Sobel's algorithm significantly",
          "sum of the rms errors " + AgainstOriginal(study, &ControlFigures::rms_sum_deg, 3) +
              " deg; final error " + AgainstOriginal(study, &ControlFigures::worst_final_deg, 2) +
              " deg; vibration of the tip in the last second " +
              AgainstOriginal(study, &ControlFigures::last_second_mm, 2) + " mm rms," +
              AtPayloads(kTestedPayloads_kg) + SensorSettings(study),
          WorseRule(cases)};
}

// The four loops of alpha 0: with the figure's vartheta (0) and the config's, in both loops.
struct AlphaZero {
  LoopKind loop;
  bool blended;  ///< vartheta of the config

  ControlCase At(double alpha, double kg) const {
    return blended ? AlphaCase(alpha, kg) : WithoutBlend(alpha == 0.0 ? "0" : "3", kg);
  }
  std::string Name(const ControlStudy& study) const {
    return std::string(loop == LoopKind::kIdeal ? "known state" : "sensors") + ", vartheta " +
           Figure(blended ? study.config().controller.vartheta : 0.0, 2);
  }
};
constexpr std::array<AlphaZero, 4> kAlphaZero = {{{LoopKind::kIdeal, false},
                                                  {LoopKind::kIdeal, true},
                                                  {LoopKind::kSensors, false},
                                                  {LoopKind::kSensors, true}}};

Statement AlphaZeroUnstable(const ControlStudy& study) {
  std::vector<bool> unstable;
  std::string text;
  for (const AlphaZero& row : kAlphaZero) {
    text += (text.empty() ? "" : "; ") + row.Name(study) + ": " +
            CompletedText(study, row.loop, row.At(0.0, 0.1), kTestedPayloads_kg);
    for (const double kg : kTestedPayloads_kg) {
      unstable.push_back(!FiguresOf(study, row.loop, row.At(0.0, kg)).all_completed());
    }
  }
  return {"7.3", "without a prescribed degree of stability (alpha = 0) the loop is unstable",
          text + AtPayloads(kTestedPayloads_kg) + BothSettings(study, "alpha 0"),
          VerdictOf(unstable)};
}

Statement AlphaZeroWorse(const ControlStudy& study) {
  std::vector<Contrast> cases;
  std::string text;
  for (const AlphaZero& row : kAlphaZero) {
    for (const FigureOf figure : {&ControlFigures::rms_sum_deg, &ControlFigures::worst_final_deg}) {
      cases = Joined(cases, Contrasts(study, row.loop, row.At(0.0, 0.1), row.At(3.0, 0.1),
                                      kTestedPayloads_kg, figure));
    }
    const auto of = [&](double alpha) {
      return PerPayload(kTestedPayloads_kg, [&](double kg) {
        const ControlFigures& f = FiguresOf(study, row.loop, row.At(alpha, kg));
        return FigureOrNever(f.rms_sum_deg, 2) + " (" + FigureOrNever(f.worst_final_deg, 2) + ")";
      });
    };
    text += (text.empty() ? "" : "; ") + row.Name(study) + ": " + of(0.0) + " against " + of(3.0);
  }
  return {"7.3", "with alpha = 0 the control errors are larger than with 3",
          "sum of the rms errors (final error), deg, alpha 0 against 3: " + text +
              AtPayloads(kTestedPayloads_kg) + BothSettings(study, "alpha 0 and 3"),
          WorseRule(cases)};
}

Statement Blend(const ControlStudy& study, const char* sign, const char* name) {
  std::string text = "rms of joint 1 at vartheta";
  for (const double vartheta : kVarthetas) {
    text += (vartheta == 0.0 ? " " : ", ") + Figure(vartheta, 2);
  }
  std::vector<std::array<OverSeeds, 3>> cases;
  for (const LoopKind loop : {LoopKind::kIdeal, LoopKind::kSensors}) {
    const auto rms1 = [&](double vartheta) {
      return FiguresOf(study, loop, VarthetaCase(vartheta, sign)).rms_deg[0];
    };
    const double best =
        *std::min_element(kVarthetas.begin(), kVarthetas.end(),
                          [&](double a, double b) { return rms1(a).median < rms1(b).median; });
    text += loop == LoopKind::kIdeal ? ": known state" : "; sensors";
    for (const double vartheta : kVarthetas) {
      text += (vartheta == 0.0 ? " " : ", ") + FigureOrNever(rms1(vartheta));
    }
    text += " deg, least at " + Figure(best, 2) + EndOfGrid(best, kVarthetas);
    cases.push_back({rms1(0.0), rms1(0.5), rms1(1.0)});
  }
  return {"7.3", std::string("vartheta = 0.5 is better than 0 and 1, (7.25) ") + name,
          text + ", at 0.1 kg" +
              BothSettings(study, "alpha " + Figure(study.config().controller.alpha, 2)),
          BetterInsideRule(cases)};
}

Statement Adaptation(const ControlStudy& study) {
  const Overrides off = {"controller.adaptation=false"};
  const auto rms = [&](const Overrides& law) {
    return PerPayload(kAllPayloads_kg, [&](double kg) {
      return FigureOrNever(study.Of(ChangedCase(law, kg)).rms_sum_deg);
    });
  };
  return {"7.3", "the adaptation copes with an unknown payload",
          "sum of the rms errors without adaptation " + rms(off) + ", with it " + rms({}) + " deg" +
              AtPayloads(kAllPayloads_kg) + SensorSettings(study),
          WorseRule(Contrasts(study, LoopKind::kSensors, ChangedCase(off, 0.1), kSquareCase(0.1),
                              kAllPayloads_kg, &ControlFigures::rms_sum_deg))};
}

}  // namespace

std::vector<Statement> LawStatements(const ControlStudy& study) {
  return {Modification(study),
          AlphaZeroUnstable(study),
          AlphaZeroWorse(study),
          Blend(study, "printed", "as printed"),
          Blend(study, "corrected", "with the sign that follows from its derivation"),
          Adaptation(study)};
}

}  // namespace flexarm
