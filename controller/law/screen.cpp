#include "controller/law/screen.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "controller/law/tracking_law.h"
#include "controller/runtime/stack_config.h"
#include "estimator/gauge_model.h"
#include "model/arm_model.h"
#include "model/discretize.h"
#include "model/linearization.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kPlantModes = 4;
constexpr std::array<double, 3> kElbow_deg = {0.0, 45.0, 90.0};
constexpr std::array<double, 3> kGains = {1.0, 0.7, 1.4};
constexpr Index kMaxDelayPeriods = 5;

// The margins that a design must have: the factors that the screen itself tries, and more delay
// than the motor's lag and the age of a reading that nobody has told the loop about.
constexpr double kGainUp = 1.4;
constexpr double kGainDown = 0.7;
constexpr double kDelay_ms = 4.0;

/// Plant with its gauges' filters: x = [q; q'; filters], y = [th1 th2 th3 th4 modes as fitted].
struct Plant {
  MatrixXd A, B, C;
};

// Strain of every channel for a unit of every modal coordinate, weighted as the fit does.
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

// What the fit of few modes makes of the plant's many.
MatrixXd FitOf(const ArmModel& plant, const StackConfig& config) {
  const int modes = config.estimator.modes_per_link;
  const ArmModel known(config.arm, ModeCount{.link1 = modes, .link2 = modes});
  const MatrixXd fitted = StrainShape(known, config.sensors);
  return (fitted.transpose() * fitted)
      .llt()
      .solve(fitted.transpose() * StrainShape(plant, config.sensors));
}

Plant PlantAt(const StackConfig& config, double payload_kg, double theta2_deg) {
  ArmParameters arm = config.arm;
  arm.payload_mass_kg = payload_kg;
  const ArmModel model(arm, ModeCount{.link1 = kPlantModes, .link2 = kPlantModes});
  const Index dof = model.dof(), flex = dof - 4;
  VectorXd q = VectorXd::Zero(dof);
  q(1) = q(3) = theta2_deg * std::numbers::pi / 180.0;
  const LinearModel linear = Linearize(model, q, VectorXd::Zero(dof), Eigen::Vector2d::Zero());

  const Index n = 2 * dof;
  const LinearModel measured =
      WithGaugeFilter(linear.A, linear.B, 4, flex, config.sensors.strain_input);
  Plant plant{.A = measured.A,
              .B = measured.B,
              .C = MatrixXd::Zero(4 + 2 * config.estimator.modes_per_link, measured.A.rows())};
  plant.C.topLeftCorner(4, 4).setIdentity();
  plant.C.block(4, n, plant.C.rows() - 4, flex) = FitOf(model, config);
  return plant;
}

/// The estimator as a linear system: z(k) = A z(k-1) + B [y(k); u(k-1)],
/// x_hat(k) = C z(k-1) + D [y(k); u(k-1)].
struct LinearEstimator {
  MatrixXd A, B, C, D;
};

LinearEstimator KalmanOf(const Design& design) {
  const Index nf = design.filter_A.rows(), outputs = design.filter_C.rows(), n = design.A.rows();
  const MatrixXd correct = MatrixXd::Identity(nf, nf) - design.filter_L * design.filter_C;
  LinearEstimator out;
  out.A = correct * design.filter_A;
  out.B.resize(nf, outputs + 2);
  out.B << design.filter_L, correct * design.filter_B;
  out.C = out.A.topRows(n);
  out.D = out.B.topRows(n);
  return out;
}

// Backward differences: z is the last measurement of hubs and modes.
LinearEstimator DifferenceOf(const Design& design, double period_s) {
  const Index dof = design.A.rows() / 2, outputs = design.filter_C.rows();
  MatrixXd pick = MatrixXd::Zero(dof, outputs + 2);
  pick.topLeftCorner(2, 2).setIdentity();
  pick.block(2, 4, dof - 2, dof - 2).setIdentity();
  LinearEstimator out;
  out.A = MatrixXd::Zero(dof, dof);
  out.B = pick;
  out.C = MatrixXd::Zero(2 * dof, dof);
  out.C.bottomRows(dof) = -MatrixXd::Identity(dof, dof) / period_s;
  out.D.resize(2 * dof, outputs + 2);
  out.D << pick, pick / period_s;
  return out;
}

LinearEstimator EstimatorOf(const StackConfig& config, const Design& design) {
  return config.estimator.kind == EstimatorKind::kKalman
             ? KalmanOf(design)
             : DifferenceOf(design, config.loop.period_ms * 1e-3);
}

/// The loop around one plant.
class Loop {
 public:
  Loop(const StackConfig& config, const Design& design, const Plant& plant)
      : config_(config),
        design_(design),
        plant_(plant),
        estimator_(EstimatorOf(config, design)),
        K_(FeedbackGain(design, config.controller)) {}

  // State [x; z; u(k); u(k-1); ..]. Within the period u(k - d) takes over from u(k - d - 1) when
  // the delay's fraction of it is over.
  double SpectralRadius(double gain, double delay_s) const {
    const Index nx = plant_.A.rows(), nz = estimator_.A.rows(), outputs = plant_.C.rows();
    const Index inputs = 2 * (kMaxDelayPeriods + 2), first_u = nx + nz;
    MatrixXd loop = MatrixXd::Zero(first_u + inputs, first_u + inputs);
    const MatrixXd u_now = Row(loop.rows(), first_u), u_before = Row(loop.rows(), first_u + 2);

    const double period_s = config_.loop.period_ms * 1e-3;
    const Index whole = std::min(static_cast<Index>(delay_s / period_s), kMaxDelayPeriods);
    AddPlant(first_u + 2 * whole, delay_s - static_cast<double>(whole) * period_s, &loop);

    // y = C x - [0; u(k-1)/K; 0]: the torsion that the rotors' readings are freed of.
    MatrixXd seen = MatrixXd::Zero(outputs + 2, loop.rows());
    seen.topLeftCorner(outputs, nx) = plant_.C;
    seen.row(2) -= u_before.row(0) / config_.arm.joint[0].stiffness_nm_per_rad;
    seen.row(3) -= u_before.row(1) / config_.arm.joint[1].stiffness_nm_per_rad;
    seen.bottomRows(2) = u_before;

    loop.middleRows(nx, nz) = estimator_.B * seen;
    loop.block(nx, nx, nz, nz) += estimator_.A;
    MatrixXd x_hat = estimator_.D * seen;
    x_hat.middleCols(nx, nz) += estimator_.C;
    if (config_.controller.prediction) x_hat = design_.A * x_hat + design_.B * u_now;
    loop.middleRows(first_u, 2) = -gain * K_ * x_hat;
    loop.block(first_u + 2, first_u, inputs - 2, inputs - 2).setIdentity();
    return loop.eigenvalues().cwiseAbs().maxCoeff();
  }

 private:
  static MatrixXd Row(Index size, Index first) {
    MatrixXd row = MatrixXd::Zero(2, size);
    row.middleCols(first, 2).setIdentity();
    return row;
  }

  void AddPlant(Index newest_u, double late_s, MatrixXd* loop) const {
    const Index nx = plant_.A.rows();
    const double period_s = config_.loop.period_ms * 1e-3;
    const DiscreteModel rest = ZeroOrderHold(plant_.A, plant_.B, period_s - late_s);
    loop->block(0, newest_u, nx, 2) = rest.B;
    loop->topLeftCorner(nx, nx) = rest.A;
    if (late_s <= 0.0) return;
    const DiscreteModel before = ZeroOrderHold(plant_.A, plant_.B, late_s);
    loop->topLeftCorner(nx, nx) = rest.A * before.A;
    loop->block(0, newest_u + 2, nx, 2) = rest.A * before.B;
  }

  const StackConfig& config_;
  const Design& design_;
  const Plant& plant_;
  LinearEstimator estimator_;
  MatrixXd K_;
};

// Where a loop that is stable at `stable` stops being so on the way to `end`, to 1 %: walks, then
// halves. `end` if it never does.
template <typename Radius>
double Edge(double stable, double end, const Radius& radius) {
  constexpr int kSteps = 40, kHalvings = 8;
  double inside = stable, outside = end;
  bool found = false;
  for (int i = 1; i <= kSteps && !found; ++i) {
    const double at = stable + (end - stable) * std::pow(static_cast<double>(i) / kSteps, 3.0);
    found = radius(at) >= 1.0;
    (found ? outside : inside) = at;
  }
  for (int i = 0; found && i < kHalvings; ++i) {
    const double middle = 0.5 * (inside + outside);
    (radius(middle) >= 1.0 ? outside : inside) = middle;
  }
  return outside;
}

LoopMargins MarginsOf(const Loop& loop) {
  if (loop.SpectralRadius(1.0, 0.0) >= 1.0) return {.gain_up = 1.0, .gain_down = 1.0, .delay_s = 0};
  const auto with_gain = [&loop](double gain) { return loop.SpectralRadius(gain, 0.0); };
  const auto with_delay = [&loop](double delay_s) { return loop.SpectralRadius(1.0, delay_s); };
  return {.gain_up = Edge(1.0, 100.0, with_gain),
          .gain_down = Edge(1.0, 0.0, with_gain),
          .delay_s = Edge(0.0, 0.1, with_delay)};
}

}  // namespace

const ScreenCase& Screen::worst() const {
  return *std::max_element(cases.begin(), cases.end(), [](const auto& a, const auto& b) {
    return a.spectral_radius < b.spectral_radius;
  });
}

const ScreenCase& Screen::worst_required() const {
  return *std::max_element(cases.begin(), cases.end(), [](const auto& a, const auto& b) {
    return (a.required ? a.spectral_radius : 0.0) < (b.required ? b.spectral_radius : 0.0);
  });
}

Screen ScreenDesign(const StackConfig& config, const Design& design,
                    const std::vector<double>& payload_kg) {
  Screen screen{};
  const double own_kg = config.arm.payload_mass_kg;
  std::set<double> payloads(payload_kg.begin(), payload_kg.end());
  payloads.insert(own_kg);
  for (const double payload : payloads) {
    for (const double theta2_deg : kElbow_deg) {
      const Plant plant = PlantAt(config, payload, theta2_deg);
      const Loop loop(config, design, plant);
      for (const double gain : kGains) {
        screen.cases.push_back({.payload_kg = payload,
                                .theta2_deg = theta2_deg,
                                .gain = gain,
                                .spectral_radius = loop.SpectralRadius(gain, 0.0),
                                .required = gain == 1.0 || payload == own_kg});
      }
    }
  }
  const Plant nominal = PlantAt(config, own_kg, 0.0);
  screen.margins = MarginsOf(Loop(config, design, nominal));
  return screen;
}

std::vector<DesignCheck> ChecksOf(const Screen& screen) {
  return {{"screen-spectral-radius", screen.worst_required().spectral_radius, 1.0, true},
          {"gain-margin-up", screen.margins.gain_up, kGainUp, false},
          {"gain-margin-down", screen.margins.gain_down, kGainDown, true},
          {"delay-margin-ms", 1e3 * screen.margins.delay_s, kDelay_ms, false}};
}

}  // namespace flexarm
