#include "controller/design/robustness_analysis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "controller/design/design_at_payload.h"
#include "controller/law/tracking_law.h"
#include "controller/types/control_config.h"
#include "controller/types/loop_grid.h"
#include "estimator/gauge_model.h"
#include "model/arm/arm_model.h"
#include "model/arm/linearization.h"
#include "model/math/dense_decompositions.h"
#include "model/math/discretize.h"
#include "model/units.h"

namespace flexarm {
namespace {

constexpr std::array<const char*, 4> kCheckNames = {"robustness-spectral-radius", "gain-margin-up",
                                                    "gain-margin-down", "delay-margin-ms"};

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kPlantModes = 4;
constexpr std::array<double, 3> kElbow_deg = {0.0, 45.0, 90.0};
constexpr std::array<double, 3> kGains = {1.0, 0.7, 1.4};
constexpr double kLongestDelay_s = 0.1;  // additional delay: the end of the search for the margin

// The required margins: the gain factors that the analysis applies, and more delay than the lag of
// the motor and the unmodelled latency of a sensor.
constexpr double kGainUp = 1.4;
constexpr double kGainDown = 0.7;
constexpr double kDelay_ms = 4.0;

/// Plant with the filters of its gauges: x = [q; q'; filters], y = [th1 th2 th3 th4, fitted modes].
struct Plant {
  MatrixXd A, B, C;
};

// Strain of every channel per unit of every modal coordinate, weighted as in the fit.
MatrixXd StrainShape(const ArmModel& model, const SensorConfig& sensors) {
  const Index flex = model.dof() - 4;
  MatrixXd shape(static_cast<Index>(sensors.strain.size()), flex);
  for (Index j = 0; j < flex; ++j) {
    const VectorXd q = VectorXd::Unit(model.dof(), 4 + j);
    for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
      const StrainChannelConfig& row = sensors.strain[i];
      shape(static_cast<Index>(i), j) =
          row.gain_v_per_unit * model.Strain(row.link, row.position_m, q);
    }
  }
  return shape;
}

// Map from the plant's modal coordinates to the fitted ones, rows of the modes that the law uses:
// zero for one that is not fitted.
MatrixXd FitOf(const ArmModel& plant, const ControlConfig& config) {
  const Index modes = config.estimator.modes_per_link;
  const Index known = config.controller.nominal.modes_per_link;
  const ArmModel few(config.arm,
                     ModeCount{.link1 = static_cast<int>(modes), .link2 = static_cast<int>(modes)});
  const MatrixXd fitted = StrainShape(few, config.sensors);
  const MatrixXd normal = fitted.transpose() * fitted;
  const MatrixXd seen = fitted.transpose() * StrainShape(plant, config.sensors);
  const MatrixXd fit = normal.llt().solve(seen);
  const Index both = std::min(modes, known);
  MatrixXd used = MatrixXd::Zero(2 * known, fit.cols());
  used.topRows(both) = fit.topRows(both);
  used.middleRows(known, both) = fit.middleRows(modes, both);
  return used;
}

Plant PlantAt(const ControlConfig& config, double payload_kg, double theta2_deg) {
  ArmParameters arm = config.arm;
  arm.payload_mass_kg = payload_kg;
  const ArmModel model(arm, ModeCount{.link1 = kPlantModes, .link2 = kPlantModes});
  const Index dof = model.dof(), flex = dof - 4;
  VectorXd q = VectorXd::Zero(dof);
  q(1) = q(3) = RadFromDeg(theta2_deg);
  const LinearModel linear = Linearize(model, q, VectorXd::Zero(dof), Eigen::Vector2d::Zero());

  const Index n = 2 * dof;
  const LinearModel measured =
      WithGaugeFilter(linear.A, linear.B, 4, flex, config.sensors.strain_input);
  Plant plant{.A = measured.A,
              .B = measured.B,
              .C = MatrixXd::Zero(config.controller.nominal.outputs(), measured.A.rows())};
  plant.C.topLeftCorner(4, 4).setIdentity();
  plant.C.block(4, n, plant.C.rows() - 4, flex) = FitOf(model, config);
  return plant;
}

/// Delay that the loop compensates, beyond one period: whole periods, -1 for a torque that is
/// output at once, and the remainder.
struct OwnDelay {
  Index whole;
  double rest_s;
};

OwnDelay OwnDelayOf(const LoopConfig& loop) {
  const LoopGrid grid(loop);
  const std::int64_t late_ns = grid.late_ns();
  const std::int64_t whole = late_ns < 0 ? -1 : late_ns / grid.period_ns;
  return {.whole = static_cast<Index>(whole),
          .rest_s = 1e-9 * static_cast<double>(late_ns - whole * grid.period_ns)};
}

/// The estimator as a linear system: z(k) = A z(k-1) + B [y(k); u; u'],
/// x_hat(k) = C z(k-1) + D [y(k); u; u'], u, then u' the torques of the last period.
struct LinearEstimator {
  MatrixXd A, B, C, D;
};

LinearEstimator KalmanOf(const Design& design, double first_s, double period_s) {
  const Index nf = design.filter_A.rows(), outputs = design.filter_C.rows(), n = design.A.rows();
  const MatrixXd correct = MatrixXd::Identity(nf, nf) - design.filter_L * design.filter_C;
  MatrixXd drive = MatrixXd::Zero(nf, 4);
  if (first_s > 0.0) {
    const DiscreteModel then =
        ZeroOrderHold(design.filter_A_rate, design.filter_B_rate, period_s - first_s);
    drive << then.A * ZeroOrderHold(design.filter_A_rate, design.filter_B_rate, first_s).B, then.B;
  } else {
    drive.rightCols(2) = design.filter_B;
  }
  LinearEstimator out;
  out.A = correct * design.filter_A;
  out.B.resize(nf, outputs + 4);
  out.B << design.filter_L, correct * drive;
  out.C = out.A.topRows(n);
  out.D = out.B.topRows(n);
  return out;
}

// Backward differences: z is the last measurement of angles and modes.
LinearEstimator DifferenceOf(const Design& design, double period_s) {
  const Index dof = design.layout.dof(), outputs = design.layout.outputs();
  MatrixXd pick = MatrixXd::Zero(dof, outputs + 4);
  for (int i = 0; i < design.layout.dof(); ++i) pick(i, design.layout.output(i)) = 1.0;
  LinearEstimator out;
  out.A = MatrixXd::Zero(dof, dof);
  out.B = pick;
  out.C = MatrixXd::Zero(2 * dof, dof);
  out.C.bottomRows(dof) = -MatrixXd::Identity(dof, dof) / period_s;
  out.D.resize(2 * dof, outputs + 4);
  out.D << pick, pick / period_s;
  return out;
}

// `ekf-payload` enters as the Kalman filter for one payload, `ideal` as the filter that an arm
// would have.
LinearEstimator EstimatorOf(const ControlConfig& config, const Design& design) {
  const double period_s = config.loop.period_s();
  switch (config.estimator.kind) {
    case EstimatorKind::kKalman:
    case EstimatorKind::kPayload:
    case EstimatorKind::kIdeal:
      return KalmanOf(design, OwnDelayOf(config.loop).rest_s, period_s);
    case EstimatorKind::kDifference:
    case EstimatorKind::kPolynomial:
      break;
  }
  return DifferenceOf(design, period_s);
}

/// A delay as whole periods and the remainder, 0 <= rest_s < period_s.
struct PeriodsAndRest {
  Index periods;
  double rest_s;
};

PeriodsAndRest SplitDelay(double delay_s, double period_s) {
  constexpr double kRounding = 1e-9;  // of a period: a delay of whole periods has no remainder
  const double periods = std::floor(delay_s / period_s + kRounding);
  return {.periods = static_cast<Index>(periods),
          .rest_s = std::max(delay_s - periods * period_s, 0.0)};
}

// Torques in the state of the loop: of as many steps as the longest delay reaches back.
Index TorquesOf(const OwnDelay& own, double period_s) {
  const Index periods = SplitDelay(own.rest_s + kLongestDelay_s, period_s).periods;
  return periods + 2 + std::max(own.whole, Index{0});
}

/// The loop around one plant.
class Loop {
 public:
  Loop(const ControlConfig& config, const Design& design, const Plant& plant)
      : config_(config),
        design_(design),
        plant_(plant),
        estimator_(EstimatorOf(config, design)),
        K_(FeedbackGain(design, config.controller)),
        own_(OwnDelayOf(config.loop)),
        first_u_(plant.A.rows() + estimator_.A.rows()),
        inputs_(2 * TorquesOf(own_, config.loop.period_s())) {}

  // State [x; z; u_0; u_1; ..], u_i the torque computed at step k-1-i. Relative to k Ts it acts at
  // (whole - i) Ts + rest with the compensated delay, and delay_s later in the plant:
  // 0 <= delay_s <= kLongestDelay_s.
  double SpectralRadius(double gain, double delay_s) const {
    const Index nx = plant_.A.rows(), nz = estimator_.A.rows();
    MatrixXd loop = MatrixXd::Zero(first_u_ + inputs_, first_u_ + inputs_);
    const MatrixXd seen = Seen();
    loop.middleRows(nx, nz) = estimator_.B * seen;
    loop.block(nx, nx, nz, nz) += estimator_.A;
    MatrixXd x_hat = estimator_.D * seen;
    x_hat.middleCols(nx, nz) += estimator_.C;
    if (config_.controller.prediction) x_hat = Predicted(x_hat);
    const MatrixXd asked = -gain * K_ * x_hat;
    loop.middleRows(first_u_, 2) = asked;
    loop.block(first_u_ + 2, first_u_, inputs_ - 2, inputs_ - 2).setIdentity();
    AddPlant(own_.rest_s + delay_s, asked, &loop);
    if (!loop.allFinite()) return std::numeric_limits<double>::quiet_NaN();
    return loop.eigenvalues().cwiseAbs().maxCoeff();
  }

 private:
  // u_i as a function of the state.
  MatrixXd Torque(Index i) const {
    MatrixXd row = MatrixXd::Zero(2, first_u_ + inputs_);
    row.middleCols(first_u_ + 2 * i, 2).setIdentity();
    return row;
  }

  // [y; u; u'], y = C x. For rigid joints minus [0; u'/K; 0], the torsion in the rotor readings.
  MatrixXd Seen() const {
    const Index outputs = plant_.C.rows();
    MatrixXd seen = MatrixXd::Zero(outputs + 4, first_u_ + inputs_);
    seen.topLeftCorner(outputs, plant_.A.rows()) = plant_.C;
    const MatrixXd then = Torque(own_.whole + 1);
    if (!design_.layout.torsion) {
      seen.row(2) -= then.row(0) / config_.arm.joint[0].stiffness_nm_per_rad;
      seen.row(3) -= then.row(1) / config_.arm.joint[1].stiffness_nm_per_rad;
    }
    seen.bottomRows(4) << Torque(own_.whole + 2), then;
    return seen;
  }

  MatrixXd Predicted(MatrixXd x_hat) const {
    if (own_.rest_s > 0.0) {
      const DiscreteModel part = ZeroOrderHold(design_.A_rate, design_.B_rate, own_.rest_s);
      x_hat = part.A * x_hat + part.B * Torque(own_.whole + 1);
    }
    for (Index i = own_.whole; i >= 0; --i) x_hat = design_.A * x_hat + design_.B * Torque(i);
    return x_hat;
  }

  // Within the period the torque of one step replaces that of the step before.
  void AddPlant(double late_s, const MatrixXd& asked, MatrixXd* loop) const {
    const Index nx = plant_.A.rows();
    const double period_s = config_.loop.period_s();
    const auto [periods, rest_s] = SplitDelay(late_s, period_s);
    const Index newest = own_.whole + periods;  // -1: the torque of the present step
    const DiscreteModel rest = ZeroOrderHold(plant_.A, plant_.B, period_s - rest_s);
    loop->topRows(nx) = rest.B * (newest < 0 ? asked : Torque(newest));
    if (rest_s <= 0.0) {
      loop->topLeftCorner(nx, nx) += rest.A;
      return;
    }
    const DiscreteModel before = ZeroOrderHold(plant_.A, plant_.B, rest_s);
    loop->topLeftCorner(nx, nx) += rest.A * before.A;
    loop->topRows(nx) += rest.A * before.B * Torque(newest + 1);
  }

  const ControlConfig& config_;
  const Design& design_;
  const Plant& plant_;
  LinearEstimator estimator_;
  MatrixXd K_;
  OwnDelay own_;
  Index first_u_;  // of u_0 in the state
  Index inputs_;
};

// Stability boundary between `stable`, where the loop is stable, and `end`, to 1 %: search in
// steps, then bisection. `end` if the loop is stable up to there.
template <typename Radius>
double Edge(double stable, double end, const Radius& radius) {
  constexpr int kSteps = 40, kHalvings = 8;
  double inside = stable, outside = end;
  bool found = false;
  for (int i = 1; i <= kSteps && !found; ++i) {
    const double at = stable + (end - stable) * std::pow(static_cast<double>(i) / kSteps, 3.0);
    found = !(radius(at) < 1.0);  // NaN is not stable
    (found ? outside : inside) = at;
  }
  for (int i = 0; found && i < kHalvings; ++i) {
    const double middle = 0.5 * (inside + outside);
    (radius(middle) < 1.0 ? inside : outside) = middle;
  }
  return outside;
}

// The design that controls the arm with this payload at this elbow angle: a law that follows the
// payload has found it.
Design DesignInCase(const ControlConfig& config, const Design& design, double payload_kg,
                    double theta2_deg) {
  if (!design.scheduled) return design;
  return DesignAtPayload(config, design, payload_kg, RadFromDeg(theta2_deg));
}

// Orders spectral radii: one that is not a number is the worst.
double Badness(double spectral_radius) {
  return std::isnan(spectral_radius) ? std::numeric_limits<double>::infinity() : spectral_radius;
}

double DelayOf(const Loop& loop) {
  return Edge(0.0, kLongestDelay_s,
              [&loop](double delay_s) { return loop.SpectralRadius(1.0, delay_s); });
}

LoopMargins MarginsOf(const Loop& loop) {
  if (!(loop.SpectralRadius(1.0, 0.0) < 1.0))
    return {.gain_up = 1.0, .gain_down = 1.0, .delay_s = 0};
  const auto with_gain = [&loop](double gain) { return loop.SpectralRadius(gain, 0.0); };
  return {.gain_up = Edge(1.0, 100.0, with_gain),
          .gain_down = Edge(1.0, 0.0, with_gain),
          .delay_s = DelayOf(loop)};
}

}  // namespace

const RobustnessCase& RobustnessAnalysis::worst() const {
  return *std::max_element(cases.begin(), cases.end(), [](const auto& a, const auto& b) {
    return Badness(a.spectral_radius) < Badness(b.spectral_radius);
  });
}

const RobustnessCase& RobustnessAnalysis::worst_required() const {
  return *std::max_element(cases.begin(), cases.end(), [](const auto& a, const auto& b) {
    return (a.required ? Badness(a.spectral_radius) : 0.0) <
           (b.required ? Badness(b.spectral_radius) : 0.0);
  });
}

RobustnessAnalysis AnalyzeRobustness(const ControlConfig& config, const Design& design,
                                     const std::vector<double>& payload_kg) {
  RobustnessAnalysis robustness{};
  const double own_kg = config.arm.payload_mass_kg;
  std::set<double> payloads(payload_kg.begin(), payload_kg.end());
  payloads.insert(own_kg);
  for (const double payload : payloads) {
    for (const double theta2_deg : kElbow_deg) {
      const Plant plant = PlantAt(config, payload, theta2_deg);
      const Design own = DesignInCase(config, design, payload, theta2_deg);
      const Loop loop(config, own, plant);
      for (const double gain : kGains) {
        robustness.cases.push_back({.payload_kg = payload,
                                    .theta2_deg = theta2_deg,
                                    .gain = gain,
                                    .spectral_radius = loop.SpectralRadius(gain, 0.0),
                                    .required = gain == 1.0 || payload == own_kg});
      }
    }
  }
  const Plant nominal = PlantAt(config, own_kg, 0.0);
  const Design own = DesignInCase(config, design, own_kg, 0.0);
  robustness.margins = MarginsOf(Loop(config, own, nominal));
  return robustness;
}

std::vector<DesignCheck> ChecksOf(const RobustnessAnalysis& robustness) {
  return {{kCheckNames[0], robustness.worst_required().spectral_radius, 1.0, true},
          {kCheckNames[1], robustness.margins.gain_up, kGainUp, false},
          {kCheckNames[2], robustness.margins.gain_down, kGainDown, true},
          {kCheckNames[3], 1e3 * robustness.margins.delay_s, kDelay_ms, false}};
}

bool IsRobustnessCheck(const std::string& name) {
  return std::find(kCheckNames.begin(), kCheckNames.end(), name) != kCheckNames.end();
}

}  // namespace flexarm
