#include "tests/bench/step_scenario.h"

#include <algorithm>
#include <limits>
#include <random>

#include "config/config.h"
#include "controller/design/run_design.h"
#include "tests/bench/counted.h"

namespace flexarm {

namespace {

constexpr std::size_t kSettles = 12;  // undisturbed samples after the reset

// Numbers of the disturbances.
enum : unsigned {
  kCountersMissing,
  kStrainMissing,
  kOutliers,
  kRepeats,
  kOutOfRange,
  kSkew,
  kOld,
  kLate,
  kReset,
  kMode,
  kState,
  kAnyCounts,
  kPlanAndLoad,
  kReferenceRests,
  kAnyTorque,
};

void DisturbReadings(const Words& words, const StepInput& before, std::int64_t period_ns,
                     SensorFrame* frame) {
  if (Happens(words, kCountersMissing)) frame->counter_valid &= words[2];
  if (Happens(words, kStrainMissing)) frame->strain_valid &= words[3];
  for (std::size_t i = 0; i < frame->strain.size(); ++i) {
    if ((words[4] >> i & 1u) == 0) continue;
    // A few thousand counts are several times the limits of the fit.
    const auto apart = static_cast<std::int32_t>(words[5] % 4000) - 2000;
    if (Happens(words, kOutliers)) frame->strain[i] += apart;
    if (Happens(words, kRepeats)) frame->strain[i] = before.frame.strain[i];
    if (Happens(words, kOutOfRange)) frame->strain[i] = std::numeric_limits<std::int32_t>::max();
  }
  if (Happens(words, kSkew)) {
    for (std::size_t i = 0; i < frame->strain_offset_ns.size(); ++i) {
      frame->strain_offset_ns[i] =
          static_cast<std::int32_t>(words[5] % (period_ns / 64) * static_cast<std::int64_t>(i));
    }
  }
  if (Happens(words, kOld)) frame->sampled_at_ns -= words[6] % (2 * period_ns);
  if (Happens(words, kAnyCounts)) {
    std::minstd_rand any(words[2]);
    for (std::uint32_t& counter : frame->counter) counter = static_cast<std::uint32_t>(any());
  }
}

// As ControlTask gathers them: a torque acts at most a period later than it should.
void Disturb(const Words& words, const StepInput& before, std::int64_t period_ns,
             StepInput* input) {
  DisturbReadings(words, before, period_ns, &input->frame);
  if (Happens(words, kLate)) {
    input->acted_late_ns += words[6] % period_ns;
    input->acts_late_ns = input->acted_late_ns;
  }
  if (Happens(words, kReset)) input->reset = 1;
  if (Happens(words, kMode)) input->mode = static_cast<LoopMode>(words[7] % 3);
  if (Happens(words, kState)) {
    input->safety_state = static_cast<SafetyState>(words[7] / 3 % kSafetyStates);
  }
  if (Happens(words, kPlanAndLoad)) {
    input->planned = words[7] >> 28 & 1u;
    input->same_load = words[7] >> 29 & 1u;
    input->load_changes = words[7] >> 30 & 1u;
  }
  if (Happens(words, kReferenceRests)) {
    input->reference_next.u_m_nm = {};
    std::fill(input->reference_next.x_m.begin() + 2, input->reference_next.x_m.end(), 0.0);
    input->path[1].rate_rad_s = input->path[1].acceleration_rad_s2 = {};
    input->reference_ended = words[7] >> 31 & 1u;
  }
  if (Happens(words, kAnyTorque)) {
    input->applied_torque_nm = {static_cast<double>(words[6] % 61) - 30.0,
                                static_cast<double>(words[5] % 13) - 6.0};
  }
}

}  // namespace

StepScenario::StepScenario(const StepVariant& variant, const std::vector<StepInput>& inputs,
                           InstructionCounter& counter)
    : name_(NameOf(variant)), inputs_(&inputs), counter_(&counter) {
  const RigConfig config = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml", variant.overrides);
  step_ = std::make_unique<ControlStep>(config, DesignFor(config));
  period_ns_ = config.loop.period_ns();
}

std::int64_t StepScenario::Median() {
  std::vector<std::int64_t> counts;
  for (const StepInput& input : *inputs_) {
    Counted([&] { step_->Step(input); });
    counts.push_back(counter_->Last());
  }
  std::nth_element(counts.begin(), counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2),
                   counts.end());
  return counts[counts.size() / 2];
}

std::int64_t StepScenario::Cost(const Candidate& candidate) {
  const std::size_t first = candidate[0] % (inputs_->size() - kSettles - kDisturbances);
  StepInput before = (*inputs_)[first];
  before.reset = 1;
  step_->Step(before);
  for (std::size_t i = 1; i < kSettles; ++i) step_->Step((*inputs_)[first + i]);
  std::int64_t most = 0;
  for (std::size_t i = 0; i < kDisturbances; ++i) {
    StepInput input = (*inputs_)[first + kSettles + i];
    Disturb(WordsOf(candidate, i), before, period_ns_, &input);
    Counted([&] { step_->Step(input); });
    most = std::max(most, counter_->Last());
    before = input;
  }
  return most;
}

}  // namespace flexarm
