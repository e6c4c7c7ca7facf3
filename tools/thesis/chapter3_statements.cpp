#include <algorithm>
#include <cmath>

#include "model/arm/backlash.h"
#include "model/arm/linearization.h"
#include "model/beam_methods/friction_root.h"
#include "model/math/dense_decompositions.h"
#include "model/reduction/arm_reduction.h"
#include "model/units.h"
#include "tools/thesis/thesis_check.h"

namespace flexarm {
namespace {

constexpr double kThesisRate_rad_s = 4.0;  // 6.5.2: the largest rate of joint 1

Statement FrictionSwitch(const ArmParameters& arm) {
  const double friction = arm.joint[0].coulomb_friction_nm;
  const auto at = [&](double amplitude_m) {
    return FrictionRootMode(arm.link[0].section, Link1Tip(arm), 1, amplitude_m, friction);
  };
  std::string text = "link 1, mode 1, friction " + Figure(friction, 2) + " N m:";
  std::array<double, 2> hz{};
  for (const std::size_t i : {0U, 1U}) {
    const double amplitude_m = i == 0 ? 1e-3 : 5e-3;
    const FrictionRoot root = at(amplitude_m);
    hz[i] = root.frequency_rad_s / kTwoPi;
    text += std::string(i > 0 ? "; at " : " at ") + Figure(1e3 * amplitude_m, 1) +
            " mm of tip deflection the clamped moment is " + Figure(root.clamped_moment_nm) +
            " N m, so the joint " + (root.sticks ? "sticks" : "slips") + ", " + Figure(hz[i]) +
            " Hz";
  }
  const bool same = std::abs(hz[0] - hz[1]) < 0.01 * hz[0];
  return {"3.2",
          "friction and the clamped moment decide the link's frequency, without an amplitude", text,
          same ? Verdict::kHolds : Verdict::kDoesNot};
}

// Damping ratio of mode k of a clamped link: D / (2 m omega) with m = G / omega^2.
double ModalDampingRatio(const LinkModes& link, int k) {
  return link.D(k, k) * link.mode[static_cast<std::size_t>(k)].frequency_rad_s() /
         (2.0 * link.G(k, k));
}

Statement DampingRatios(ArmParameters arm) {
  arm.damping = DampingReading::kCurvatureRho;
  const ArmModel mended(arm, {2, 2});
  arm.damping = DampingReading::kCurvatureAsPrinted;
  const ArmModel printed(arm, {2, 2});
  bool all = true;
  std::string text =
      "with the density that its units need, the damping ratios of modes 1 and 2 are:";
  for (const int link : {1, 2}) {
    const double xi = arm.link[static_cast<std::size_t>(link - 1)].damping_ratio;
    text += std::string(link > 1 ? "; " : " ") + "link " + std::to_string(link) +
            " (xi = " + Figure(xi, 2) + "): ";
    for (const int k : {0, 1}) {
      const double zeta = ModalDampingRatio(mended.link_modes(link), k);
      text += (k > 0 ? " and " : "") + Figure(zeta, 3);
      all = all && std::abs(zeta - xi) < 0.2 * xi;
    }
  }
  const double times = mended.link_modes(1).D(0, 0) / printed.link_modes(1).D(0, 0);
  text += ". As printed the damping is " + Figure(times, 3) + " times smaller";
  return {"3.3", "xi_1 and xi_2 are the damping ratios of the arms (3.8)", text,
          all ? Verdict::kHolds : Verdict::kDoesNot};
}

// The dissipation (3.11) with a clearance, at a given zeta v.
class ThesisBacklash {
 public:
  ThesisBacklash(ArmParameters arm, double clearance_deg) {
    arm.joint2_backlash = {BacklashModel::kThesis, clearance_deg * kRadPerDeg, kZeta};
    J2_ = arm.joint[1].rotor_inertia_kgm2;
    d_b_ = arm.joint2_backlash.clearance_rad;
    backlash_.emplace_back(arm, kLoad);
  }

  double Drag_nm(double zeta_v) const {
    return backlash_.front().At(0.0, 0.0, zeta_v / kZeta).drag_nm;
  }

  // Power of the drag divided by the energy that impacts lose, (3.10), per time between them.
  double PowerRatio(double zeta_v) const {
    const double v = zeta_v / kZeta, e = 1.0 - zeta_v, mu = J2_ * kLoad / (J2_ + kLoad);
    const double lost = 0.5 * mu * v * v * (1.0 - e * e);
    const double between_s = (1.0 + e) * d_b_ / (2.0 * e * v);
    return Drag_nm(zeta_v) * v * between_s / lost;
  }

 private:
  static constexpr double kZeta = 0.2,
                          kLoad = 0.1;  // a ratio at a given zeta v does not depend on them
  double J2_ = 0.0, d_b_ = 0.0;
  std::vector<Backlash> backlash_;
};

void AddBacklash(const ArmParameters& arm, std::vector<Statement>* out) {
  const ThesisBacklash backlash(arm, 0.2), tight(arm, 0.02);
  const double slow = backlash.PowerRatio(0.1), fast = backlash.PowerRatio(0.5);
  out->push_back({"3.4", "the dissipation function (3.11) takes the energy that the impacts lose",
                  "it takes " + Figure(slow, 3) + " times as much at zeta v = 0.1, " +
                      Figure(fast, 3) + " times at 0.5",
                  std::abs(slow - 1.0) < 0.1 && std::abs(fast - 1.0) < 0.1 ? Verdict::kHolds
                                                                           : Verdict::kDoesNot});
  const double beyond = backlash.PowerRatio(0.9);
  out->push_back({"3.4", "backlash acts as a damper",
                  "at zeta v = 0.9 the dissipated power is " + Figure(beyond, 3) +
                      " times what the impacts lose: " +
                      (beyond < 0.0 ? "it drives the joint" : "it brakes the joint"),
                  beyond < 0.0 ? Verdict::kInPart : Verdict::kHolds});
  const double times = tight.Drag_nm(0.1) / backlash.Drag_nm(0.1);
  out->push_back({"3.4", "the clearance d_b sets the loss: without clearance, no loss",
                  "a clearance ten times smaller dissipates " + Figure(times, 3) +
                      " times as much, without bound as the clearance goes to zero",
                  times < 1.0 ? Verdict::kHolds : Verdict::kDoesNot});
}

Statement HigherModes(const ArmParameters& arm) {
  const Eigen::VectorXd two = FreeMotorFrequenciesHz(ArmModel(arm, {2, 2}), 0.0);
  const Eigen::VectorXd many =
      FreeMotorFrequenciesHz(ArmModel(arm, {kMaxModesPerLink, kMaxModesPerLink}), 0.0);
  double worst = 0.0;
  std::string text = "with two modes a link, the arm's frequencies are too high by";
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double percent = 100.0 * (two[i] / many[i] - 1.0);
    worst = std::max(worst, percent);
    text += (i > 0 ? ", " : " ") + Figure(percent, 2);
  }
  return {"3.6", "the modes above the M that are kept contribute little", text + " %",
          worst < 1.0 ? Verdict::kHolds : Verdict::kDoesNot};
}

double LowestFlexible_hz(const ArmModel& model, double rate_rad_s) {
  const PowerBalance balance =
      BalancePower(UndampedArm(model, {0.0, rate_rad_s, 0.0}), {.rigid_roots = 2});
  for (const PowerMode& mode : balance.mode) {
    if (!mode.rigid_origin) return mode.frequency_rad_s / kTwoPi;
  }
  return 0.0;
}

bool Grows(const ArmModel& model, double rate_rad_s) {
  const StateSpace system = DampedArm(model, {0.0, rate_rad_s, 0.0});
  return system.A.eigenvalues().real().maxCoeff() > 0.1;
}

// Lowest rate of joint 1 at which the linearised arm is unstable; searched up to 20 rad/s.
double CriticalRate_rad_s(const ArmModel& model) {
  constexpr double kMost = 20.0;
  double low = 0.0, high = kMost;
  if (!Grows(model, high)) return kMost;
  while (high - low > 1e-4) {
    const double middle = 0.5 * (low + high);
    (Grows(model, middle) ? high : low) = middle;
  }
  return high;
}

Statement Softening(ArmParameters arm) {
  arm.damping = DampingReading::kNone;
  arm.joint2_backlash.clearance_rad = 0.0;
  arm.foreshortening = false;
  const ArmModel thesis(arm, {4, 4});
  arm.foreshortening = true;
  const ArmModel stiffened(arm, {4, 4});
  const double still = LowestFlexible_hz(thesis, 0.0);
  const double soft = LowestFlexible_hz(thesis, kThesisRate_rad_s);
  const double stiff = LowestFlexible_hz(stiffened, kThesisRate_rad_s);
  const double critical = CriticalRate_rad_s(thesis), never = CriticalRate_rad_s(stiffened);
  return {"3.6", "a bent link keeps its length along the hub's axis (3.14), (3.16)",
          "at 4 rad/s this softens the arm's lowest frequency from " + Figure(still) + " to " +
              Figure(soft) + " Hz, and the linearised arm is unstable from " + Figure(critical, 4) +
              " rad/s on; with links that shorten as they bend the frequency is " + Figure(stiff) +
              " Hz at 4 rad/s, and stable up to " + Figure(never, 2) + " rad/s at least",
          std::abs(soft - stiff) < 0.05 * stiff ? Verdict::kHolds : Verdict::kDoesNot};
}

}  // namespace

std::vector<Statement> Chapter3Statements(const RigConfig& config) {
  std::vector<Statement> out = BeamStatements(config.arm);
  out.push_back(FrictionSwitch(config.arm));
  out.push_back(DampingRatios(config.arm));
  AddBacklash(config.arm, &out);
  out.push_back(HigherModes(config.arm));
  out.push_back(Softening(config.arm));
  out.push_back({"3.7", "the motors' mechanical time constant is much smaller than the electrical",
                 "neither is given; in direct-current motors it is usually the other way round",
                 Verdict::kNotTested});
  return out;
}

}  // namespace flexarm
