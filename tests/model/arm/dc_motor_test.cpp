#include "model/arm/dc_motor.h"

#include <gtest/gtest.h>

#include <cmath>

namespace flexarm {
namespace {

// (3.24): C i (1 - e^(-t/T)) at the ends of the steps, exactly; the middle is of second order.
TEST(DcMotor, StepResponseIsThatOfTheThesis) {
  const double h = 5e-4, T = 2e-3;
  DcMotor motor(h, T);
  for (int i = 1; i <= 20; ++i) {
    const double middle = motor.Step(3.0);
    EXPECT_NEAR(motor.torque_nm(), 3.0 * (1.0 - std::exp(-i * h / T)), 1e-14);
    EXPECT_NEAR(middle, 3.0 * (1.0 - std::exp(-(i - 0.5) * h / T)), 3.0 * std::pow(h / T, 2) / 8.0);
  }
  DcMotor none(h, 0.0);
  EXPECT_EQ(none.Step(3.0), 3.0);
}

}  // namespace
}  // namespace flexarm
