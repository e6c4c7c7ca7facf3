#include "estimator/settling_observer.h"

#include <algorithm>
#include <utility>

namespace flexarm {
namespace {

constexpr double kAbandonsAbove = 1.5;  // times settles_below_m

}  // namespace

SettlingObserver::SettlingObserver(NominalObserver nominal, PayloadObserver payload, TipSway sway,
                                   double settles_below_m, double light_kg, double period_s)
    : nominal_(std::move(nominal)),
      payload_(std::move(payload)),
      sway_(std::move(sway)),
      settles_below_m_(settles_below_m),
      light_kg_(light_kg),
      period_s_(period_s) {}

void SettlingObserver::Reset() noexcept {
  nominal_.Reset();
  payload_.Reset();
  reference_rests_ = false;
  settles_s_ = 0.0;
  shown_share_ = 0.0;
}

void SettlingObserver::Restart() noexcept {
  nominal_.Restart();
  payload_.Restart();
}

bool SettlingObserver::Bridges(const Measurement& measurement) const noexcept {
  return measurement.counters->good == 0 && payload_.payload().payload_kg <= light_kg_;
}

bool SettlingObserver::MaySettle(const StateVector& x) const noexcept {
  const double limit_m = settles_below_m_ * (settles_s_ > 0.0 ? kAbandonsAbove : 1.0);
  return reference_rests_ && sway_.Amplitude_m(x.head<6>(), x.tail<6>()) < limit_m;
}

double SettlingObserver::settling_share() const noexcept {
  return std::min(1.0, settles_s_ / kSettlingFadesIn_s);
}

// Exactly the one or the other but for the change.
StateVector SettlingObserver::Mix(const StateVector& nominal,
                                  const StateVector& payload) const noexcept {
  if (shown_share_ <= 0.0) return nominal;
  if (shown_share_ >= 1.0) return payload;
  return nominal + shown_share_ * (payload - nominal);
}

StateEstimate SettlingObserver::Update(const Measurement& measurement) noexcept {
  StateEstimate estimate = nominal_.Update(measurement);
  const StateVector payload_x = payload_.Update(measurement).x;
  settles_s_ = MaySettle(payload_x) ? settles_s_ + period_s_ : 0.0;
  shown_share_ = Bridges(measurement) ? 1.0 : settling_share();
  nominal_x_ = estimate.x;
  estimate.x = Mix(nominal_x_, payload_x);
  return estimate;
}

StateVector SettlingObserver::Predict(const StateVector& x,
                                      const PiecewiseTorque& pending) const noexcept {
  return Mix(nominal_.Predict(nominal_x_, pending), payload_.Predict(x, pending));
}

}  // namespace flexarm
