#include "controller/design/design_controller.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <fstream>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "controller/design/gain_table_design.h"
#include "controller/design/input_shaper.h"
#include "controller/law/adaptation_matrices.h"
#include "controller/law/tracking_law.h"
#include "controller/types/control_config.h"
#include "controller/types/rejected_error.h"
#include "estimator/kalman_design.h"
#include "estimator/nominal_model.h"
#include "estimator/payload_estimator.h"
#include "model/math/dense_decompositions.h"
#include "model/math/discretize.h"
#include "model/math/riccati.h"
#include "model/units.h"

namespace flexarm {
namespace {

double SpectralRadius(const Eigen::MatrixXd& A) { return A.eigenvalues().cwiseAbs().maxCoeff(); }

// Default Q weights hub angles and rates only: weights on elastic energy make the regulator act
// against modes that the nominal model does not contain.
Eigen::MatrixXd StateWeight(const ControllerConfig& controller) {
  const StateLayout& layout = controller.nominal;
  if (!controller.state_weight.empty()) {
    return Eigen::VectorXd::Map(controller.state_weight.data(), layout.states()).asDiagonal();
  }
  Eigen::VectorXd q = Eigen::VectorXd::Zero(layout.states());
  for (int joint = 0; joint < 2; ++joint) {
    const int hub = layout.hub(joint);
    q(hub) = controller.hub_angle_weight[static_cast<std::size_t>(joint)];
    q(layout.rate(hub)) = controller.hub_rate_weight[static_cast<std::size_t>(joint)];
  }
  return q.asDiagonal();
}

// LQR without prescribed degree of stability: slower, and without the limit cycle that friction
// causes under the tracking gains with another payload.
Eigen::MatrixXd StopGain(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                         const Eigen::MatrixXd& Q) {
  const Eigen::Matrix2d I2 = Eigen::Matrix2d::Identity();
  return DareGain(A, B, I2, SolveDare(A, B, Q, I2));
}

// LQR with prescribed degree of stability: P of (a A, a B, Q/rho, I), a = e^(alpha Ts), and
// K = (I + a^2 B'PB)^-1 a^2 B'PA. P' = a^2 P satisfies A_c'P'B = K', so the lemma (7.16) holds with
// W = 0 and J = B'P'B/2.
void DesignRegulator(const ControlConfig& config, Design* design) {
  const ControllerConfig& controller = config.controller;
  const double a = std::exp(controller.design_alpha() * config.loop.period_s());
  const Eigen::MatrixXd& A = design->A;
  const Eigen::MatrixXd& B = design->B;
  const Eigen::MatrixXd Q = StateWeight(controller) / controller.torque_weight;
  const Eigen::Matrix2d I2 = Eigen::Matrix2d::Identity();
  const Eigen::MatrixXd P = SolveDare(a * A, a * B, Q, I2);
  design->P = a * a * P;
  const Eigen::MatrixXd BtP = B.transpose() * design->P, BtPA = BtP * A;
  const Eigen::MatrixXd S = I2 + BtP * B;
  design->K = S.llt().solve(BtPA);
  design->K_stop = StopGain(A, B, Q);
  design->J = 0.5 * B.transpose() * design->P * B;
  design->G = design->J + controller.passivity_margin * I2;
  design->checks.push_back(
      {"regulator-riccati-residual", DareResidual(a * A, a * B, Q, I2, P), 1e-9, true});
}

// Coordinates in which the CGT equation is well conditioned: unit modal mass, and rates scaled by
// the torque modes. Link 1's second shape has its node at the heavy tip, so with psi(L) = 1 its
// modal mass is 410 kg.
Eigen::VectorXd TrackingScale(const NominalModel& nominal) {
  const Eigen::Index dof = nominal.M.rows();
  const double rate = nominal.torque_mode_rad_s(0);
  Eigen::VectorXd scale(2 * dof);
  scale.head(dof) = nominal.M.diagonal().cwiseSqrt().cwiseInverse();
  scale.tail(dof) = rate * scale.head(dof);
  return scale;
}

TrackingProblem ProblemOf(const NominalModel& nominal, const Design& design) {
  return {.A = design.A,
          .B = design.B,
          .Cp = design.K,
          .Am = design.Am,
          .Bm = design.Bm,
          .Cm = design.K,
          .scale = TrackingScale(nominal)};
}

void DesignCommandGenerator(const NominalModel& nominal, Design* design) {
  const TrackingProblem problem = ProblemOf(nominal, *design);
  const CommandGenerator generator = SolveCommandGenerator(problem);
  design->S11 = generator.S11;
  design->S12 = generator.S12;
  design->S21 = generator.S21;
  design->S22 = generator.S22;
  design->checks.push_back({"cgt-condition", generator.condition, 1e9, true});
  design->checks.push_back({"cgt-residual", TrackingResidual(problem, generator), 1e-8, true});

  const Eigen::MatrixXd& B = design->B;
  const Eigen::MatrixXd BtB = B.transpose() * B;
  const Eigen::MatrixXd missing = B.transpose() * (design->Am - design->A);
  const Eigen::MatrixXd BtBm = B.transpose() * design->Bm;
  design->Ufx = BtB.llt().solve(missing);  // (7.25)
  design->Ufu = BtB.llt().solve(BtBm);
}

// Of the Hermitian matrix [a b; b* d].
double SmallestEigenvalue(double a, double d, const std::complex<double>& b) {
  return 0.5 * (a + d) - std::hypot(0.5 * (a - d), std::abs(b));
}

// Smallest eigenvalue of S + S* on the unit circle, S(z) = J + K (zI - A_c)^-1 B. The lemma (7.16)
// says that it is positive; this checks it numerically.
double PositiveRealMargin(const Design& design, const Eigen::MatrixXd& closed) {
  constexpr int kFrequencies = 720;
  const Eigen::MatrixXcd A_c = closed.cast<std::complex<double>>();
  const Eigen::MatrixXcd B = design.B.cast<std::complex<double>>();
  const Eigen::MatrixXcd K = design.K.cast<std::complex<double>>();
  const Eigen::MatrixXcd J = design.J.cast<std::complex<double>>();
  const Eigen::MatrixXcd I = Eigen::MatrixXcd::Identity(A_c.rows(), A_c.cols());
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kFrequencies; ++i) {
    const std::complex<double> z = std::polar(1.0, std::numbers::pi * i / kFrequencies);
    const Eigen::MatrixXcd state = (z * I - A_c).partialPivLu().solve(B);
    const Eigen::MatrixXcd S = J + K * state, H = S + S.adjoint();
    smallest = std::min(smallest, SmallestEigenvalue(H(0, 0).real(), H(1, 1).real(), H(0, 1)));
  }
  return smallest;
}

double SmallestEigenvalue(const Eigen::MatrixXd& matrix) {
  const Eigen::MatrixXd even = 0.5 * (matrix + matrix.transpose());
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(even, Eigen::EigenvaluesOnly)
      .eigenvalues()(0);
}

// The closed form of the lemma holds with K_e = I; with another K_e the frequencies say whether the
// transfer matrix is strictly positive real.
void CheckLemma(double alpha, double period_s, Design* design) {
  const Eigen::MatrixXd A_c = design->A - design->B * design->K;
  const Eigen::MatrixXd mismatch = A_c.transpose() * design->P * design->B - design->K.transpose();
  const Eigen::MatrixXd LLt = design->P - A_c.transpose() * design->P * A_c;
  design->checks.push_back({"lemma-residual",
                            mismatch.cwiseAbs().maxCoeff() / design->K.cwiseAbs().maxCoeff(), 1e-8,
                            true});
  design->checks.push_back({"lemma-dissipation-min-eigenvalue",
                            SmallestEigenvalue(LLt) / design->P.cwiseAbs().maxCoeff(), -1e-12,
                            false});
  design->checks.push_back({"j-min-eigenvalue", SmallestEigenvalue(design->J), 0.0, false});
  design->checks.push_back(
      {"g-minus-j-min-eigenvalue", SmallestEigenvalue(design->G - design->J), 0.0, false});
  design->checks.push_back(
      {"positive-real-min-eigenvalue", PositiveRealMargin(*design, A_c), 0.0, false});
  design->checks.push_back({"closed-loop-spectral-radius", SpectralRadius(A_c),
                            std::exp(-alpha * period_s) + 1e-9, true});
}

// Appendix E with the matrices of the config: T > 0, 2 Tbar - T >= 0, S'SG > J, and (7.15) positive
// real around A - B K_e K.
void CheckMatrices(const ControllerConfig& controller, Design* design) {
  if (!controller.matrices || !IsAdaptive(controller.kind)) return;
  const AdaptationMatrices m = MatricesOf(controller, *design);
  const Eigen::MatrixXd closed = design->A - design->B * m.K_e * design->K;
  const double rounding = -1e-12 * (2.0 * m.Tbar - m.T).cwiseAbs().maxCoeff();
  design->checks.push_back({"t-min-eigenvalue", SmallestEigenvalue(m.T), 0.0, false});
  design->checks.push_back({"2tbar-minus-t-min-eigenvalue", SmallestEigenvalue(2.0 * m.Tbar - m.T),
                            std::min(rounding, -1e-300), false});
  design->checks.push_back({"ssg-minus-j-min-eigenvalue",
                            SmallestEigenvalue(m.S.transpose() * m.S * design->G - design->J), 0.0,
                            false});
  design->checks.push_back({"ke-spectral-radius", SpectralRadius(closed), 1.0, true});
  design->checks.push_back(
      {"ke-positive-real-min-eigenvalue", PositiveRealMargin(*design, closed), 0.0, false});
}

void DesignShaper(const ControlConfig& config, Design* design) {
  const ControllerKind kind = config.controller.kind;
  design->shaper = Eigen::RowVectorXd::Ones(1);
  if (kind != ControllerKind::kPdZv && kind != ControllerKind::kPdZvd) return;
  const Eigen::MatrixXd closed = design->A - design->B * FeedbackGain(*design, config.controller);
  design->shaper = DesignInputShaper(closed, kind == ControllerKind::kPdZv ? 1 : 2);
  design->checks.push_back({"pd-spectral-radius", SpectralRadius(closed), 1.0, true});
}

void DesignForPayload(const ControlConfig& config, Design* design) {
  if (!config.uses_payload_estimator()) return;
  const double period_s = config.loop.period_s();
  design->payload_model = PayloadModelConstants(config.arm, config.sensors, period_s);
  if (!IsScheduled(config.controller.kind) && !config.settles()) return;
  const ControllerConfig& controller = config.controller;
  const PayloadLawConfig& law = *controller.payload;
  GainGrid grid{.payload_kg = law.gain_payload_kg, .theta2_rad = law.gain_elbow_deg};
  for (double& theta2 : grid.theta2_rad) theta2 *= kRadPerDeg;
  const Eigen::VectorXd q = StateWeight(controller).diagonal();
  const RigidJointArm arm = MakeRigidJointArm(*design);
  const auto table = [&](double alpha_per_s) {
    GainWeights weights{
        .state = {}, .torque = controller.torque_weight, .alpha_per_s = alpha_per_s};
    std::copy_n(q.data(), weights.state.size(), weights.state.begin());
    return DesignGainTable(arm, grid, weights, period_s);
  };
  if (config.settles()) {
    design->settle_gains = table(controller.settling->alpha);
    return;
  }
  design->scheduled = ScheduledDesign{.gains = table(controller.alpha),
                                      .start_gains = {},
                                      .max_kg = law.max_kg,
                                      .reference_kg = law.reference_kg};
  if (PlansAhead(controller.kind)) {
    design->scheduled->start_gains = table(controller.plan->start_alpha);
  }
}

}  // namespace

Design DesignController(const ControlConfig& config) {
  const double period_s = config.loop.period_s();
  const NominalModel nominal = MakeNominalModel(config.arm, config.controller.nominal);
  const NominalModel reference = MakeReferenceModel(nominal);
  const DiscreteModel plant = ZeroOrderHold(nominal.A, nominal.B, period_s);
  const DiscreteModel followed = ZeroOrderHold(reference.A, reference.B, period_s);

  Design design;
  design.layout = nominal.layout;
  design.A = plant.A;
  design.B = plant.B;
  design.A_rate = nominal.A;
  design.B_rate = nominal.B;
  design.Am = followed.A;
  design.Bm = followed.B;
  design.rigid_inertia_kgm2 = nominal.RigidInertia_kgm2();
  DesignRegulator(config, &design);
  CheckLemma(config.controller.design_alpha(), period_s, &design);
  DesignCommandGenerator(nominal, &design);
  CheckMatrices(config.controller, &design);
  DesignShaper(config, &design);
  DesignForPayload(config, &design);

  const KalmanDesign filter =
      DesignKalmanFilter(nominal, config.arm, config.sensors, config.estimator, period_s);
  design.filter_A = filter.A;
  design.filter_B = filter.B;
  design.filter_C = filter.C;
  design.filter_L = filter.L;
  design.filter_A_rate = filter.A_rate;
  design.filter_B_rate = filter.B_rate;
  design.filter_W = filter.W;
  design.filter_P = filter.P;
  design.filter_R = filter.R;
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(filter.A.rows(), filter.A.rows());
  design.checks.push_back({"filter-riccati-residual", filter.residual, 1e-9, true});
  design.checks.push_back(
      {"filter-spectral-radius", SpectralRadius(filter.A * (I - filter.L * filter.C)), 1.0, true});
  return design;
}

TrackingProblem TrackingProblemOf(const ControlConfig& config, const Design& design) {
  return ProblemOf(MakeNominalModel(config.arm, design.layout), design);
}

}  // namespace flexarm
