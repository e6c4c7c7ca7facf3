#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "model/rigid_joint/motion_sample.h"

namespace flexarm {

/// Entry of a plan for one sample, an affine feedback: u = torque + K (x - x_plan).
struct PlanEntry {
  MotionSample motion;       ///< its torque is held for one period
  std::array<double, 24> K;  ///< feedback gain, 2 x 12 by columns: N m per deviation from x

  static PlanEntry Of(const MotionSample& motion, const Eigen::Matrix<double, 2, 12>& K) noexcept {
    PlanEntry entry{.motion = motion, .K = {}};
    Eigen::Matrix<double, 2, 12>::Map(entry.K.data()) = K;
    return entry;
  }
  Eigen::Matrix<double, 2, 12> Gain() const noexcept {
    return Eigen::Matrix<double, 2, 12>::Map(K.data());
  }
};

/// Planned trajectory: states, torques and feedback gains, sample by sample.
///
/// Trivially copyable, to pass it between threads; 150 kB, so keep it off the stacks.
/// Real-time: safe.
class HorizonPlan {
 public:
  static constexpr std::size_t kMaxStages = 500;  ///< 10 s at 50 Hz

  /// An empty plan, to be filled by Append.
  void Begin(std::int64_t first_tick, double payload_kg) noexcept {
    first_tick_ = first_tick;
    payload_kg_ = payload_kg;
    size_ = 0;
  }

  /// Appends the entry of the next sample; no effect if the plan is full.
  void Append(const PlanEntry& entry) noexcept {
    if (size_ < kMaxStages) entries_[size_++] = entry;
  }

  std::int64_t first_tick() const noexcept { return first_tick_; }
  std::size_t size() const noexcept { return size_; }
  double payload_kg() const noexcept {
    return payload_kg_;
  }  ///< payload of the model that it was planned with

  /// The entry of a sample; nothing before or after the plan.
  std::optional<PlanEntry> At(std::int64_t tick) const noexcept {
    if (tick < first_tick_ || tick - first_tick_ >= static_cast<std::int64_t>(size_)) return {};
    return entries_[static_cast<std::size_t>(tick - first_tick_)];
  }

 private:
  std::int64_t first_tick_ = 0;
  std::size_t size_ = 0;
  double payload_kg_ = 0.0;
  std::array<PlanEntry, kMaxStages> entries_{};
};

static_assert(std::is_trivially_copyable_v<HorizonPlan>, "passed between threads");

}  // namespace flexarm
