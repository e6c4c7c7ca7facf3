#include "estimator/payload_covariance.h"

#include "model/math/column_sum.h"
#include "model/math/mirror_lower_half.h"
#include "model/math/wide_instructions.h"

namespace flexarm {
namespace {

constexpr int kRows = PayloadCovariance::kMotion;
constexpr int kGauges = 4, kGauge = kRows - kGauges;  // phi_f, the last of the motion
constexpr int kDriving = PayloadCovariance::Change::kDriving;
constexpr int kForces = RigidJointArm::kDof;

// Columns that are computed together. Their entries above the diagonal are computed as well.
constexpr int kBlock = 4;

// Index among all states.
constexpr int StateOf(int driving) noexcept {
  return driving < kGauge ? driving : driving + kGauges;
}

// Factors of F P F' + N N': the sum of left column k times entry j of right column k is column j.
struct Factors {
  static constexpr int kColumns = kDriving + kForces;
  Eigen::Matrix<double, kRows, kColumns> left, right;
  Eigen::Matrix<double, kRows, kGauges> gauges;  // F P of phi_f, times its share
};

// Columns from kFirst on, rows from kFirst on.
template <int kFirst>
void WriteColumns(const Factors& factors, PayloadCovariance::Matrix* P) noexcept {
  for (int column = kFirst; column < kFirst + kBlock; ++column) {
    ColumnSum<kRows - kFirst> sum;
    for (int k = 0; k < Factors::kColumns; ++k) {
      sum.Add(factors.right(column, k), &factors.left(kFirst, k));
    }
    if constexpr (kFirst == kGauge) sum.Add(1.0, &factors.gauges(kFirst, column - kGauge));
    sum.WriteTo(&(*P)(kFirst, column));
  }
}

template <int kFirst, int kOutputs>
void ReduceColumns(const PayloadCovariance::ByOutput<kOutputs>& V,
                   PayloadCovariance::Matrix* P) noexcept {
  for (int column = kFirst; column < kFirst + kBlock; ++column) {
    ColumnSum<PayloadCovariance::kPadded - kFirst> sum(&(*P)(kFirst, column));
    for (int k = 0; k < kOutputs; ++k) sum.Add(-V(column, k), &V(kFirst, k));
    sum.WriteTo(&(*P)(kFirst, column));
  }
}

template <int kOutputs>
void ReduceBy(const PayloadCovariance::ByOutput<kOutputs>& V, int frozen,
              PayloadCovariance::Matrix* P) noexcept {
  constexpr int kFirst = PayloadCovariance::kPayload;
  const Eigen::Matrix3d kept = P->block<3, 3>(kFirst, kFirst);
  ReduceColumns<0>(V, P);
  ReduceColumns<4>(V, P);
  ReduceColumns<8>(V, P);
  ReduceColumns<12>(V, P);
  ReduceColumns<16>(V, P);
  if (frozen == 1) (*P)(kFirst, kFirst) = kept(0, 0);
  if (frozen == 3) P->block<3, 3>(kFirst, kFirst) = kept;
  MirrorLowerHalf<PayloadCovariance::kPadded>(PayloadCovariance::kPadded, P->data());
}

}  // namespace

PayloadCovariance::Vector PayloadCovariance::Change::Of(const Vector& dx) const noexcept {
  Vector out = dx;
  ColumnSum<kMotion> sum;
  for (int k = 0; k < kDriving; ++k) sum.Add(dx[StateOf(k)], &by_driving(0, k));
  sum.WriteTo(out.data());
  out.segment<kGauges>(kGauge) += gauge_kept * dx.segment<kGauges>(kGauge);
  return out;
}

FLEXARM_WIDE_INSTRUCTIONS
void PayloadCovariance::Propagate(const Change& change,
                                  const Eigen::Matrix<double, kMotion, RigidJointArm::kDof>& N,
                                  Matrix* P) noexcept {
  // F P, a column for each state.
  const auto column_of = [&](int state, double* column) {
    ColumnSum<kMotion> sum;
    for (int k = 0; k < kDriving; ++k) sum.Add((*P)(StateOf(k), state), &change.by_driving(0, k));
    sum.WriteTo(column);
    for (int i = kGauge; i < kMotion; ++i) column[i] += change.gauge_kept * (*P)(i, state);
  };
  Factors factors;
  for (int k = 0; k < kDriving; ++k) column_of(StateOf(k), &factors.left(0, k));
  for (int i = 0; i < kGauges; ++i) column_of(kGauge + i, &factors.gauges(0, i));
  factors.gauges *= change.gauge_kept;
  factors.right.leftCols<kDriving>() = change.by_driving;
  factors.left.rightCols<kForces>() = N;
  factors.right.rightCols<kForces>() = N;

  WriteColumns<0>(factors, P);
  WriteColumns<4>(factors, P);
  WriteColumns<8>(factors, P);
  WriteColumns<12>(factors, P);
  for (int k = kGauge; k < kDriving; ++k) {
    P->block<1, kMotion>(StateOf(k), 0) = factors.left.col(k).transpose();
  }
  MirrorLowerHalf<kPadded>(kMotion, P->data());
}

FLEXARM_WIDE_INSTRUCTIONS
void PayloadCovariance::Reduce(const ByOutput<8>& V, int frozen, Matrix* P) noexcept {
  ReduceBy(V, frozen, P);
}

FLEXARM_WIDE_INSTRUCTIONS
void PayloadCovariance::Reduce(const ByOutput<1>& V, int frozen, Matrix* P) noexcept {
  ReduceBy(V, frozen, P);
}

}  // namespace flexarm
