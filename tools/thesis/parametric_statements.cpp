#include "tools/thesis/parametric_statements.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/analysis/sweep_figures.h"
#include "tools/thesis/verdict_rules.h"

namespace flexarm {
namespace {

struct Finding {
  Verdict verdict;
  std::string text;
};

// Relative change of a signal's largest magnitude over a sweep.
double PeakSpread(const ParametricSweep& sweep, Signal signal) {
  return SpreadInPercent(Values(sweep, signal));
}

std::string Percent(double value) { return Figure(value, 2) + " %"; }

std::string Ends(const std::vector<double>& v, const char* unit) {
  return Figure(v.front()) + " -> " + Figure(v.back()) + " " + unit;
}

Verdict Both(bool first, bool second) {
  if (first && second) return Verdict::kHolds;
  return first || second ? Verdict::kInPart : Verdict::kDoesNot;
}

// --- payload

Finding PayloadLowersFrequency(const ParametricStudy& s) {
  const ParametricSweep& sweep = s.At(kPayload);
  const auto free = FreeFrequenciesHz(sweep, 0), held = HeldFrequenciesHz(sweep);
  return {Both(Falls(free), Falls(held)), "lowest frequency with motors free " + Ends(free, "Hz") +
                                              ", held " + Ends(held, "Hz") + " over the payloads"};
}

Finding PayloadRaisesLink1(const ParametricStudy& s) {
  const auto w1 = Values(s.At(kPayload), kBending1);
  const bool rises = Rises(w1) && SpreadInPercent(w1) > 5.0;
  return {
      rises ? Verdict::kHolds : Verdict::kDoesNot,
      "largest bending of link 1 " + Ends(w1, "mm") + ", spread " + Percent(SpreadInPercent(w1))};
}

Finding PayloadExtremesOfLink2(const ParametricStudy& s) {
  const ParametricSweep& sweep = s.At(kPayload);
  const auto w2 = Values(sweep, kBending2);
  const double most = ParameterOfLargest(sweep, w2), least = ParameterOfLeast(sweep, w2);
  return {Both(std::abs(most - 0.8) < 0.11, std::abs(least - 0.3) < 0.11),
          "largest bending of link 2 is greatest at " + Figure(most, 1) + " kg, least at " +
              Figure(least, 1) + " kg"};
}

// Link 2 carries the payload: what it changes on link 1 is interaction.
Finding PayloadActsAcrossLinks(const ParametricStudy& s) {
  const ParametricSweep& sweep = s.At(kPayload);
  const double on1 = PeakSpread(sweep, kBending1), on2 = PeakSpread(sweep, kBending2);
  const auto held = HeldFrequenciesHz(sweep);
  const double slower = 100.0 * (1.0 - held.back() / held.front());
  return {Both(on1 > 0.1 * on2 && on1 > 5.0, slower > 10.0),
          "the payload, which link 2 carries, changes the largest bending of link 1 by " +
              Percent(on1) + ", of link 2 by " + Percent(on2) +
              ", and the lowest frequency with motors held, which is link 1's bending, by " +
              Percent(-slower)};
}

Finding PayloadActsOnJointsAlike(const ParametricStudy& s) {
  const ParametricSweep& sweep = s.At(kPayload);
  const double r1 = Correlation(Values(sweep, kTwist1), Values(sweep, kBending1));
  const double r2 = Correlation(Values(sweep, kTwist2), Values(sweep, kBending2));
  return {Both(r1 > 0.8, r2 > 0.8),
          "over the payloads, largest twist and largest bending are correlated by " +
              Figure(r1, 2) + " (joint and link 1) and " + Figure(r2, 2) + " (2)"};
}

// --- joint stiffness

Finding StiffnessReducesTwist(const ParametricStudy& s) {
  const double p1 = Exponent(s.At(kStiffness1), Values(s.At(kStiffness1), kTwist1));
  const double p2 = Exponent(s.At(kStiffness2), Values(s.At(kStiffness2), kTwist2));
  return {Both(p1 < -0.8, p2 < -0.8),
          "the largest twist is proportional to the stiffness to the power " + Figure(p1, 3) +
              " (joint 1) and " + Figure(p2, 3) + " (joint 2)"};
}

Finding StiffnessLowersFrequency(const ParametricStudy& s) {
  bool any_falls = false;
  std::string text = "over 16 times the stiffness, the two lowest frequencies with motors free:";
  for (const SweepPlace place : {kStiffness1, kStiffness2}) {
    const auto f1 = FreeFrequenciesHz(s.At(place), 0), f2 = FreeFrequenciesHz(s.At(place), 1);
    any_falls = any_falls || Falls(f1) || Falls(f2);
    text += std::string(place == kStiffness1 ? " joint 1 " : "; joint 2 ") + Ends(f1, "and ") +
            Ends(f2, "Hz");
  }
  return {any_falls ? Verdict::kInPart : Verdict::kDoesNot, text};
}

Finding StiffnessSparesLinks(const ParametricStudy& s) {
  std::array<double, 2> worst{};
  for (const std::size_t joint : {0U, 1U}) {
    const ParametricSweep& sweep = s.At(joint == 0 ? kStiffness1 : kStiffness2);
    worst[joint] = std::max(PeakSpread(sweep, kBending1), PeakSpread(sweep, kBending2));
  }
  return {Both(worst[0] < 10.0, worst[1] < 10.0),
          "over 16 times the stiffness, largest bending of either link changes by at most " +
              Percent(worst[0]) + " (joint 1) and " + Percent(worst[1]) + " (joint 2)"};
}

Finding JointsInteractLessThanLinks(const ParametricStudy& s) {
  const double joints =
      std::max(PeakSpread(s.At(kStiffness1), kTwist2), PeakSpread(s.At(kStiffness2), kTwist1));
  const double links =
      std::max({PeakSpread(s.At(kLength1), kBending2), PeakSpread(s.At(kLength2), kBending1),
                PeakSpread(s.At(kPayload), kBending1)});
  return {joints < links ? Verdict::kHolds : Verdict::kDoesNot,
          "a joint's stiffness changes the other's largest twist by at most " + Percent(joints) +
              "; a link's length or load the other link's largest bending by " + Percent(links)};
}

// --- friction

constexpr double kLeastFriction = 0.1;  // in units of the rig's friction; less is "close to zero"

// The thesis excludes friction near zero from its statements.
std::vector<double> BeyondNearZero(const ParametricSweep& sweep,
                                   const std::vector<double>& values) {
  return From(kLeastFriction, sweep, values);
}

Finding FrictionLowersBending(const ParametricStudy& s) {
  const ParametricSweep& sweep = s.At(kFriction);
  const auto w1 = BeyondNearZero(sweep, Values(sweep, kBending1));
  const auto w2 = BeyondNearZero(sweep, Values(sweep, kBending2));
  return {Both(Falls(w1), Falls(w2)), "largest bending from " + Figure(kLeastFriction, 2) +
                                          " to twice the rig's friction: link 1 " + Ends(w1, "mm") +
                                          ", link 2 " + Ends(w2, "mm")};
}

Finding FrictionRaisesFrequency(const ParametricStudy& s) {
  const ParametricSweep& sweep = s.At(kFriction);
  std::string without = "strongest line of the bending after the excitation, without friction:";
  std::string with = "; from " + Figure(kLeastFriction, 2) + " to twice the rig's friction:";
  std::array<bool, 2> raised{};
  for (const std::size_t link : {0U, 1U}) {
    const std::string name = (link > 0 ? ", link " : " link ") + std::to_string(link + 1) + ' ';
    const auto line =
        Values(sweep, link == 0 ? kBending1 : kBending2, &SignalMeasures::free_frequency_hz);
    const auto beyond = BeyondNearZero(sweep, line);
    raised[link] = beyond.back() > beyond.front() * (1.0 + kScatter);
    without += name + Figure(line.front()) + " Hz";
    with += name + Ends(beyond, "Hz");
  }
  return {Both(raised[0], raised[1]), without + with + ": sticking joints clamp the links"};
}

Finding FrictionIsNotLinear(const ParametricStudy& s) {
  const ParametricSweep& sweep = s.At(kFriction);
  const double b1 = BowInPercent(sweep, Values(sweep, kBending1)),
               b2 = BowInPercent(sweep, Values(sweep, kBending2));
  return {Both(b1 > 10.0, b2 > 10.0),
          "the decrease of the largest bending deviates from a straight line by " + Percent(b1) +
              " (link 1) and " + Percent(b2) + " (link 2) of the whole decrease"};
}

Finding FrictionSparesJoints(const ParametricStudy& s) {
  const ParametricSweep& sweep = s.At(kFriction);
  std::array<double, kSignals> drop{};
  for (const Signal i : {kBending1, kBending2, kTwist1, kTwist2}) {
    drop[i] = DropInPercent(Values(sweep, i));
  }
  return {Both(drop[kTwist1] < drop[kBending1], drop[kTwist2] < drop[kBending2]),
          "twice the rig's friction takes away " + Percent(drop[kBending1]) + " and " +
              Percent(drop[kBending2]) + " of the links' largest bending, " +
              Percent(drop[kTwist1]) + " and " + Percent(drop[kTwist2]) +
              " of the joints' largest twist"};
}

// --- backlash, as a dead zone with impacts or in the thesis's form

template <SweepPlace kPlace>
Finding BacklashDampsBestAtPointTwo(const ParametricStudy& s) {
  const ParametricSweep& sweep = s.At(kPlace);
  const auto w1 = LeftInPercent(sweep, kBending1), w2 = LeftInPercent(sweep, kBending2);
  const double best1 = ParameterOfLeast(sweep, w1), best2 = ParameterOfLeast(sweep, w2);
  const auto near = [](double deg) { return deg > 0.11 && deg < 0.31; };
  return {Both(near(best1), near(best2)),
          "bending after the excitation is least at " + Figure(best1, 2) + " deg for link 1 (" +
              Percent(*std::min_element(w1.begin(), w1.end())) +
              " of that without backlash) and at " + Figure(best2, 2) + " deg for link 2 (" +
              Percent(*std::min_element(w2.begin(), w2.end())) + ")"};
}

template <SweepPlace kPlace>
Finding BacklashIsConstantAboveTwo(const ParametricStudy& s) {
  const ParametricSweep& sweep = s.At(kPlace);
  const double c1 = SpreadInPercent(From(2.0, sweep, LeftInPercent(sweep, kBending1)));
  const double c2 = SpreadInPercent(From(2.0, sweep, LeftInPercent(sweep, kBending2)));
  return {Both(c1 < 5.0, c2 < 5.0),
          "from 2 deg on, bending after the excitation still changes by " + Percent(c1) +
              " (link 1) and " + Percent(c2) + " (link 2)"};
}

template <SweepPlace kPlace>
Finding BacklashActsOnSecondMore(const ParametricStudy& s) {
  const ParametricSweep& sweep = s.At(kPlace);
  const double w1 = SpreadInPercent(LeftInPercent(sweep, kBending1)),
               w2 = SpreadInPercent(LeftInPercent(sweep, kBending2));
  const auto t1 = Values(sweep, kTwist1), t2 = Values(sweep, kTwist2);
  return {Both(w2 > w1, SpreadInPercent(t2) > SpreadInPercent(t1)),
          "backlash changes the bending after the excitation by up to " + Percent(w1) +
              " (link 1) and " + Percent(w2) + " (link 2), the largest twist of joint 1 from " +
              Ends(t1, "mrad") + ", of joint 2, backlash included, from " + Ends(t2, "mrad")};
}

// --- lengths

Finding LongerIsLowerAndLarger(const ParametricStudy& s) {
  const auto w1 = Values(s.At(kLength1), kBending1), w2 = Values(s.At(kLength2), kBending2);
  const auto f1 = HeldFrequenciesHz(s.At(kLength1)), f2 = HeldFrequenciesHz(s.At(kLength2));
  return {Both(Falls(f1) && Falls(f2), Rises(w1) && Rises(w2)),
          "longest against shortest link 1: lowest frequency, motors held, " + Ends(f1, "Hz") +
              ", its largest bending " + Ends(w1, "mm") + "; link 2: " + Ends(f2, "Hz") + ", " +
              Ends(w2, "mm")};
}

Finding LeastAtPointSix(const ParametricStudy& s) {
  std::string text = "largest bending is least at";
  std::array<bool, 2> at_point_six{};
  for (const std::size_t link : {0U, 1U}) {
    const ParametricSweep& sweep = s.At(link == 0 ? kLength1 : kLength2);
    const double least = ParameterOfLeast(sweep, Values(sweep, link == 0 ? kBending1 : kBending2));
    at_point_six[link] = std::abs(least - 0.6) < 0.06;
    text += (link > 0 ? " and " : " ") + Figure(least, 2) + " m (link " + std::to_string(link + 1) +
            (least == sweep.point.front().value ? ", the shortest tried)" : ")");
  }
  return {Both(at_point_six[0], at_point_six[1]), text};
}

Finding LengthSparesJoints(const ParametricStudy& s) {
  std::array<double, 2> most{};
  for (const std::size_t link : {0U, 1U}) {
    const ParametricSweep& sweep = s.At(link == 0 ? kLength1 : kLength2);
    most[link] = std::max(PeakSpread(sweep, kTwist1), PeakSpread(sweep, kTwist2));
  }
  return {Both(most[0] < 10.0, most[1] < 10.0),
          "largest twist of a joint changes by up to " + Percent(most[0]) +
              " over the lengths of link 1 and " + Percent(most[1]) + " over those of link 2"};
}

Finding LongerLink1CalmsLink2(const ParametricStudy& s) {
  const auto w2 = Values(s.At(kLength1), kBending2);
  return {Falls(w2) ? Verdict::kHolds : Verdict::kDoesNot,
          "largest bending of link 2 over the lengths of link 1: " + Ends(w2, "mm") +
              (Falls(w2) ? ", decreasing over the whole range"
                         : ", not decreasing over the whole range")};
}

Finding LongerLink2LowersLink1(const ParametricStudy& s) {
  const auto held = HeldFrequenciesHz(s.At(kLength2));
  return {Falls(held) ? Verdict::kHolds : Verdict::kDoesNot,
          "lowest frequency with motors held, which is link 1's bending: " + Ends(held, "Hz")};
}

// --- interactions

Finding JointsAreIndependent(const ParametricStudy& s) {
  const double on2 = PeakSpread(s.At(kStiffness1), kTwist2),
               on1 = PeakSpread(s.At(kStiffness2), kTwist1);
  return {Both(on1 < 5.0, on2 < 5.0),
          "the other joint's stiffness changes the largest twist of joint 1 by " + Percent(on1) +
              ", of joint 2 by " + Percent(on2)};
}

Finding OwnParametersMatterMore(const ParametricStudy& s) {
  const double own1 = PeakSpread(s.At(kLength1), kBending1),
               own2 = PeakSpread(s.At(kLength2), kBending2);
  const double other1 = PeakSpread(s.At(kLength2), kBending1),
               other2 = PeakSpread(s.At(kLength1), kBending2);
  return {OwnMoreRule({own1, own2}, {other1, other2}),
          "largest bending of link 1 changes by " + Percent(own1) + " with its own length, by " +
              Percent(other1) + " with link 2's; that of link 2 by " + Percent(own2) +
              " with its own, by " + Percent(other2) + " with link 1's"};
}

Finding LinkAndItsJointAreCoupled(const ParametricStudy& s) {
  const double c1 = PeakSpread(s.At(kLength1), kTwist1), c2 = PeakSpread(s.At(kLength2), kTwist2);
  return {Both(c1 > 10.0, c2 > 10.0), "a link's length changes its own joint's largest twist by " +
                                          Percent(c1) + " (1) and " + Percent(c2) + " (2)"};
}

// By its stiffness k and backlash b; the friction is swept in both joints.
Finding Joint2ActsOnLink2More(const ParametricStudy& s) {
  const auto of = [](const ParametricSweep& sweep) -> std::array<double, 2> {
    return {PeakSpread(sweep, kBending1), PeakSpread(sweep, kBending2)};
  };
  const auto k = of(s.At(kStiffness2)), b = of(s.At(kBacklash));
  const std::array<double, 2> own = {of(s.At(kLength1))[0], of(s.At(kLength2))[1]};
  return {ActsOnBothRule({std::max(k[0], b[0]), std::max(k[1], b[1])}, own),
          "joint 2's stiffness changes the largest bending of link 1 by " + Percent(k[0]) +
              ", of link 2 by " + Percent(k[1]) + "; its backlash (dead zone) by " + Percent(b[0]) +
              " and " + Percent(b[1]) + "; the link's own length by " + Percent(own[0]) + " and " +
              Percent(own[1])};
}

struct Question {
  const char* section;
  const char* thesis;
  Finding (*answer)(const ParametricStudy&);
};

constexpr std::array<Question, 28> kQuestions = {{
    {"5.2", "more payload lowers the links' natural frequencies", PayloadLowersFrequency},
    {"5.2", "link 1 vibrates the more the larger the payload", PayloadRaisesLink1},
    {"5.2", "link 2 vibrates most near 0.8 kg and least near 0.3 kg", PayloadExtremesOfLink2},
    {"5.2", "the payload acts on each joint as on its link", PayloadActsOnJointsAlike},
    {"5.2", "with the payload, the interaction of the two links is quite significant",
     PayloadActsAcrossLinks},
    {"5.2", "a stiffer joint oscillates dramatically less", StiffnessReducesTwist},
    {"5.2", "a stiffer joint lowers the frequencies", StiffnessLowersFrequency},
    {"5.2", "joint stiffness hardly matters to the links, for both joints", StiffnessSparesLinks},
    {"5.2", "the joints interact less than the links", JointsInteractLessThanLinks},
    {"5.2", "more friction lowers the bending of both links", FrictionLowersBending},
    {"5.2", "more friction raises the vibration frequencies of both links",
     FrictionRaisesFrequency},
    {"5.2", "the effect of friction is not linear", FrictionIsNotLinear},
    {"5.2", "friction damps the joints less than the links", FrictionSparesJoints},
    {"5.2", "backlash damps most at 0.2 deg (here: a dead zone with impacts)",
     BacklashDampsBestAtPointTwo<kBacklash>},
    {"5.2", "the same, with the thesis's own form of backlash (3.11)",
     BacklashDampsBestAtPointTwo<kThesisBacklash>},
    {"5.2", "above 2 deg of backlash the damping is nearly constant (dead zone)",
     BacklashIsConstantAboveTwo<kBacklash>},
    {"5.2", "the same, with the thesis's form", BacklashIsConstantAboveTwo<kThesisBacklash>},
    {"5.2", "backlash acts much more on link and joint 2 than on 1 (dead zone)",
     BacklashActsOnSecondMore<kBacklash>},
    {"5.2", "the same, with the thesis's form", BacklashActsOnSecondMore<kThesisBacklash>},
    {"5.2", "a longer link has lower frequencies and vibrates more", LongerIsLowerAndLarger},
    {"5.2", "the least vibration is at a length of 0.6 m", LeastAtPointSix},
    {"5.2", "a link's length hardly matters to either joint", LengthSparesJoints},
    {"5.2", "a longer link 1 slightly calms link 2", LongerLink1CalmsLink2},
    {"5.2", "a longer link 2 lowers the frequency of link 1", LongerLink2LowersLink1},
    {"5.3", "a joint is almost independent of the other joint's parameters", JointsAreIndependent},
    {"5.3", "a link depends on the other's parameters, but more on its own",
     OwnParametersMatterMore},
    {"5.3", "a link and its driving joint are strongly coupled", LinkAndItsJointAreCoupled},
    {"5.3", "joint 2's parameters affect both links, link 2 more", Joint2ActsOnLink2More},
}};

}  // namespace

std::vector<Statement> ParametricStatements(const ParametricStudy& weak,
                                            const ParametricStudy& strong) {
  std::vector<Statement> statements;
  for (const Question& question : kQuestions) {
    const Finding with_weak = question.answer(weak), with_strong = question.answer(strong);
    Statement out{question.section, question.thesis, with_weak.text, with_weak.verdict};
    if (with_weak.verdict != with_strong.verdict) {
      const double times = strong.excitation.torque_nm[0] / weak.excitation.torque_nm[0];
      out.model += ". With " + Figure(times, 1) + " times the torque: " + with_strong.text;
      out.verdict = Verdict::kDepends;
    }
    statements.push_back(std::move(out));
  }
  return statements;
}

Statement MotorLag(const RigConfig& config, const ParametricStudy& study) {
  constexpr double kLag_ms = 10.0;  // as long as the loop can bear
  Excitation lagged = study.excitation;
  lagged.motor_lag_ms = {kLag_ms, kLag_ms};
  const ParametricStudy with = RunParametricStudy(config, lagged);
  const ParametricPoint &before = study.At(kPayload).point[1], &after = with.At(kPayload).point[1];
  std::ptrdiff_t changed = 0;
  for (const Question& question : kQuestions) {
    if (question.answer(study).verdict != question.answer(with).verdict) ++changed;
  }
  const auto peak = [](const ParametricPoint& point, Signal signal) {
    return point.signal[signal].peak;
  };
  const auto percent = [&](Signal signal) {
    return Percent(100.0 * (peak(after, signal) / peak(before, signal) - 1.0));
  };
  return {"3.7", "the simulations have the motors' lag (3.24), whose time constants are not stated",
          "with a lag of " + Figure(kLag_ms, 2) + " instead of " +
              Figure(study.excitation.motor_lag_ms[0], 2) + " ms, largest bending at " +
              Figure(before.value, 2) + " kg changes by " + percent(kBending1) + " (link 1) and " +
              percent(kBending2) + " (link 2), and " + Count(changed) + " of " +
              Count(static_cast<std::ptrdiff_t>(kQuestions.size())) +
              " verdicts of chapter 5, each at this torque alone, become others",
          Verdict::kNotTested};
}

}  // namespace flexarm
