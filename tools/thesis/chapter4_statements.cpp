#include <algorithm>
#include <array>
#include <cmath>

#include "model/arm/linearization.h"
#include "model/simulation/arm_simulator.h"
#include "tools/analysis/torsion_report.h"
#include "tools/thesis/thesis_check.h"

namespace flexarm {
namespace {

// Lateral compliance at the tip of a link, m/N: from its bending, for a uniform or stepped beam,
// and from its joint's spring.
struct Compliance {
  double link, joint;
};

Compliance EndCompliance(const ArmParameters& arm, std::size_t i) {
  const LinkParameters& link = arm.link[i];
  const double L = link.length_m();
  // int (L - u)^2 / EI du
  const double bending = IntegrateAlong(link.section, L, [&](double u, const BeamSection& s) {
    return (L - u) * (L - u) / s.bending_stiffness_nm2();
  });
  return {bending, L * L / arm.joint[i].stiffness_nm_per_rad};
}

Statement SameEffect(const ArmParameters& arm) {
  const Compliance first = EndCompliance(arm, 0), second = EndCompliance(arm, 1);
  const double ratio1 = first.link / first.joint, ratio2 = second.link / second.joint;
  const auto same = [](double ratio) { return ratio > 0.5 && ratio < 2.0; };
  return {"4.2.1", "links and joints are about equally flexible, felt at the endpoint",
          "under a force at its end, link 1 bends " + Figure(ratio1) +
              " times as far as its joint turns it, link 2 " + Figure(ratio2) + " times",
          same(ratio1) && same(ratio2) ? Verdict::kHolds : Verdict::kDoesNot};
}

// Both links longer or thicker by a factor.
ArmParameters Reshaped(ArmParameters arm, double length, double thickness) {
  for (LinkParameters& link : arm.link) {
    for (BeamSection& s : link.section) {
      s.length_m *= length;
      s.area_m2 *= thickness;
      s.second_moment_m4 *= thickness * thickness * thickness;
      s.half_thickness_m *= thickness;
    }
  }
  return arm;
}

Statement LongerOrThinner(const ArmParameters& arm) {
  const auto held = [](const ArmParameters& p) {
    return Eigen::VectorXd(HeldMotorFrequenciesHz(ArmModel(p, {4, 4}), 0.0).head(2));
  };
  const Eigen::VectorXd nominal = held(arm);
  bool all = true;
  const auto lowered = [&](double length, double thickness) {
    const Eigen::VectorXd percent =
        100.0 * (1.0 - held(Reshaped(arm, length, thickness)).array() / nominal.array());
    all = all && percent.minCoeff() > 0.0;
    return Figure(percent[0], 2) + " and " + Figure(percent[1], 2) + " %";
  };
  std::string text =
      "with the motors held, links a tenth longer lower the two lowest frequencies by ";
  text += lowered(1.1, 1.0) + ", links a tenth thinner by " + lowered(1.0, 0.9);
  return {"4.2.1", "longer or thinner links have lower natural frequencies", text,
          all ? Verdict::kHolds : Verdict::kDoesNot};
}

Statement Thickness(const ArmParameters& arm) {
  const char* said = "link 2 is 30 mm wide and 3.0 mm thick";
  const BeamSection& s = arm.link[1].section.front();
  const double thickness_mm = 1e3 * std::sqrt(12.0 * s.second_moment_m4 / s.area_m2);
  const double width_mm = 1e6 * s.area_m2 / thickness_mm;
  return {"4.2.1", said,
          "its area and second moment (Table 2) belong to " + Figure(width_mm) + " mm by " +
              Figure(thickness_mm, 4) + " mm",
          std::abs(thickness_mm - 3.0) < 0.01 ? Verdict::kHolds : Verdict::kDoesNot};
}

// 4.2.1 gives link 1 0.9 m and link 2 0.8 m, Table 2 the other way round.
Statement Lengths(const ArmParameters& arm) {
  const char* said = "link 1 is 0.9 m long and link 2 0.8 m";
  constexpr std::array<double, 2> kText_m = {0.9, 0.8};
  ArmParameters exchanged = arm;
  std::string text = "Table 2 has";
  bool same = true;
  for (std::size_t i = 0; i < 2; ++i) {
    const double length_m = arm.link[i].length_m();
    text += (i > 0 ? " and " : " ") + Figure(length_m, 2);
    same = same && std::abs(length_m - kText_m[i]) < 1e-6;
    for (BeamSection& s : exchanged.link[i].section) s.length_m *= kText_m[i] / length_m;
  }
  const ArmModel table(arm, {4, 4}), words(exchanged, {4, 4});
  const Eigen::VectorXd free = FreeMotorFrequenciesHz(table, 0.0),
                        free_words = FreeMotorFrequenciesHz(words, 0.0);
  const Eigen::VectorXd held = HeldMotorFrequenciesHz(table, 0.0),
                        held_words = HeldMotorFrequenciesHz(words, 0.0);
  text += " m, the lengths of this rig. With those of 4.2.1 its two lowest frequencies would be " +
          Figure(free_words[0]) + " and " + Figure(free_words[1]) + " instead of " +
          Figure(free[0]) + " and " + Figure(free[1]) + " Hz, with the motors held " +
          Figure(held_words[0]) + " and " + Figure(held_words[1]) + " instead of " +
          Figure(held[0]) + " and " + Figure(held[1]) + " Hz";
  return {"4.2.1", said, text, same ? Verdict::kHolds : Verdict::kDoesNot};
}

// Radii of gyration of the rigid parts: a hub around a link cannot be smaller than the thickness of
// the link.
Statement HubInertias(const ArmParameters& arm) {
  const char* said =
      "the hubs' and the payload's moments of inertia are about 1e-7 kg m2 (Table 2)";
  constexpr double kTimes = 1000.0;
  const double hub_mm = 1e3 * std::sqrt(arm.joint[1].hub_inertia_kgm2 / arm.hub2_mass_kg);
  const double payload_mm = 1e3 * std::sqrt(arm.payload_inertia_kgm2 / arm.payload_mass_kg);
  const double thick_mm = 2e3 * arm.link[1].section.front().half_thickness_m;
  ArmParameters larger = arm;
  for (JointParameters& joint : larger.joint) joint.hub_inertia_kgm2 *= kTimes;
  larger.payload_inertia_kgm2 *= kTimes;
  const Eigen::VectorXd as_given = FreeMotorFrequenciesHz(ArmModel(arm, {4, 4}), 0.0);
  const Eigen::VectorXd with_larger = FreeMotorFrequenciesHz(ArmModel(larger, {4, 4}), 0.0);
  const double moved =
      (with_larger.head(4).array() / as_given.head(4).array() - 1.0).abs().maxCoeff();
  return {"4.3", said,
          "with their masses that is a radius of gyration of " + Figure(hub_mm, 2) +
              " mm for hub 2 and " + Figure(payload_mm, 2) + " mm for the payload, on a link " +
              Figure(thick_mm) + " mm thick; " + Figure(kTimes, 4) +
              " times as much changes none of the arm's four lowest frequencies by more than " +
              Figure(100.0 * moved, 2) + " %",
          hub_mm > thick_mm && payload_mm > thick_mm ? Verdict::kHolds : Verdict::kDoesNot};
}

ArmParameters TenfoldMaterial(ArmParameters arm) {
  for (LinkParameters& link : arm.link) {
    for (BeamSection& s : link.section) {
      s.youngs_modulus_pa *= 10.0;
      s.density_kg_m3 *= 10.0;
    }
  }
  return arm;
}

Statement Table2(const ArmParameters& arm) {
  const char* said = "Young's modulus is 6.89e11 Pa and the density 2.707e4 kg/m3 (Table 2)";
  const ArmParameters tenfold = TenfoldMaterial(arm);
  const Eigen::VectorXd right = FreeMotorFrequenciesHz(ArmModel(arm, {4, 4}), 0.0);
  const Eigen::VectorXd wrong = FreeMotorFrequenciesHz(ArmModel(tenfold, {4, 4}), 0.0);
  std::string text =
      "ten times this rig's figures do not change the frequencies of the bare links, but change "
      "the arm's lowest from";
  double worst = 0.0;
  for (Eigen::Index i = 0; i < 3; ++i) {
    text += (i > 0 ? ", " : " ") + Figure(right[i]) + " to " + Figure(wrong[i]);
    worst = std::max(worst, std::abs(wrong[i] / right[i] - 1.0));
  }
  text += " Hz; link masses " + Figure(arm.link[0].mass_kg()) + " and " +
          Figure(arm.link[1].mass_kg()) + " kg would be " + Figure(tenfold.link[0].mass_kg()) +
          " and " + Figure(tenfold.link[1].mass_kg()) + " kg";
  return {"4.3", said, text, worst < 0.01 ? Verdict::kHolds : Verdict::kDoesNot};
}

// How the arm carries what lies beside the axis of link 1, as long as nothing supports it.
std::string TorsionText(const TorsionEffect& effect) {
  return "elbow at " + Figure(effect.of.theta2_deg, 2) + " deg: link 2 and payload weigh " +
         Figure(effect.weight_nm) + " N m about the axis of link 1, whose stiffness is " +
         Figure(effect.link[0].stiffness_nm_per_rad) + " N m/rad with a Poisson's ratio of " +
         Figure(effect.of.poisson, 2) + ": it twists by " + Figure(effect.twist_deg, 2) +
         " deg, and the tip drops by " + Figure(effect.drop_by_twist_mm, 2) +
         " mm; by bending on edge the elbow drops by " + Figure(effect.drop_by_bending_mm, 2) +
         " mm";
}

// Sections of the links, 4.2.1.
Statement StiffInTorsion(const ArmParameters& arm) {
  constexpr double kSmall_mm = 5.0;
  const char* said =
      "the links' sections are stiff enough for weight and twist to be small and negligible";
  if (const std::string lacks = LacksRectangles(arm); !lacks.empty()) {
    return NotForThisRig("4.2.1", said, lacks);
  }
  const TorsionEffect effect = TorsionOf(arm);
  return {"4.2.1", said, TorsionText(effect),
          effect.drop_by_twist_mm < kSmall_mm && effect.drop_by_bending_mm < kSmall_mm
              ? Verdict::kHolds
          : effect.drop_by_bending_mm < kSmall_mm ? Verdict::kInPart
                                                  : Verdict::kDoesNot};
}

struct Chapter4Run {
  Eigen::Vector2d tip_m;
  double bending1_mm = 0.0, bending2_mm = 0.0;  // largest
};

constexpr std::array<double, 2> kTorque_nm = {0.4, 0.1};  // assumed: the thesis states none
constexpr int kTipAfter_s = 3;

// One period of a square wave of 1 s from rest, then free.
Chapter4Run RunChapter4(const ArmParameters& arm, int modes) {
  const ArmModel model(arm, {modes, modes});
  ArmSimulator simulator(model, {.passes = 4, .substeps = 10});
  ArmState x(model.dof());
  Chapter4Run run;
  const ArmConstants& c = model.constants();
  constexpr double kStep_s = 1e-3;
  for (int k = 0; k < 1000 * kTipAfter_s; ++k) {
    const double sign = k < 500 ? 1.0 : k < 1000 ? -1.0 : 0.0;
    simulator.Step(x, {sign * kTorque_nm[0], sign * kTorque_nm[1]}, kStep_s);
    run.bending1_mm =
        std::max(run.bending1_mm, 1e3 * std::abs(c.link1.psi_tip.dot(x.q.segment(kPhi1, c.m1))));
    run.bending2_mm =
        std::max(run.bending2_mm, 1e3 * std::abs(c.link2.psi_tip.dot(x.q.tail(c.m2))));
  }
  run.tip_m = model.TipPosition(x.q);
  return run;
}

Statement Agreement(ArmParameters arm) {
  const Chapter4Run damped = RunChapter4(arm, 4);
  arm.damping = DampingReading::kNone;
  for (JointParameters& joint : arm.joint) joint.coulomb_friction_nm = 0.0;
  const Chapter4Run two = RunChapter4(arm, 2), four = RunChapter4(arm, 4);
  return {"4.3", "simulation and experiment agree well (figures 4.4 and 4.5)",
          "the amplitude of the square wave is not stated. With " + Figure(kTorque_nm[0], 1) +
              " and " + Figure(kTorque_nm[1], 1) + " N m the links bend by up to " +
              Figure(damped.bending1_mm) + " and " + Figure(damped.bending2_mm) +
              " mm, without dissipation " + Figure(four.bending1_mm) + " and " +
              Figure(four.bending2_mm) + " mm; two and four modes a link then put the tip " +
              Figure(1e3 * (two.tip_m - four.tip_m).norm(), 2) + " mm apart after " +
              std::to_string(kTipAfter_s) + " s",
          Verdict::kNotTested};
}

}  // namespace

std::vector<Statement> Chapter4Statements(const RigConfig& config) {
  return {SameEffect(config.arm),  LongerOrThinner(config.arm), Lengths(config.arm),
          Thickness(config.arm),   StiffInTorsion(config.arm),  Table2(config.arm),
          HubInertias(config.arm), Agreement(config.arm)};
}

}  // namespace flexarm
