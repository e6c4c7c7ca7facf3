#include "controller/types/frame_packet.h"

namespace flexarm {
namespace {

// Frames further apart than this are not merged; an offset can represent more.
constexpr std::int64_t kJoinableNs = 1'000'000'000;

template <typename Raw, std::size_t N>
void JoinReadings(const std::array<Raw, N>& value, const std::array<std::int32_t, N>& offset_ns,
                  std::uint32_t valid, std::int32_t shift_ns, std::array<Raw, N>* out_value,
                  std::array<std::int32_t, N>* out_offset_ns, std::uint32_t* out_valid) noexcept {
  for (std::size_t i = 0; i < N; ++i) {
    if ((valid >> i & 1u) == 0) continue;
    (*out_value)[i] = value[i];
    (*out_offset_ns)[i] = offset_ns[i] + shift_ns;
  }
  *out_valid |= valid;
}

}  // namespace

void Join(const FramePacket& part, FramePacket* packet) noexcept {
  SensorFrame& frame = packet->frame;
  for (std::size_t i = 0; i < 2; ++i) packet->applied_torque_nm[i] += part.applied_torque_nm[i];
  if (part.output_tick > packet->output_tick ||
      (part.output_tick == packet->output_tick && part.acted_ns > packet->acted_ns)) {
    packet->output_tick = part.output_tick;
    packet->acted_ns = part.acted_ns;
  }
  packet->gate_reasons |= part.gate_reasons;
  const std::int64_t apart_ns = part.frame.sampled_at_ns - frame.sampled_at_ns;
  if (apart_ns > kJoinableNs) frame = part.frame;  // the other bus has been silent for too long
  if (apart_ns > kJoinableNs || apart_ns < -kJoinableNs) return;
  const auto shift_ns = static_cast<std::int32_t>(apart_ns);
  JoinReadings(part.frame.counter, part.frame.counter_offset_ns, part.frame.counter_valid, shift_ns,
               &frame.counter, &frame.counter_offset_ns, &frame.counter_valid);
  JoinReadings(part.frame.strain, part.frame.strain_offset_ns, part.frame.strain_valid, shift_ns,
               &frame.strain, &frame.strain_offset_ns, &frame.strain_valid);
  JoinReadings(part.frame.accelerometer, part.frame.accelerometer_offset_ns,
               part.frame.accelerometer_valid, shift_ns, &frame.accelerometer,
               &frame.accelerometer_offset_ns, &frame.accelerometer_valid);
}

}  // namespace flexarm
