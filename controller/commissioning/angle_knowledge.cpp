#include "controller/commissioning/angle_knowledge.h"

#include <cmath>

#include "controller/types/safety_state.h"
#include "controller/types/trip_cause.h"

namespace flexarm {
namespace {

constexpr double kReadsElsewhereRad = 0.035;  // more than the play of a joint at rest

constexpr std::uint32_t CountersOf(std::size_t joint) noexcept { return 0b101U << joint; }

}  // namespace

AngleKnowledge::AngleKnowledge(AnglesAtStart at_start, const SensorConfig& sensors)
    : absolute_(at_start == AnglesAtStart::kAbsolute), present_(sensors.counters_present()) {
  if (at_start == AnglesAtStart::kLost) why_.fill("it has not been set since the daemon started");
}

std::uint8_t AngleKnowledge::Lose(std::uint32_t counters, const char* why) {
  std::uint8_t lost = 0;
  for (std::size_t joint = 0; joint < why_.size(); ++joint) {
    if (absolute_ || (counters & present_ & CountersOf(joint)) == 0) continue;
    why_[joint] = why;
    lost |= static_cast<std::uint8_t>(1U << joint);
  }
  return lost;
}

std::uint8_t AngleKnowledge::Follow(const CountEpochs& epochs) {
  std::uint32_t changed = 0;
  for (std::size_t i = 0; i < epochs.size(); ++i) {
    if (epochs[i] != epochs_[i]) changed |= 1U << i;
  }
  epochs_ = epochs;
  return Lose(changed,
              "its encoder lost power or was configured again, or the joint moved while it was "
              "not read");
}

std::uint8_t AngleKnowledge::Follow(const TickRecord& tick) {
  // A reading that is only late is not used either, and loses no count.
  if ((tick.output.faults & CauseBit(TripCause::kEncoderJump)) == 0) return 0;
  const std::uint32_t rejected = tick.input.frame.counter_valid & ~tick.output.counters_used;
  return Lose(rejected, "its encoder jumped");
}

std::uint8_t AngleKnowledge::unknown() const {
  return static_cast<std::uint8_t>((knows(0) ? 0U : 1U) | (knows(1) ? 0U : 2U));
}

std::string AngleKnowledge::Text(std::size_t joint) const {
  if (knows(joint)) return {};
  return "The angle of joint " + std::to_string(joint + 1) + " is unknown: " + why_[joint] +
         ". Run `flexarm zero` or `flexarm home` first.";
}

void AngleKnowledge::BeginAtZero(const TickRecord& tick, Calibration* calibration) const {
  if (TorqueAllowed(tick.input.safety_state)) return;
  for (std::size_t joint = 0; joint < why_.size(); ++joint) {
    const std::uint32_t counters = CountersOf(joint) & present_;
    const bool read = (tick.output.counters_used & counters) == counters;
    const bool elsewhere = std::fabs(tick.output.angle_rad[joint]) > kReadsElsewhereRad ||
                           std::fabs(tick.output.angle_rad[joint + 2]) > kReadsElsewhereRad;
    if (knows(joint) || !read || !elsewhere) continue;
    for (const std::size_t i : {joint, joint + 2}) {
      calibration->counter_zero[i] = tick.output.counts[i];
    }
  }
}

}  // namespace flexarm
