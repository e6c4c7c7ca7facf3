#pragma once

#include <array>
#include <cstdint>
#include <random>

#include "tools/torture/fault.h"

namespace flexarm {

/// A sampled signal with a fault: each true value in, the faulty one out.
class FaultySignal {
 public:
  struct Value {
    double value;
    bool is_valid;  ///< false: nothing came
    bool is_old;    ///< it is that of the period before, and says so
  };

  /// @param span  the signal lies in -span .. span: for garbage, and for the speed of a drift,
  ///              a tenth of it per second
  FaultySignal(FaultKind kind, double span, double period_s, std::uint64_t seed)
      : kind_(kind), span_(span), period_s_(period_s), random_(seed) {
    constexpr std::array<double, 3> kScales = {2.0, 0.5, -1.0};
    scale_ = kScales[random_() % kScales.size()];
  }

  /// A value from before the fault. @param value  as it is sent
  void See(double value) noexcept {
    before_ = {value, before_[0], before_[1]};
    held_ = value;
    lagged_ = value;
  }

  Value Next(double truth) noexcept {
    const std::array<double, 3> before = before_;
    before_ = {truth, before[0], before[1]};
    const double missing = random_() % 2 == 0 ? 1.0 : 0.0;
    switch (kind_) {
      case FaultKind::kOff:
      case FaultKind::kNotANumber:
        return {0.0, false, false};
      case FaultKind::kStuck:
        return {held_, true, false};
      case FaultKind::kGarbage:
        return {span_ * (2.0 * Fraction() - 1.0), true, false};
      case FaultKind::kWrongScale:
        return {scale_ * truth, true, false};
      case FaultKind::kSlow:
        lagged_ += (truth - lagged_) * period_s_ / (kLag_s + period_s_);
        return {lagged_, true, false};
      case FaultKind::kDelayed:
        return {before[2], true, false};
      case FaultKind::kIntermittent:
        return {truth, missing == 0.0, false};
      case FaultKind::kDrifting:
        drifted_ += kDriftShare * span_ * period_s_;
        return {truth + drifted_, true, false};
      case FaultKind::kLate:
        return {before[0], true, true};
    }
    return {truth, true, false};
  }

 private:
  static constexpr double kLag_s = 0.2;
  static constexpr double kDriftShare = 0.1;  // of the span, per second

  double Fraction() noexcept { return static_cast<double>(random_() >> 11) * 0x1p-53; }

  FaultKind kind_;
  double span_, period_s_;
  double scale_;
  std::mt19937_64 random_;
  std::array<double, 3> before_{};  // the newest first
  double held_ = 0.0, lagged_ = 0.0, drifted_ = 0.0;
};

}  // namespace flexarm
