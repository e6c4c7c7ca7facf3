#include "controller/health/run_samples.h"

namespace flexarm {
namespace {

float LateBy_s(const StepInput& input, std::int32_t offset_ns) {
  const std::int64_t late_ns = input.frame.sampled_at_ns - input.sampling_instant_ns + offset_ns;
  return static_cast<float>(static_cast<double>(late_ns) * 1e-9);
}

}  // namespace

RunSamples::RunSamples(const ControlConfig& config)
    : input_(config.sensors.strain_input),
      decoder_(config.sensors, config.loop.period_s(), config.estimator.max_joint_rate_rad_s),
      delay_(config.loop.period_ns(), false) {
  for (std::size_t i = 0; i < config.sensors.strain.size(); ++i) {
    scale_.push_back(StrainScaleOf(config.sensors, i));
  }
}

std::optional<HealthSample> RunSamples::Take(const StepInput& input, const StepOutput& output) {
  if (ended_) return std::nullopt;
  if (input.reset != 0) {
    decoder_.Reset(input.counts_before, input.calibration.counter_zero);
    delay_.Reset();
  }
  HealthSample sample = Decoded(input);
  delay_.TakeReport(input);
  sample.applied = delay_.Applied(input, 0);
  delay_.Push(input, output.torque_nm);

  const bool runs = input.safety_state == SafetyState::kRunning && input.mode == LoopMode::kFollow;
  if (started_) {
    ended_ = !runs;
    gaps_ = gaps_ || (runs && input.tick != last_tick_ + 1);
  }
  started_ = started_ || runs;
  load_changes_ = load_changes_ || (runs && input.load_changes != 0);
  last_tick_ = input.tick;
  return runs ? std::optional(sample) : std::nullopt;
}

HealthSample RunSamples::Decoded(const StepInput& input) {
  HealthSample sample{};
  const DecodedCounters counters = decoder_.Decode(input.frame);
  sample.angle_rad = counters.angle_rad;
  sample.angles = counters.good;
  for (std::size_t i = 0; i < kCounters; ++i) {
    sample.angle_late_s[i] = LateBy_s(input, input.frame.counter_offset_ns[i]);
  }
  for (std::size_t i = 0; i < scale_.size(); ++i) {
    const std::int32_t counts = input.frame.strain[i];
    const bool good = (input.frame.strain_valid >> i & 1U) != 0 && counts > input_.lowest_count() &&
                      counts < input_.highest_count();
    if (!good) continue;
    sample.strains |= std::uint32_t{1} << i;
    sample.strain[i] =
        static_cast<float>(StrainOf(Calibrated(scale_[i], input.calibration, i), counts));
    sample.strain_late_s[i] = LateBy_s(input, input.frame.strain_offset_ns[i]);
  }
  return sample;
}

}  // namespace flexarm
