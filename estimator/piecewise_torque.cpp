#include "estimator/piecewise_torque.h"

namespace flexarm {

std::array<double, 2> PiecewiseTorque::mean_nm() const noexcept {
  if (size_ <= 1) return last_nm();
  double ticks = 0.0;
  std::array<double, 2> sum{};
  for (const TorquePiece& piece : all()) {
    const auto length = static_cast<double>(piece.ticks);
    ticks += length;
    for (std::size_t i = 0; i < 2; ++i) sum[i] += length * piece.torque_nm[i];
  }
  return {sum[0] / ticks, sum[1] / ticks};
}

PiecewiseTorque PiecewiseTorque::WithMean(const std::array<double, 2>& mean_nm) const noexcept {
  PiecewiseTorque out = *this;
  if (size_ == 1) out.piece_[0].torque_nm = mean_nm;
  if (size_ <= 1) return out;
  const std::array<double, 2> mean = this->mean_nm();
  for (std::size_t k = 0; k < size_; ++k) {
    for (std::size_t i = 0; i < 2; ++i) out.piece_[k].torque_nm[i] += mean_nm[i] - mean[i];
  }
  return out;
}

}  // namespace flexarm
