#pragma once

#include <array>

#include "estimator/nominal_observer.h"
#include "estimator/observer.h"
#include "estimator/payload_observer.h"
#include "model/rigid_joint/tip_sway.h"

namespace flexarm {

/// The parts of settling begin within this time.
inline constexpr double kSettlingFadesIn_s = 0.1;

/// The observer of a law that settles: the Kalman filter of the nominal model while the arm moves,
/// the filter of `ekf-payload` while it settles.
///
/// Both run all the time. The arm settles from when its reference rests and its tip swings by less
/// than a limit, until the reference moves or the tip swings by 1.5 times that limit. The state
/// changes over linearly in 0.1 s. The payload filter knows friction and payload, which matter at
/// rest; the feedback of its more faithful state in a move with a heavy payload asks for more
/// torque than the links bear (docs/theory/control-law.md 14.3). For the same reason it
/// bridges samples without any counter, with its model of the payload, for light payloads only.
/// The innovations are the Kalman filter's. Real-time: all but construction is safe.
class SettlingObserver final : public Observer {
 public:
  /// @param settles_below_m  limit of the tip's swing  @param light_kg  bridged up to this payload
  SettlingObserver(NominalObserver nominal, PayloadObserver payload, TipSway sway,
                   double settles_below_m, double light_kg, double period_s);

  void Reset() noexcept override;
  void Restart() noexcept override;
  std::array<double, 4> ModalRates(const PiecewiseTorque& applied) noexcept override {
    return nominal_.ModalRates(applied);
  }
  void FollowPath(const PathMotion& motion) noexcept override { payload_.FollowPath(motion); }
  void FollowReference(bool rests) noexcept override { reference_rests_ = rests; }
  StateEstimate Update(const Measurement& measurement) noexcept override;
  StateVector Predict(const StateVector& x, const PiecewiseTorque& pending) const noexcept override;
  bool wants_torque_by_delay() const noexcept override { return payload_.wants_torque_by_delay(); }
  int delay_found() const noexcept override { return payload_.delay_found(); }
  PayloadKnowledge payload() const noexcept override { return payload_.payload(); }
  double settling_share() const noexcept override;

 private:
  bool Bridges(const Measurement& measurement) const noexcept;
  bool MaySettle(const StateVector& x) const noexcept;
  StateVector Mix(const StateVector& nominal, const StateVector& payload) const noexcept;

  NominalObserver nominal_;
  PayloadObserver payload_;
  TipSway sway_;
  double settles_below_m_, light_kg_, period_s_;
  StateVector nominal_x_;
  double shown_share_ = 0.0;  // of the payload filter's state, in this sample
  bool reference_rests_ = false;
  double settles_s_ = 0.0;  // for so long already
};

}  // namespace flexarm
