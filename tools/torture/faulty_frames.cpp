#include "tools/torture/faulty_frames.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/units.h"
#include "tools/torture/detection.h"

namespace flexarm {
namespace {

// A reading that is off by more is seen by the checks of the loop. A gauge: by what its studentised
// distance from the fit shows of its error, and a quarter, since bending and noise take part; twice
// the limit at least. An encoder: hub and rotor are apart by estimator.hub_rotor_limit_rad, and
// their twist and noise, 0.01 rad. A hub encoder alone: by what the model may be wrong, too.
constexpr double kNoise = 1.25;
constexpr double kLeastOfLimit = 2.0;
constexpr double kTwist_rad = 0.01;
constexpr double kModel = 1.5;

// What a driver may leave where a reading is missing: the lowest number, which nothing may use.
constexpr std::int32_t kNoCounts = INT32_MIN;

std::uint64_t SeedOf(const Fault& fault, std::size_t row) { return fault.seed + 1'000'003 * row; }

std::int64_t Apart(std::uint32_t now, std::uint32_t before, double modulus) {
  const auto size = static_cast<std::int64_t>(modulus);
  std::int64_t apart = (static_cast<std::int64_t>(now) - before) % size;
  if (apart < 0) apart += size;
  return apart >= size / 2 ? apart - size : apart;
}

std::uint32_t Wrapped(double turns, double modulus) {
  const auto size = static_cast<std::int64_t>(modulus);
  std::int64_t counts = std::llround(turns) % size;
  if (counts < 0) counts += size;
  return static_cast<std::uint32_t>(counts);
}

}  // namespace

FaultyFrames::FaultyFrames(const RigConfig& config, const std::vector<Fault>& faults)
    : lowest_count_(config.sensors.strain_input.lowest_count()),
      highest_count_(config.sensors.strain_input.highest_count()),
      period_ns_(config.loop.period_ns()) {
  for (const Fault& fault : faults) {
    const bool whole = fault.place == FaultPlace::kFrame;
    for (std::size_t row = 0; row < config.sensors.strain.size(); ++row) {
      const bool here =
          (fault.place == FaultPlace::kGauge && fault.index == static_cast<int>(row)) ||
          (fault.place == FaultPlace::kGauges &&
           fault.index + 1 == config.sensors.strain[row].link);
      if (whole || here) AddGauge(config, fault, row);
    }
    for (const EncoderConfig& encoder : config.sensors.encoder) {
      const bool here = fault.place == FaultPlace::kCounter && fault.index == encoder.counter;
      if (whole || here) AddCounter(config, fault, encoder);
    }
  }
}

void FaultyFrames::AddGauge(const RigConfig& config, const Fault& fault, std::size_t row) {
  const StrainInputConfig& input = config.sensors.strain_input;
  const double per_count =
      input.volts_per_count() / std::fabs(config.sensors.strain[row].gain_v_per_unit);
  if (!fit_) fit_.emplace(config.arm, config.sensors, config.estimator);
  const double shown = fit_->ShownOfError(row);  // 0: the reading is never seen
  channels_.push_back({.fault = &fault,
                       .is_gauge = true,
                       .row = row,
                       .signal = FaultySignal(fault.kind, highest_count_, config.loop.period_s(),
                                              SeedOf(fault, row)),
                       .seen_counts = std::max(kLeastOfLimit, kNoise / shown) *
                                      config.estimator.strain_family_limit / per_count,
                       .modulus = 0.0,
                       .turns = 0,
                       .last = 0});
}

void FaultyFrames::AddCounter(const RigConfig& config, const Fault& fault,
                              const EncoderConfig& encoder) {
  const auto row = static_cast<std::size_t>(encoder.counter);
  const double modulus = std::ldexp(1.0, encoder.counter_bits);
  const double per_rad = encoder.counts_per_turn / kTwoPi;
  const EstimatorConfig& checks = config.estimator;
  channels_.push_back(
      {.fault = &fault,
       .is_gauge = false,
       .row = row,
       .signal = FaultySignal(fault.kind, encoder.counts_per_turn / 2.0, config.loop.period_s(),
                              SeedOf(fault, 32 + row)),
       .seen_counts = (checks.hub_rotor_limit_rad + kTwist_rad) * per_rad,
       .is_alone = IsAlone(config, encoder.counter),
       .jump_counts = (kModel * checks.innovation_limit_rad + kTwist_rad) * per_rad,
       .stands_counts = kModel * checks.hub_rotor_limit_rad / checks.fault_ticks * per_rad,
       .modulus = modulus,
       .turns = 0,
       .last = 0});
}

FaultyFrames::Sign FaultyFrames::Spoil(Channel* channel, std::int64_t sampled_ns,
                                       const SensorFrame& sampled, SensorFrame* frame) {
  const std::size_t row = channel->row;
  const std::uint32_t valid = channel->is_gauge ? sampled.strain_valid : sampled.counter_valid;
  const double moved_before = std::exchange(channel->moved, 0.0);
  if ((valid >> row & 1U) == 0) return Sign::kNone;  // lost without the fault
  if (!channel->is_gauge) {
    const std::int64_t moved = Apart(sampled.counter[row], channel->last, channel->modulus);
    channel->turns += moved;
    channel->last = sampled.counter[row];
    channel->moved = std::fabs(static_cast<double>(moved));
  }
  const double truth =
      channel->is_gauge ? sampled.strain[row] : static_cast<double>(channel->turns);
  const bool active = IsActive(*channel->fault, sampled_ns);
  if (!active) {
    channel->signal.See(truth);
    channel->apart = 0.0;
    return Sign::kNone;
  }
  const FaultySignal::Value faulty = channel->signal.Next(truth);
  const auto offset_ns = static_cast<std::int32_t>(faulty.is_old ? -period_ns_ : 0);
  if (channel->is_gauge) {
    const double counts =
        std::clamp<double>(std::round(faulty.value), lowest_count_, highest_count_);
    frame->strain[row] = faulty.is_valid ? static_cast<std::int32_t>(counts) : kNoCounts;
    frame->strain_offset_ns[row] += offset_ns;
    if (!faulty.is_valid) frame->strain_valid &= ~(1U << row);
  } else {
    frame->counter[row] = Wrapped(faulty.value, channel->modulus);
    frame->counter_offset_ns[row] += offset_ns;
    if (!faulty.is_valid) frame->counter_valid &= ~(1U << row);
  }
  if (!faulty.is_valid) return Sign::kIfItStays;
  double apart = faulty.value - truth;
  if (!channel->is_gauge) apart = std::remainder(apart, channel->modulus);  // as a counter shows it
  const double apart_before = std::exchange(channel->apart, apart);
  if (!channel->is_alone) {
    return std::fabs(apart) > channel->seen_counts ? Sign::kIfItStays : Sign::kNone;
  }
  const bool jumps = std::fabs(apart - apart_before) > channel->jump_counts;
  const bool stands = channel->fault->kind == FaultKind::kStuck && apart_before == 0.0 &&
                      std::min(moved_before, channel->moved) > channel->stands_counts;
  return jumps || stands ? Sign::kAtOnce : Sign::kNone;
}

SensorFrame FaultyFrames::Next(const SensorFrame& sampled, std::int64_t sampled_ns) {
  SensorFrame frame = sampled;
  bool wrong = false;
  for (Channel& channel : channels_) {
    const Sign sign = Spoil(&channel, sampled_ns, sampled, &frame);
    wrong = wrong || sign == Sign::kIfItStays;
    if (sign == Sign::kAtOnce) seen_ns_ = std::min(seen_ns_, sampled_ns);
  }
  if (wrong_in_a_row_ == 0) wrong_since_ns_ = sampled_ns;
  wrong_in_a_row_ = wrong ? wrong_in_a_row_ + 1 : 0;
  if (wrong_in_a_row_ == kSeenFrames) seen_ns_ = std::min(seen_ns_, wrong_since_ns_);
  return frame;
}

}  // namespace flexarm
