#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "controller/types/commissioning_config.h"
#include "controller/types/records.h"
#include "estimator/calibration.h"
#include "hal/count_epochs.h"
#include "hal/sensor_config.h"

namespace flexarm {

/// Which joint angles are known. A joint's angle becomes unknown when one of its counters may have
/// lost its count, or has jumped, and known again by `zero` or `home`. With angles_at_start =
/// "absolute" it stays known: those encoders cannot lose their angle. Nothing of it is kept in the
/// calibration file: a restart of the daemon begins as angles_at_start says.
/// Not real-time. Thread: the operator's.
class AngleKnowledge {
 public:
  AngleKnowledge(AnglesAtStart at_start, const SensorConfig& sensors);

  /// The newest LoopStack::count_epochs. @returns bit i: joint i + 1 has just become unknown, again
  /// or for the first time
  std::uint8_t Follow(const CountEpochs& epochs);
  /// A step of the loop: a reading that the decoder rejected as impossible. @returns as Follow
  std::uint8_t Follow(const TickRecord& tick);

  void Know(std::size_t joint) { why_[joint].clear(); }
  bool knows(std::size_t joint) const { return why_[joint].empty(); }
  /// Bit i: the angle of joint i + 1 is not known.
  std::uint8_t unknown() const;
  /// "The angle of joint 1 is unknown, because .." with the remedy; empty if it is known.
  std::string Text(std::size_t joint) const;

  /// Lets the angles of an unknown joint begin at 0 where it stands, so that its hub and its rotor
  /// agree, whatever their counts are. Only without torque, and when hub or rotor reads further
  /// from 0 than the play of a joint at rest.
  void BeginAtZero(const TickRecord& tick, Calibration* calibration) const;

 private:
  std::uint8_t Lose(std::uint32_t counters, const char* why);

  bool absolute_;
  std::uint32_t present_;             // bit i: counter i exists
  CountEpochs epochs_{};              // the newest
  std::array<std::string, 2> why_{};  // of each joint; empty: known
};

}  // namespace flexarm
