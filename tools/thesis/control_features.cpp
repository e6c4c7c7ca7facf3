#include "tools/thesis/control_features.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>

#include "controller/design/design_controller.h"
#include "controller/design/model_following.h"
#include "model/arm/arm_model.h"
#include "model/arm/linearization.h"
#include "model/math/invariant_zeros.h"
#include "model/units.h"
#include "tools/analysis/arm_zeros.h"
#include "tools/analysis/torsion_report.h"
#include "tools/thesis/rig_needs.h"

namespace flexarm {
namespace {

constexpr int kFeatureModes = 4;                  // of the plant of 7.4
constexpr double kElbow_deg = 45.0;               // where the tip moves in two directions
constexpr double kFrictionGain_s_per_rad = 50.0;  // of 6.2's tanh; its size does not matter here

struct LinearArm {
  LinearArm(const ArmParameters& arm, double theta2_rad, double friction_gain)
      : model(arm, {kFeatureModes, kFeatureModes}), q(Eigen::VectorXd::Zero(model.dof())) {
    q[kTheta2] = q[kTheta4] = theta2_rad;
    linear = Linearize(model, q, Eigen::VectorXd::Zero(model.dof()), Eigen::Vector2d::Zero(),
                       friction_gain);
  }

  OutputZeros Zeros(const std::string& outputs) const {
    for (OutputZeros& all : ArmZeros(model, linear, q)) {
      if (all.name == outputs) return std::move(all);
    }
    throw std::out_of_range(outputs);
  }

  ArmModel model;
  Eigen::VectorXd q;
  LinearModel linear;
};

// "3 of 18, the nearest to 0 at 282 1/s"
std::string RightHalf(const OutputZeros& outputs) {
  std::string text =
      std::to_string(outputs.unstable()) + " of " + std::to_string(outputs.zeros.size());
  for (const std::complex<double>& zero : outputs.zeros) {
    if (zero.real() <= 0.0) continue;
    return text + ", the nearest to 0 at " + Figure(std::abs(zero)) + " rad/s";
  }
  return text;
}

// The largest |z| of the zeros from the torques to the law's output K x.
double LargestSampledZero(const Design& design) {
  return InvariantZeros(design.A, design.B, design.K).cwiseAbs().maxCoeff();
}

Statement NonMinimumPhase(const RigConfig& config, const Design& design) {
  const LinearArm straight(config.arm, 0.0, 0.0), bent(config.arm, kElbow_deg * kRadPerDeg, 0.0);
  const OutputZeros ends = straight.Zeros("link_ends"), tip = bent.Zeros("tip"),
                    hubs = straight.Zeros("hubs"), rotors = straight.Zeros("rotors");
  return {"7.2",
          "with the torques at the joints and the output at the end point the arm is non-minimum "
          "phase",
          "zeros in the right half plane, " + std::to_string(kFeatureModes) +
              " modes a link: to the directions of the links' ends " + RightHalf(ends) +
              "; to the tip at " + Figure(kElbow_deg, 2) + " deg " + RightHalf(tip) +
              "; to the hubs' angles " + RightHalf(hubs) + ", to the rotors' " + RightHalf(rotors) +
              ". Sampled, the way to the law's output K x has zeros up to abs z = " +
              Figure(LargestSampledZero(design), 2),
          ends.unstable() > 0 && tip.unstable() > 0 ? Verdict::kHolds : Verdict::kDoesNot};
}

std::string IntegratorText(const Integrators& integrators) {
  return std::to_string(integrators.poles) + " poles at the origin, in " +
         std::to_string(integrators.chains) + " chains";
}

Statement PolesAtOrigin(const RigConfig& config) {
  const Integrators without = CountIntegrators(LinearArm(config.arm, 0.0, 0.0).linear.A);
  const Integrators with =
      CountIntegrators(LinearArm(config.arm, 0.0, kFrictionGain_s_per_rad).linear.A);
  const auto one_a_joint = [](const Integrators& i) { return i.poles == 2 && i.chains == 2; };
  return {"7.2",
          "motors in torque mode put one pole of a joint at the origin, so the arm is always "
          "marginally stable",
          "linearised without friction " + IntegratorText(without) +
              (without.poles > without.chains ? ": two a joint, and a rate once given stays" : "") +
              "; with the friction smoothed as in 6.2 " + IntegratorText(with),
          one_a_joint(without) ? Verdict::kHolds
          : one_a_joint(with)  ? Verdict::kInPart
                               : Verdict::kDoesNot};
}

std::string RankText(const ModelFollowing& ranks) {
  return std::to_string(ranks.continuous.input) + " and " +
         std::to_string(ranks.continuous.difference) + " (sampled " +
         std::to_string(ranks.discrete.input) + " and " +
         std::to_string(ranks.discrete.difference) + ")";
}

bool Follows(const ModelFollowing& ranks) {
  return ranks.continuous.follows() && ranks.discrete.follows();
}

Statement NotFollowing(const RigConfig& config) {
  std::string text = "rank B and rank [B, A - A_m], without friction and backlash:";
  bool none = true;
  for (const NamedLayout& model : kNominalModels) {
    const ModelFollowing ranks = TestModelFollowing(config, model.layout);
    text += (text.back() == ':' ? " " : ", ") + std::string(model.name) + " " + RankText(ranks);
    none = none && !Follows(ranks);
  }
  return {"7.2", "the arm does not satisfy the condition for perfect model following (7.3)", text,
          none ? Verdict::kHolds : Verdict::kDoesNot};
}

Statement CauseOfNotFollowing(const RigConfig& config) {
  const auto ranks = [&](const StateLayout& layout, bool friction, bool same_damping) {
    return TestModelFollowing(config, layout,
                              {.friction_gain_s_per_rad = friction ? kFrictionGain_s_per_rad : 0.0,
                               .in_clearance = friction,
                               .damping_of_reference = same_damping});
  };
  const ModelFollowing neither = ranks(kR12, false, false), both = ranks(kR12, true, false),
                       alone = ranks(kR12, true, true);
  return {"7.3",
          "that (7.3) is not satisfied is primarily caused by dry friction and backlash (7.3.3)",
          "R12 without them: ranks " + RankText(neither) + ", with them " + RankText(both) +
              ": the links' damping differs from the reference's. With the links damped as the "
              "reference: without them " +
              RankText(ranks(kR12, false, true)) + ", with them " + RankText(alone) +
              ", since friction acts where the torques act; with elastic joints (T12) " +
              RankText(ranks(kT12, true, true)),
          Follows(neither) && !Follows(both) ? Verdict::kHolds : Verdict::kDoesNot};
}

// Multiplications of one sample: filter, prediction, and the law with its log of (7.12).
Eigen::Index ProductsOfASample(const Design& design) {
  const Eigen::Index regressor = design.A.rows() + 4;
  return design.filter_A.size() + design.filter_B.size() + design.filter_C.size() +
         design.filter_L.size() + design.A.size() + design.B.size() + 2 * design.K.size() +
         design.S11.size() + design.S12.size() + design.P.size() + 5 * regressor;
}

// 7.4: "more computation".
Statement CostOfOrder16(const RigConfig& config) {
  const char* said = "a nominal model of order 16 takes more computation than one of order 12";
  if (const std::string lacks = LacksTwoModes(config); !lacks.empty()) {
    return NotForThisRig("7.4", said, lacks);
  }
  const auto of = [&](const char* model) {
    return DesignController(WithOverrides(config, {std::string("controller.nominal=") + model}));
  };
  const Design twelve = of("T12"), sixteen = of("T16");
  const Eigen::Index few = ProductsOfASample(twelve), many = ProductsOfASample(sixteen);
  const Eigen::Index unknowns12 = twelve.A.size(), unknowns16 = sixteen.A.size();
  const double design =
      std::pow(static_cast<double>(unknowns16) / static_cast<double>(unknowns12), 3);
  return {"7.4", said,
          "by the sizes of their matrices, a sample of filter, prediction and law takes " +
              Count(many) + " multiplications with T16, " + Count(few) +
              " with T12: " + Figure(static_cast<double>(many) / static_cast<double>(few)) +
              " times as many, and the rest of a sample does not depend on it; the equation for "
              "S11 has " +
              Count(unknowns16) + " unknowns instead of " + Count(unknowns12) +
              ", written as one linear system " + Figure(design, 2) + " times the work, off line",
          many > few ? Verdict::kHolds : Verdict::kDoesNot};
}

// 7.5, where it led to the support of figure 7.13.
Statement MajorUnmodelled(const ArmParameters& arm) {
  const char* said = "torsion of the links is the major unmodelled motion (figure 7.13)";
  if (const std::string lacks = LacksRectangles(arm); !lacks.empty()) {
    return NotForThisRig("7.5", said, lacks);
  }
  const TorsionEffect effect = TorsionOf(arm);
  const double lowest_hz = FreeMotorFrequenciesHz(ArmModel(arm, {4, 4}), 0.0)[0];
  return {"7.5", said,
          "link 1 twists at " + Figure(effect.carried_hz) + " Hz with the elbow at " +
              Figure(effect.of.theta2_deg, 2) + " deg, below the lowest bending of the arm, " +
              Figure(lowest_hz) + " Hz. A payload " + Figure(effect.of.payload_offset_mm, 2) +
              " mm beside its axis changes link 2 little: " + Figure(effect.coupled_hz[0], 5) +
              " instead of " + Figure(effect.bending_hz[0], 5) + " Hz, and " +
              Figure(effect.twist_deg_per_mm, 2) + " deg of twist for a mm of deflection",
          effect.carried_hz < lowest_hz ? Verdict::kHolds : Verdict::kDoesNot};
}

}  // namespace

std::vector<Statement> ControlFeatureStatements(const RigConfig& config) {
  return {NonMinimumPhase(config, DesignController(config)),
          PolesAtOrigin(config),
          NotFollowing(config),
          CauseOfNotFollowing(config),
          CostOfOrder16(config),
          MajorUnmodelled(config.arm)};
}

}  // namespace flexarm
