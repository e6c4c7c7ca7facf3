#pragma once

#include <Eigen/Core>
#include <array>

namespace flexarm {

/// State and torque of a planned motion at one instant. Trivially copyable: it is logged as bytes
/// and passed between threads.
struct MotionSample {
  std::array<double, 12> x;         ///< [q; q'] of RigidJointArm, rad and m, and per second
  std::array<double, 2> torque_nm;  ///< feedforward torque, without friction

  static MotionSample Of(const Eigen::Matrix<double, 12, 1>& x,
                         const Eigen::Vector2d& torque_nm) noexcept {
    MotionSample sample{};
    Eigen::Matrix<double, 12, 1>::Map(sample.x.data()) = x;
    Eigen::Vector2d::Map(sample.torque_nm.data()) = torque_nm;
    return sample;
  }
  Eigen::Matrix<double, 12, 1> State() const noexcept {
    return Eigen::Matrix<double, 12, 1>::Map(x.data());
  }
  Eigen::Vector2d Torque_nm() const noexcept { return Eigen::Vector2d::Map(torque_nm.data()); }
};

}  // namespace flexarm
