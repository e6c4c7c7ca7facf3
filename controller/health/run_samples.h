#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "controller/health/health_sample.h"
#include "controller/step/delay_compensation.h"
#include "controller/types/control_config.h"
#include "controller/types/step_types.h"
#include "estimator/counter_decoder.h"
#include "estimator/strain_scale.h"

namespace flexarm {

/// Takes from the records of the loop the samples of one run: those of state Running in which the
/// law follows a reference. So they are the same whether the run is read live or from its log.
class RunSamples {
 public:
  explicit RunSamples(const ControlConfig& config);

  /// The next sample of the loop, from the reset of the run on.
  std::optional<HealthSample> Take(const StepInput& input, const StepOutput& output);

  bool ended() const { return ended_; }  ///< the run is over: Take returns nothing more
  bool gaps() const { return gaps_; }    ///< a sample within the run was missing
  bool load_changes() const { return load_changes_; }  ///< another payload was announced

 private:
  HealthSample Decoded(const StepInput& input);

  StrainInputConfig input_;
  std::vector<StrainScale> scale_;  // of the config
  CounterDecoder decoder_;
  DelayCompensation delay_;
  bool started_ = false, ended_ = false, gaps_ = false, load_changes_ = false;
  std::int64_t last_tick_ = 0;
};

}  // namespace flexarm
