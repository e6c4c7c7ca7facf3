#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "controller/types/frame_packet.h"
#include "controller/types/rig_config.h"
#include "estimator/strain_fit.h"
#include "tools/torture/fault.h"
#include "tools/torture/faulty_signal.h"

namespace flexarm {

/// Spoils the readings of frames on their way from the sensors to the loop.
class FaultyFrames {
 public:
  FaultyFrames(const RigConfig& config, const std::vector<Fault>& faults);

  /// The next frame. Also keeps since when its readings are visibly wrong.
  SensorFrame Next(const SensorFrame& sampled, std::int64_t sampled_ns);

  /// Instant of the first of kSeenFrames frames in a row of which a reading is off by more than the
  /// thresholds of the loop's checks, or missing. Of a hub encoder that no other encoder checks:
  /// instant of the first frame that jumps by more, or that stands still while the hub turns, and
  /// of no later one. INT64_MAX: there is none so far.
  std::int64_t seen_ns() const { return seen_ns_; }

  /// Frames in a row that make a fault observable: the checks of the loop need two, and one more.
  static constexpr int kSeenFrames = 3;

 private:
  /// One reading with its fault.
  struct Channel {
    const Fault* fault;
    bool is_gauge;
    std::size_t row;  ///< in the frame
    FaultySignal signal;
    double seen_counts;  ///< a reading that is off by more is visibly wrong
    // Of a counter that no other one checks: the only frames that show its fault.
    bool is_alone = false;
    double jump_counts = 0.0;    ///< more off than in the frame before by more than this
    double stands_counts = 0.0;  ///< turned by more than this, before it stands still and then
    double modulus;              ///< of a counter
    std::int64_t turns;          ///< of a counter: its value without wrapping, before this sample
    std::uint32_t last;          ///< of a counter: as read
    double moved = 0.0;          ///< of a counter: in the last frame, if the one before came too
    double apart = 0.0;          ///< of a counter: how far off it was in the last frame
  };

  void AddGauge(const RigConfig& config, const Fault& fault, std::size_t row);
  void AddCounter(const RigConfig& config, const Fault& fault, const EncoderConfig& encoder);
  /// How a frame shows a fault.
  enum class Sign : std::uint8_t { kNone, kIfItStays, kAtOnce };
  Sign Spoil(Channel* channel, std::int64_t sampled_ns, const SensorFrame& sampled,
             SensorFrame* frame);

  std::optional<StrainFit> fit_;  // if a gauge is spoilt: its construction solves for the modes
  int lowest_count_, highest_count_;
  std::vector<Channel> channels_;
  std::int64_t period_ns_;
  int wrong_in_a_row_ = 0;
  std::int64_t wrong_since_ns_ = 0;
  std::int64_t seen_ns_ = INT64_MAX;
};

}  // namespace flexarm
