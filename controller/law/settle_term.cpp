#include "controller/law/settle_term.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/math/portable_math.h"
#include "model/rigid_joint/rigid_joint_arm.h"

namespace flexarm {
namespace {

// Below this rate of the reference's hubs a sample without commanded torque belongs to a rest.
constexpr double kRestRate_rad_s = 0.05;
// The payload's gains are faded in over this time; then the vibration is judged.
constexpr double kFadesIn_s = 0.1;
// The friction acts against a hub that would turn faster than this: much less than the 0.04 rad/s
// of one sample of torque equal to the friction.
constexpr double kTurns_rad_s = 0.003;
// Amplitude of the tip below which the friction may hold the arm, 0.8 mm rms, less than the 1 mm
// that is asked for; and above which it is damped again.
constexpr double kHoldBelow_m = 1.15e-3, kReleaseAbove_m = 1.7e-3;

// Of the mass matrix for the energy.
constexpr double kNominalPayload_kg = 0.1;

// Displacement of the tip per coordinate, at q = 0: its acceleration is linear in q'' there.
Eigen::Matrix<double, 1, 6> TipRow(const RigidJointArm& arm) {
  const RigidJointArm::Vector zero = RigidJointArm::Vector::Zero();
  Eigen::Matrix<double, 1, 6> row;
  for (int i = 0; i < RigidJointArm::kDof; ++i) {
    row(i) = arm.TipAcceleration(zero, zero, RigidJointArm::Vector::Unit(i));
  }
  return row;
}

// Mass matrix of the straight arm at rest.
RigidJointArm::Matrix StraightMass(const RigidJointArm& arm, double payload_kg) {
  const RigidJointArm::Vector zero = RigidJointArm::Vector::Zero();
  return arm.At(arm.Outboard(payload_kg), zero, zero).M;
}

// Stiffness at the tip of the slowest vibration with both hubs locked and the arm straight: twice
// its energy per amplitude squared. Inverse iteration.
double SwayStiffness_n_per_m(const RigidJointArm& arm, const RigidJointArm::Matrix& mass) {
  const Eigen::Matrix4d M = mass.bottomRightCorner<4, 4>();
  const Eigen::Matrix4d K = arm.stiffness().bottomRightCorner<4, 4>();
  const Eigen::LLT<Eigen::Matrix4d> K_llt(K);
  Eigen::Vector4d f(1.0, 0.0, 1.0, 0.0);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector4d next = K_llt.solve(M * f);
    f = next / next.norm();
  }
  const double tip_m = TipRow(arm).tail<4>().dot(f);
  return f.dot(K * f) / (tip_m * tip_m);
}

GainTable SettleGains(const Design& design) {
  if (!design.settle_gains) throw std::invalid_argument("SettleTerm: a design without its gains");
  return *design.settle_gains;
}

}  // namespace

SettleTerm::SettleTerm(const Design& design, double friction_nm, double period_s)
    : gains_(SettleGains(design)),
      friction_nm_(friction_nm),
      period_s_(period_s),
      hub_after_(design.A.row(0)),
      hub_by_torque_(design.B.row(0)),
      mass_(StraightMass(MakeRigidJointArm(design), kNominalPayload_kg)),
      stiffness_(MakeRigidJointArm(design).stiffness()),
      sway_n_per_m_(SwayStiffness_n_per_m(MakeRigidJointArm(design), mass_)) {}

void SettleTerm::Reset() noexcept {
  rested_s_ = 0.0;
  held_ = false;
}

// A command of zero torque in the middle of a move is not a rest: the reference's hubs turn.
void SettleTerm::CountRest(const ReferenceSample& reference) noexcept {
  const bool rests = reference.u_m_nm[0] == 0.0 && reference.u_m_nm[1] == 0.0 &&
                     std::fabs(reference.x_m[6]) < kRestRate_rad_s &&
                     std::fabs(reference.x_m[7]) < kRestRate_rad_s;
  rested_s_ = rests ? rested_s_ + period_s_ : 0.0;
  if (!rests) held_ = false;
}

void SettleTerm::JudgeVibration(const State& x) noexcept {
  if (rested_s_ <= kFadesIn_s) return;
  const Eigen::Matrix<double, 6, 1> bent = stiffness_.lazyProduct(x.head<6>());
  const Eigen::Matrix<double, 6, 1> swing = mass_.lazyProduct(x.tail<6>());
  const double energy_j = 0.5 * (bent.dot(x.head<6>()) + swing.dot(x.tail<6>()));
  const double amplitude_m = std::sqrt(2.0 * std::max(0.0, energy_j) / sway_n_per_m_);
  held_ = amplitude_m < (held_ ? kReleaseAbove_m : kHoldBelow_m);
}

// @param u  the torque without friction compensation
double SettleTerm::FrictionTorque(const State& x, const Eigen::Vector2d& u,
                                  double estimated_nm) const noexcept {
  const double turns_rad = hub_after_.dot(x) + hub_by_torque_.dot(u) - x(0);
  return std::min(friction_nm_, estimated_nm) *
         PortableMath::Tanh(turns_rad / (period_s_ * kTurns_rad_s));
}

Eigen::Vector2d SettleTerm::Torque(const StateVector& x, const ReferenceSample& reference,
                                   const Eigen::Vector2d& feedback_nm,
                                   const Eigen::Vector2d& wanted_nm,
                                   const PayloadKnowledge& payload) noexcept {
  CountRest(reference);
  if (rested_s_ <= 0.0 || x.size() != State::RowsAtCompileTime) return Eigen::Vector2d::Zero();
  const State now = x.head<12>();
  State off;
  for (int i = 0; i < 12; ++i) off(i) = reference.x_m[static_cast<std::size_t>(i)] - now(i);
  const double share = std::min(1.0, rested_s_ / kFadesIn_s);
  Eigen::Vector2d add = gains_.At(payload.payload_kg, now(1)).lazyProduct(off);
  add = share * (add - feedback_nm);
  JudgeVibration(now);
  if (!held_) add(0) += FrictionTorque(now, wanted_nm + add, payload.friction_nm[0]);
  return add;
}

}  // namespace flexarm
