#pragma once

#include <array>
#include <optional>

#include "estimator/counter_decoder.h"
#include "estimator/delay_detector.h"
#include "estimator/payload_knowledge.h"
#include "estimator/piecewise_torque.h"
#include "estimator/state_estimate.h"
#include "estimator/strain_fit.h"

namespace flexarm {

/// Inputs of an observer for one sample.
struct Measurement {
  const DecodedCounters* counters;
  const FittedModes* modes;
  const PiecewiseTorque* applied;  ///< over the period before it, with the estimated delay
  const TorqueByDelay*
      applied_by_delay;            ///< the same by hypothesis; null unless wants_torque_by_delay()
  std::optional<double> tip_m_s2;  ///< of the accelerometer at the tip, if it has a reading
};

/// Motion of the reference at the sample.
struct PathMotion {
  bool begins;  ///< a move begins
  bool moves;
  double
      rested_s;    ///< time since the end of the last move; infinite before the first, 0 during one
  bool same_load;  ///< the payload is that of the move before
  bool load_changes;  ///< the payload changes now
};

/// A state observer: measurements in, the state of the arm out, and its open-loop prediction.
///
/// One object per estimator of the config (estimator.name). Real-time: all but construction is
/// safe. Thread: the one that runs ControlStep::Step.
class Observer {
 public:
  virtual ~Observer() = default;

  /// Starts a new run: clears all states.
  virtual void Reset() noexcept = 0;
  /// The state was not finite, or the arm was not measured: the next Update starts from its
  /// measurement.
  virtual void Restart() noexcept = 0;

  /// Predicted rates of the modal coordinates as the gauges read them, behind their filters, at the
  /// next Update's sample, m/s: f11 f12 f21 f22.
  virtual std::array<double, 4> ModalRates(const PiecewiseTorque& applied) noexcept = 0;

  /// To be called before Update, every sample on which the law follows a path.
  virtual void FollowPath(const PathMotion& /*motion*/) noexcept {}
  /// To be called before Update, every sample on which the law follows a reference.
  virtual void FollowReference(bool /*rests*/) noexcept {}
  virtual StateEstimate Update(const Measurement& measurement) noexcept = 0;

  /// Delay compensation: predicts the state under the torques that do not act yet.
  virtual StateVector Predict(const StateVector& x,
                              const PiecewiseTorque& pending) const noexcept = 0;

  /// True if Update uses Measurement::applied_by_delay.
  virtual bool wants_torque_by_delay() const noexcept { return false; }
  /// Estimated delay of the torques beyond the declared one, in samples.
  virtual int delay_found() const noexcept { return 0; }
  /// NaN and no warnings for an observer that does not estimate the payload.
  virtual PayloadKnowledge payload() const noexcept { return kNoPayloadEstimate; }
  /// Share of the terms that bring the arm to rest, from 0 to 1: settling_observer.h.
  virtual double settling_share() const noexcept { return 0.0; }
};

}  // namespace flexarm
