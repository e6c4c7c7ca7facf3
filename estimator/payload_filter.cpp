#include "estimator/payload_filter.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>

#include "model/math/small_cholesky.h"

namespace flexarm {
namespace {

constexpr int kMotion = PayloadCovariance::kMotion;  // q, q', phi_f
constexpr int kPayload = PayloadCovariance::kPayload;
constexpr int kFriction = PayloadCovariance::kFriction;

constexpr double kPayloadProbe_kg = 1e-3;
constexpr double kNoiseFloor = 1e-13;  // keeps P definite, far below every physical noise

// Fading: the process noise grows by s = mean NIS / expected NIS, within bounds.
constexpr double kNisMemory = 0.8;
constexpr double kNisBound = 200.0;
constexpr double kMostFading = 30.0;

constexpr int kMostGlitches = 2;

// After so many samples at rest the covariance of the motion no longer changes.
constexpr int kRestSamples = 100;

// Standard deviations after the payload was assumed lost: of the rest of it, as a share of the
// greatest (0.1 kg on the thesis's rig), small, so that the first samples do not upset the
// estimate; of the errors that the wrong payload caused at the hubs.
constexpr double kDroppedPayload = 1.0 / 11.0;
constexpr double kDroppedAngle_rad = 3e-3, kDroppedRate_rad_s = 0.1;

// Variance of an output that was not read, with zero innovation: so large that it has no effect.
constexpr double kUnreadVariance = 1e12;

constexpr std::uint32_t kElbowOutputs = 0b1010;  // hub 2 and rotor 2

using MotionVector = Eigen::Matrix<double, kMotion, 1>;

// State of the motion that each output measures: th1 th2 th1 th2 phi_f.
constexpr std::array<int, PayloadFilter::kOutputs> kSeen = {0, 1, 0, 1, 12, 13, 14, 15};
constexpr std::array<int, 2> kFirstModes = {4, 6};  // outputs

double BeyondBand(double x, double half_width) noexcept {
  return x > half_width ? x - half_width : x < -half_width ? x + half_width : 0.0;
}

double Square(double x) noexcept { return x * x; }

// Without the change of the last `frozen` states.
PayloadCovariance::Vector Learned(const PayloadCovariance::Vector& dx, int frozen) noexcept {
  PayloadCovariance::Vector learned = dx;
  learned.segment(kPayload, frozen).setZero();
  return learned;
}

// Factor on the variance of an output beyond the gate.
double Loosening(double sigmas, double gate_sigmas) noexcept {
  return 4.0 * Square(sigmas / gate_sigmas);
}

}  // namespace

PayloadFilter::PayloadFilter(RigidJointStepper stepper, const PayloadFilterConfig& config)
    : stepper_(std::move(stepper)),
      config_(config),
      row_(RowsOf(config)),
      nis_scale_(static_cast<double>(kOutputs) / std::popcount(config.outputs & kAllGood)) {
  Reset(RigidJointArm::Vector::Zero());
}

std::array<PayloadFilter::Row, PayloadFilter::kOutputs> PayloadFilter::RowsOf(
    const PayloadFilterConfig& config) noexcept {
  std::array<Row, kOutputs> rows{};
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = {kSeen[i], kSeen[i], 0.0};
  for (std::size_t link = 0; link < 2; ++link) {
    Row& row = rows[static_cast<std::size_t>(kFirstModes[link])];
    row.second = row.state + 1;
    row.share = config.second_in_first[link];
  }
  return rows;
}

void PayloadFilter::Reset(const RigidJointArm::Vector& q) noexcept {
  estimate_.state = {.q = q, .v = RigidJointArm::Vector::Zero(), .phi_f = q.tail<4>()};
  estimate_.nis = 0.0;
  estimate_.innovation.setZero();
  estimate_.tip_innovation_m_s2 = 0.0;
  ForgetAllButMotion();
  mean_nis_ = kOutputs;
  learns_ = true;
  play_rad_ = 0.0;
}

void PayloadFilter::Reset(const RigidJointArm::Vector& q, const Covariance& P) noexcept {
  Reset(q);
  P_ = P;
  estimate_.payload_sigma_kg = std::sqrt(P_(kPayload, kPayload));
}

PayloadFilter::Covariance PayloadFilter::CovarianceAfterRest() const noexcept {
  PayloadFilter resting = *this;
  resting.Reset(RigidJointArm::Vector::Zero());
  const Reading zero{.z = Outputs::Zero(), .good = config_.outputs};
  for (int sample = 0; sample < kRestSamples; ++sample) resting.Update(PiecewiseTorque(), zero);
  return resting.P_;
}

void PayloadFilter::ForgetAllButMotion() noexcept {
  estimate_.payload_kg = config_.payload_start_kg;
  estimate_.payload_sigma_kg = config_.payload_start_sigma_kg;
  estimate_.friction_nm = config_.friction_start_nm;
  P_.setZero();
  for (int i = 0; i < kMotion; ++i) {
    P_(i, i) = Square(config_.start_sigma[static_cast<std::size_t>(i)]);
  }
  P_(kPayload, kPayload) = Square(config_.payload_start_sigma_kg);
  for (int i = 0; i < 2; ++i) {
    P_(kFriction + i, kFriction + i) =
        Square(config_.friction_start_sigma_nm[static_cast<std::size_t>(i)]);
  }
}

void PayloadFilter::SwitchTo(const Hypothesis& hypothesis) noexcept {
  Add(hypothesis.apart);
  ForgetAllButMotion();
}

void PayloadFilter::BeginMove(bool same_load) noexcept {
  learns_ = true;
  if (!same_load) PayloadMayChange();
}

void PayloadFilter::PayloadMayChange() noexcept {
  estimate_.payload_kg = std::max(estimate_.payload_kg, config_.payload_start_kg);
  P_(kPayload, kPayload) = std::max(P_(kPayload, kPayload), Square(config_.payload_move_sigma_kg));
  estimate_.payload_sigma_kg = std::sqrt(P_(kPayload, kPayload));
}

void PayloadFilter::AssumePayloadLost(std::span<Hypothesis> hypotheses) noexcept {
  if (!learns_) return;
  for (Hypothesis& hypothesis : hypotheses) hypothesis.apart[kPayload] = 0.0;
  P_.row(kPayload).setZero();
  P_.col(kPayload).setZero();
  estimate_.payload_kg = 0.0;
  estimate_.payload_sigma_kg = kDroppedPayload * config_.payload_max_kg;
  P_(kPayload, kPayload) = Square(estimate_.payload_sigma_kg);
  for (int hub = 0; hub < 2; ++hub) {
    P_(hub, hub) += Square(kDroppedAngle_rad);
    P_(RigidJointArm::kDof + hub, RigidJointArm::kDof + hub) += Square(kDroppedRate_rad_s);
  }
  mean_nis_ = kOutputs;
}

const PayloadFilter::Estimate& PayloadFilter::Update(const PiecewiseTorque& torque,
                                                     const Reading& reading,
                                                     std::span<Hypothesis> hypotheses) noexcept {
  Predict(torque, hypotheses);
  estimate_.nis = 0.0;
  estimate_.innovation.setZero();
  const std::uint32_t good = reading.good & config_.outputs;
  if (good != 0) CorrectByOutputs(torque, reading.z, good, hypotheses);
  estimate_.tip_innovation_m_s2 = 0.0;
  if (reading.tip_m_s2) CorrectByTip(*reading.tip_m_s2, torque, hypotheses);
  estimate_.payload_sigma_kg = std::sqrt(P_(kPayload, kPayload));
  return estimate_;
}

// Torsion of the joints by the torque at the end of the sample, rad.
Eigen::Vector2d PayloadFilter::Torsion(const PiecewiseTorque& torque) const noexcept {
  const std::array<double, 2> torque_nm = torque.last_nm();
  return {torque_nm[0] / config_.joint_stiffness_nm_per_rad[0],
          torque_nm[1] / config_.joint_stiffness_nm_per_rad[1]};
}

GaugedState PayloadFilter::After(const PiecewiseTorque& torque) const noexcept {
  return MotionAfter(stepper_, Start(), torque);
}

MotionStart PayloadFilter::Start() const noexcept {
  return {.state = estimate_.state,
          .payload_kg = estimate_.payload_kg,
          .friction_nm = estimate_.friction_nm};
}

void PayloadFilter::Predict(const PiecewiseTorque& torque,
                            std::span<Hypothesis> hypotheses) noexcept {
  const GaugedState start = estimate_.state;
  const auto [end, by_parameter] =
      MotionAfterWithSlopes(stepper_, Start(), torque, kPayloadProbe_kg, config_.friction_probe_nm);
  const Transition transition =
      TransitionOver(stepper_, estimate_.payload_kg, 0.5 * (start.q + end.q),
                     0.5 * (start.v + end.v), (end.v - start.v) / stepper_.period_s());
  PayloadCovariance::Change change;
  change.by_driving << transition.by_motion, by_parameter;
  change.gauge_kept = transition.gauge_kept;
  estimate_.state = end;
  PropagateCovariance(change, transition);

  const std::array<double, 2> mean_nm = torque.mean_nm();
  for (Hypothesis& hypothesis : hypotheses) {
    const std::array<double, 2> other_nm = hypothesis.torque.mean_nm();
    const Eigen::Vector2d more(other_nm[0] - mean_nm[0], other_nm[1] - mean_nm[1]);
    hypothesis.apart = change.Of(hypothesis.apart);
    hypothesis.apart.head<kMotion>() += transition.G.leftCols<2>().lazyProduct(more);
  }
}

void PayloadFilter::PropagateCovariance(const PayloadCovariance::Change& change,
                                        const Transition& transition) noexcept {
  const double s = std::clamp(mean_nis_ / kOutputs, 1.0, kMostFading), root = std::sqrt(s);
  Eigen::Matrix<double, kMotion, RigidJointArm::kDof> N = transition.G;
  for (int i = 0; i < RigidJointArm::kDof; ++i) {
    N.col(i) *= root * config_.process_force[static_cast<std::size_t>(i)];
  }
  PayloadCovariance::Propagate(change, N, &P_);
  P_.diagonal().head<kMotion>().array() += kNoiseFloor;
  P_(kPayload, kPayload) += Square(config_.payload_walk_kg * s);
  for (int i = 0; i < 2; ++i) {
    if (std::fabs(estimate_.state.v[i]) <= config_.friction_min_rate_rad_s) continue;
    P_(kFriction + i, kFriction + i) +=
        Square(config_.friction_walk_nm[static_cast<std::size_t>(i)]);
  }
}

void PayloadFilter::CorrectByOutputs(const PiecewiseTorque& torque, const Outputs& z,
                                     std::uint32_t good,
                                     std::span<Hypothesis> hypotheses) noexcept {
  const Eigen::Vector2d torsion = Torsion(torque);
  Outputs y = z;
  y.segment<2>(2) -= torsion;
  const MotionVector x = Stacked(estimate_.state);
  Outputs e;
  PayloadCovariance::ByOutput<kOutputs> V;  // P H'
  for (int i = 0; i < kOutputs; ++i) {
    const Row& row = row_[static_cast<std::size_t>(i)];
    e[i] = (good >> i & 1u) == 0 ? 0.0 : y[i] - (x[row.state] + row.share * x[row.second]);
    if (i < 4) e[i] = BeyondBand(e[i], config_.count_dead_band_rad[static_cast<std::size_t>(i)]);
    V.col(i) = P_.col(row.state) + row.share * P_.col(row.second);
  }
  Eigen::Matrix<double, kOutputs, kOutputs> S;
  for (int i = 0; i < kOutputs; ++i) {
    const Row& row = row_[static_cast<std::size_t>(i)];
    S.row(i) = V.row(row.state) + row.share * V.row(row.second);
  }
  Outputs R = OutputVariance(y, e, S.diagonal(), good);
  for (int i = 0; i < kOutputs; ++i) {
    if ((good >> i & 1u) == 0) R[i] = kUnreadVariance;
  }
  S.diagonal() += R;
  const SmallCholesky<kOutputs> S_factor(S);
  const auto whitened = [&S_factor](Outputs innovation) {
    S_factor.SolveLower(&innovation);
    return innovation;
  };
  const Outputs w = whitened(e);
  estimate_.nis = nis_scale_ * w.squaredNorm();
  estimate_.innovation = e;
  mean_nis_ = kNisMemory * mean_nis_ + (1.0 - kNisMemory) * std::min(estimate_.nis, kNisBound);

  const int frozen = Frozen();
  // V <- P H' L'^-1: the gain times L.
  for (int i = 0; i < kOutputs; ++i) {
    for (int j = 0; j < i; ++j) V.col(i) -= S_factor.L()(i, j) * V.col(j);
    V.col(i) /= S_factor.L()(i, i);
  }
  for (Hypothesis& hypothesis : hypotheses) {
    const Eigen::Vector2d more = Torsion(hypothesis.torque) - torsion;
    hypothesis.innovation = e;
    for (int i = 0; i < kOutputs; ++i) {
      if ((good >> i & 1u) == 0) continue;
      const Row& row = row_[static_cast<std::size_t>(i)];
      hypothesis.innovation[i] -=
          hypothesis.apart[row.state] + row.share * hypothesis.apart[row.second];
      if (i == 2 || i == 3) hypothesis.innovation[i] -= more[i - 2];
    }
    const Outputs rival = whitened(hypothesis.innovation);
    hypothesis.nis = nis_scale_ * rival.squaredNorm();
    hypothesis.apart += Learned(V.lazyProduct(rival - w), frozen);
  }
  Add(Learned(V.lazyProduct(w), frozen));
  PayloadCovariance::Reduce(V, frozen, &P_);
  P_(kPayload, kPayload) = std::min(P_(kPayload, kPayload), Square(config_.payload_max_sigma_kg));
}

// Of the readings; `spread` is that of the predicted outputs.
PayloadFilter::Outputs PayloadFilter::OutputVariance(const Outputs& y, const Outputs& innovation,
                                                     const Outputs& spread,
                                                     std::uint32_t good) noexcept {
  Outputs R;
  for (int i = 0; i < kOutputs; ++i) {
    R[i] = Square(config_.output_sigma[static_cast<std::size_t>(i)]);
  }
  const double apart_rad = (good & kElbowOutputs) == kElbowOutputs ? std::fabs(y[3] - y[1]) : 0.0;
  play_rad_ = std::max(apart_rad, config_.play_memory * play_rad_);
  if (play_rad_ > config_.play_threshold_rad) R[3] = std::max(R[3], Square(play_rad_));

  Outputs sigmas;
  int beyond = 0;
  for (int i = 0; i < kOutputs; ++i) {
    sigmas[i] = std::fabs(innovation[i]) / std::sqrt(spread[i] + R[i]);
    if (sigmas[i] > config_.gate_sigmas) ++beyond;
  }
  if (beyond > kMostGlitches) return R;
  for (int i = 0; i < kOutputs; ++i) {
    if (sigmas[i] > config_.gate_sigmas) R[i] *= Loosening(sigmas[i], config_.gate_sigmas);
  }
  return R;
}

void PayloadFilter::CorrectByTip(double reading_m_s2, const PiecewiseTorque& torque,
                                 std::span<Hypothesis> hypotheses) noexcept {
  const std::array<double, 2> torque_nm = torque.last_nm();
  const TipOutput shown = TipOutputAt(stepper_, config_.tip_lag_s, estimate_.state,
                                      {.torque_nm = {torque_nm[0], torque_nm[1]},
                                       .payload_kg = estimate_.payload_kg,
                                       .friction_nm = estimate_.friction_nm},
                                      config_.friction_probe_nm);
  Vector H = Vector::Zero();
  H.head<2 * RigidJointArm::kDof>() = shown.by_motion;
  H[kPayload] = shown.by_payload;
  H.segment<2>(kFriction) << shown.by_friction[0], shown.by_friction[1];

  const double e = reading_m_s2 - shown.m_s2;
  const Vector PHt = P_.lazyProduct(H);
  const double spread = H.dot(PHt);
  double R = Square(config_.tip_sigma_m_s2);
  const double sigmas = std::fabs(e) / std::sqrt(spread + R);
  if (sigmas > config_.gate_sigmas) R *= Loosening(sigmas, config_.gate_sigmas);
  const PayloadCovariance::ByOutput<1> V = PHt / std::sqrt(spread + R);
  const int frozen = Frozen();
  const Vector K = Learned(PHt / (spread + R), frozen);
  estimate_.tip_innovation_m_s2 = e;
  for (Hypothesis& hypothesis : hypotheses) {
    const std::array<double, 2> other_nm = hypothesis.torque.last_nm();
    double shown_apart = H.dot(hypothesis.apart);
    for (std::size_t i = 0; i < 2; ++i) {
      shown_apart += shown.by_torque[i] * (other_nm[i] - torque_nm[i]);
    }
    hypothesis.apart -= K * shown_apart;
  }
  Add(K * e);
  PayloadCovariance::Reduce(V, frozen, &P_);
}

bool PayloadFilter::learns_payload() const noexcept {
  const RigidJointArm::Vector& v = estimate_.state.v;
  return learns_ && (std::fabs(v[0]) >= config_.payload_min_rate_rad_s ||
                     std::fabs(v[1]) >= config_.payload_min_rate_rad_s);
}

int PayloadFilter::Frozen() const noexcept { return !learns_ ? 3 : learns_payload() ? 0 : 1; }

void PayloadFilter::Add(const Vector& dx) noexcept {
  estimate_.state.q += dx.head<6>();
  estimate_.state.v += dx.segment<6>(6);
  estimate_.state.phi_f += dx.segment<4>(12);
  estimate_.payload_kg =
      std::clamp(estimate_.payload_kg + dx[kPayload], 0.0, config_.payload_max_kg);
  for (std::size_t i = 0; i < 2; ++i) {
    estimate_.friction_nm[i] =
        std::clamp(estimate_.friction_nm[i] + dx[kFriction + static_cast<int>(i)], 0.0,
                   config_.friction_max_nm[i]);
  }
}

}  // namespace flexarm
