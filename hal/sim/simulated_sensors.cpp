#include "hal/sim/simulated_sensors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flexarm {

SimulatedSensors::SimulatedSensors(const ArmModel& arm, const SensorConfig& sensors,
                                   std::uint64_t seed, const ArmVector& start)
    : input_(sensors.strain_input), random_(seed) {
  for (const EncoderConfig& encoder : sensors.encoder) {
    const double counts_per_rad = encoder.sign * encoder.counts_per_turn / (2.0 * std::numbers::pi);
    const auto counter = static_cast<std::size_t>(encoder.counter);
    encoder_.push_back(
        {.counter = counter,
         .counts_per_rad = counts_per_rad,
         .start = std::llround(start(static_cast<Eigen::Index>(counter)) * counts_per_rad),
         .modulus = std::int64_t{1} << encoder.counter_bits});
  }
  for (const StrainChannelConfig& row : sensors.strain) {
    const double counts_per_unit = row.face * row.gain_v_per_unit / input_.volts_per_count();
    const int first = row.link == 1 ? 0 : arm.mode_count().link1;
    const int count = row.link == 1 ? arm.mode_count().link1 : arm.mode_count().link2;
    Gauge gauge{.offset_counts = row.offset_counts, .first = first, .counts_per_metre = {}};
    for (int mode = 0; mode < count; ++mode) {
      Eigen::VectorXd unit = Eigen::VectorXd::Zero(arm.dof());
      unit(kPhi1 + first + mode) = 1.0;
      gauge.counts_per_metre.push_back(counts_per_unit *
                                       arm.Strain(row.link, row.position_m, unit));
    }
    gauge_.push_back(std::move(gauge));
  }
}

SensorFrame SimulatedSensors::Sample(std::int64_t now_ns, const ArmVector& q,
                                     const ArmVector& filtered, LineLevels levels) noexcept {
  SensorFrame frame = SampleCounters(now_ns, q, levels);
  for (std::size_t i = 0; i < gauge_.size(); ++i) SampleStrain(i, 0, filtered, &frame);
  return frame;
}

SensorFrame SimulatedSensors::SampleCounters(std::int64_t now_ns, const ArmVector& q,
                                             LineLevels levels) const noexcept {
  SensorFrame frame{};
  frame.sampled_at_ns = now_ns;
  frame.levels = levels;
  for (const Encoder& encoder : encoder_) {
    const double angle = q(static_cast<Eigen::Index>(encoder.counter));
    std::int64_t counts =
        (std::llround(angle * encoder.counts_per_rad) - encoder.start) % encoder.modulus;
    if (counts < 0) counts += encoder.modulus;
    frame.counter[encoder.counter] = static_cast<std::uint32_t>(counts);
    frame.counter_valid |= std::uint32_t{1} << encoder.counter;
  }
  return frame;
}

void SimulatedSensors::SampleStrain(std::size_t i, std::int32_t offset_ns,
                                    const ArmVector& filtered, SensorFrame* frame) noexcept {
  const Gauge& gauge = gauge_[i];
  double counts = gauge.offset_counts;
  for (std::size_t mode = 0; mode < gauge.counts_per_metre.size(); ++mode) {
    counts +=
        gauge.counts_per_metre[mode] * filtered(gauge.first + static_cast<Eigen::Index>(mode));
  }
  counts += input_.noise_counts * noise_(random_);
  const double railed = std::clamp(counts, static_cast<double>(input_.lowest_count()),
                                   static_cast<double>(input_.highest_count()));
  frame->strain[i] = static_cast<std::int32_t>(std::lround(railed));
  frame->strain_offset_ns[i] = offset_ns;
  frame->strain_valid |= std::uint32_t{1} << i;
}

}  // namespace flexarm
