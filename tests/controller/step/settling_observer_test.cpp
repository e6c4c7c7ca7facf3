// Which filter the observer of `sobel` shows, and when.

#include "estimator/settling_observer.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "controller/step/observer_factory.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

struct Readings {
  DecodedCounters counters{};
  FittedModes modes{};
  PiecewiseTorque torque = PiecewiseTorque::WholePeriod({0.0, 0.0});
  TorqueByDelay by_delay{};

  Measurement measurement() const {
    return {.counters = &counters,
            .modes = &modes,
            .applied = &torque,
            .applied_by_delay = &by_delay,
            .tip_m_s2 = {}};
  }
};

// A straight arm at these hub angles, whose link 2 is bent by this at its tip.
Readings At(double th1, double th2, double bend_m = 0.0) {
  Readings r;
  r.counters.angle_rad = {th1, th2, th1, th2};
  r.counters.good = 0b1111;
  r.modes.modal_m = {0.0, 0.0, bend_m, 0.0};
  r.modes.valid = {true, true};
  r.by_delay.fill(r.torque);
  return r;
}

class SettlingObserverTest : public testing::Test {
 protected:
  SettlingObserverTest() {
    observer_->Reset();
    kalman_->Reset();
  }

  // One sample of both observers.
  void Sample(const Readings& readings, bool rests) {
    observer_->FollowReference(rests);
    x_ = observer_->Update(readings.measurement()).x;
    kalman_x_ = kalman_->Update(readings.measurement()).x;
  }

  const RigConfig config_ = ShippedRig(), thesis_ = ShippedRig({kThesisLaw});
  std::unique_ptr<Observer> observer_ = MakeObserver(config_, ShippedDesign());
  std::unique_ptr<Observer> kalman_ = MakeObserver(thesis_, ShippedDesign());
  StateVector x_, kalman_x_;
};

TEST_F(SettlingObserverTest, IsTheKalmanFilterToTheBitWhileTheReferenceMoves) {
  const PiecewiseTorque pending = PiecewiseTorque::WholePeriod({1.0, -0.2});
  for (int k = 0; k < 20; ++k) {
    Sample(At(0.01 * k, -0.02 * k, 0.001 * k), false);
    EXPECT_EQ(x_, kalman_x_) << k;
    EXPECT_EQ(observer_->settling_share(), 0.0);
    EXPECT_EQ(observer_->Predict(x_, pending), kalman_->Predict(kalman_x_, pending)) << k;
  }
}

TEST_F(SettlingObserverTest, ChangesOverInATenthOfASecondOfRest) {
  for (int k = 0; k < 10; ++k) Sample(At(0.2 + 1e-3 * (k % 2), 0.1), false);
  for (int k = 1; k <= 5; ++k) {
    Sample(At(0.2 + 1e-3 * (k % 2), 0.1), true);
    EXPECT_NEAR(observer_->settling_share(), 0.2 * k, 1e-12);
  }
  EXPECT_NE(x_, kalman_x_);
  Sample(At(0.2, 0.1), false);
  EXPECT_EQ(observer_->settling_share(), 0.0);
  EXPECT_EQ(x_, kalman_x_);
}

// A bend of 0.3 m is far beyond the 0.1 m of [controller.settling]; half a metre beyond 1.5 times.
TEST_F(SettlingObserverTest, WaitsUntilALargeVibrationHasDecayed) {
  for (int k = 0; k < 10; ++k) {
    Sample(At(0.0, 0.0, 0.3), true);
    EXPECT_EQ(observer_->settling_share(), 0.0) << k;
  }
  for (int k = 0; k < 100; ++k) Sample(At(0.0, 0.0), true);
  EXPECT_EQ(observer_->settling_share(), 1.0);
  for (int k = 0; k < 5; ++k) Sample(At(0.0, 0.0, 0.5), true);
  EXPECT_EQ(observer_->settling_share(), 0.0) << "the vibration is large again";
}

// The nominal model has 0.1 kg: its prediction suits heavier arms, that of the payload filter
// lighter.
TEST_F(SettlingObserverTest, BridgesALostSampleIfThePayloadIsLight) {
  for (const bool light : {false, true}) {
    const std::string start = light ? "0.0" : "0.2";
    const auto observer =
        MakeObserver(ShippedRig({"estimator.payload.start_kg=" + start}), ShippedDesign());
    const auto kalman = MakeObserver(thesis_, ShippedDesign());
    StateVector x, kalman_x;
    for (int k = 0; k < 10; ++k) {
      Readings readings = At(0.2 + 1e-3 * (k % 2), 0.1);
      const bool lost = k == 9;
      if (lost) {
        readings.counters.good = 0;
        readings.modes.valid = {false, false};
      }
      observer->FollowReference(false);
      x = observer->Update(readings.measurement()).x;
      kalman_x = kalman->Update(readings.measurement()).x;
      if (!lost || !light) {
        EXPECT_EQ(x, kalman_x) << k;
      }
    }
    if (light) {
      EXPECT_NE(x, kalman_x);
    }
    EXPECT_EQ(observer->settling_share(), 0.0);
  }
}

TEST_F(SettlingObserverTest, KnowsThePayloadAlsoWhileTheArmMoves) {
  Sample(At(0.0, 0.0), false);
  EXPECT_EQ(observer_->payload().payload_kg, config_.estimator.payload->start_kg);
  EXPECT_EQ(observer_->wants_torque_by_delay(), config_.estimator.payload->detect_delay);
}

}  // namespace
}  // namespace flexarm
