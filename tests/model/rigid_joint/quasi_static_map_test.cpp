// The deflection of an arm that does not vibrate: against another program's numbers, against the
// balance of forces, and on the simulated arm.

#include "model/rigid_joint/quasi_static_map.h"

#include <gtest/gtest.h>

#include <utility>

#include "model/rigid_joint/rigid_joint_step.h"
#include "tests/support/golden_data.h"
#include "tests/support/loop_time.h"
#include "tests/support/no_alloc.h"
#include "tests/support/study_move.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Vector = RigidJointArm::Vector;

static_assert(noexcept(QuasiStaticOver(std::declval<const RigidJointArm&>(), 0.1, {}, kPeriod_s)));

Vector OfHubs(const std::array<double, 2>& hubs) {
  Vector out = Vector::Zero();
  out.head<2>() = Vector2d::Map(hubs.data());
  return out;
}

class QuasiStaticMap : public testing::Test {
 protected:
  const RigidJointArm arm_{ThesisRig()};
};

// Every tenth sample, to 1e-8 of the largest entry of its kind. The file has torques of the
// instants themselves, and at the edge of its horizon, sample 0, a one-sided difference for the
// rates.
TEST_F(QuasiStaticMap, AgreesWithTheGoldenMove) {
  const auto golden = GoldenFile("beyond-golden.json");
  const MatrixXd golden_x = AsMatrix(golden["ps_x"]), golden_u = AsMatrix(golden["ps_u"]);
  const OutboardBody body = arm_.Outboard(golden["m"]);
  MatrixXd x(golden_x.rows(), 12), u(golden_u.rows(), 2);
  for (int i = 0; i < x.rows(); ++i) {
    const auto path = StudyMove().Around(10 * i);
    x.row(i) = QuasiStaticOver(arm_, golden["m"], path, kPeriod_s).State();
    u.row(i) = QuasiStaticAt(arm_, body, path[1]).torque_nm;
  }
  const auto rates = [](const MatrixXd& all) -> MatrixXd {
    return all.bottomRightCorner(all.rows() - 1, 6);
  };
  EXPECT_LT(RelativeError(x.leftCols(6), golden_x.leftCols(6)), 1e-8);
  EXPECT_LT(RelativeError(rates(x), rates(golden_x)), 1e-8);
  EXPECT_LT(RelativeError(u, golden_u), 1e-8);
}

TEST_F(QuasiStaticMap, TheTorqueOfASampleIsTheMeanOfItsEnds) {
  const OutboardBody body = arm_.Outboard(0.37);
  const auto path = StudyMove().Around(20);
  const Vector2d now = QuasiStaticAt(arm_, body, path[1]).torque_nm,
                 next = QuasiStaticAt(arm_, body, path[2]).torque_nm;
  EXPECT_EQ(QuasiStaticOver(arm_, 0.37, path, kPeriod_s).Torque_nm(), 0.5 * (now + next));
  EXPECT_GT(next[0] - now[0], 0.1);
}

// The reference independent of the payload: the hubs of 0.15 kg.
TEST_F(QuasiStaticMap, HubsOf150GramsAreTheGoldenReference) {
  const MatrixXd golden_r = AsMatrix(GoldenFile("beyond-golden.json")["r"]);
  const OutboardBody body = arm_.Outboard(0.15);
  MatrixXd r(golden_r.rows(), 2);
  for (int i = 0; i < r.rows(); ++i) {
    r.row(i) = QuasiStaticAt(arm_, body, StudyMove().At(5 * i)).q.head<2>();
  }
  EXPECT_LT(RelativeError(r, golden_r), 1e-8);
}

// The elastic forces balance the inertial ones of the links, the torque those of the hubs, and Y
// agrees with its definition.
TEST_F(QuasiStaticMap, BalancesTheForcesOfTheStraightArm) {
  const RigidPoint point{.angle_rad = {0.3, -1.1},
                         .rate_rad_s = {1.2, -2.0},
                         .acceleration_rad_s2 = {-3.0, 5.0},
                         .jerk_rad_s3 = {}};
  for (const double payload_kg : {0.0, 0.37, 1.0}) {
    const OutboardBody body = arm_.Outboard(payload_kg);
    const QuasiStaticPose pose = QuasiStaticAt(arm_, body, point);
    const Vector v = OfHubs(point.rate_rad_s);
    const auto at = arm_.At(body, OfHubs(point.angle_rad), v);
    Vector bend = pose.q;
    bend.head<2>().setZero();
    Vector rest = at.M * OfHubs(point.acceleration_rad_s2) + at.bias + arm_.stiffness() * bend;
    rest.head<2>() -= pose.torque_nm;
    EXPECT_LT(rest.cwiseAbs().maxCoeff(), 1e-12 * at.M.cwiseAbs().maxCoeff()) << payload_kg;

    const Vector2d moment =
        at.M.topLeftCorner<2, 2>() * (pose.q.head<2>() - Vector2d::Map(point.angle_rad.data())) +
        at.M.topRightCorner<2, 4>() * pose.q.tail<4>();
    EXPECT_LT(moment.cwiseAbs().maxCoeff(), 1e-12) << payload_kg;
  }
}

TEST_F(QuasiStaticMap, AnArmAtRestIsStraight) {
  const RigidPoint rest{
      .angle_rad = {0.4, -0.7}, .rate_rad_s = {}, .acceleration_rad_s2 = {}, .jerk_rad_s3 = {}};
  const auto sample = QuasiStaticOver(arm_, 0.5, {rest, rest, rest}, kPeriod_s);
  Eigen::Matrix<double, 12, 1> expected = Eigen::Matrix<double, 12, 1>::Zero();
  expected.head<2>() = Vector2d::Map(rest.angle_rad.data());
  EXPECT_EQ(sample.State(), expected);
  EXPECT_EQ(sample.Torque_nm(), Vector2d::Zero());
}

// Its torque alone, on the frictionless arm: the residual motion at the end of the move is due to
// the inertia of f and the geometry of the bent arm, which the map neglects: at most 1.5 mrad and
// 1.0 mm.
TEST_F(QuasiStaticMap, ItsTorqueMovesTheArmAlongThePath) {
  const RigidJointStepper stepper(arm_, kPeriod_s, 20.0);
  for (const double payload_kg : {0.0, 0.15, 0.37}) {
    GaugedState x{.q = Vector::Zero(), .v = Vector::Zero(), .phi_f = Eigen::Vector4d::Zero()};
    for (int k = 0; k < StudyMove().periods; ++k) {
      const auto sample = QuasiStaticOver(arm_, payload_kg, StudyMove().Around(k), kPeriod_s);
      x = stepper.Advance(
          x,
          {.torque_nm = sample.Torque_nm(), .payload_kg = payload_kg, .friction_nm = {0.0, 0.0}});
    }
    const Vector2d goal = Vector2d::Map(StudyMove().At(StudyMove().periods).angle_rad.data());
    EXPECT_LT((x.q.head<2>() - goal).cwiseAbs().maxCoeff(), 0.002) << payload_kg;
    EXPECT_LT(x.q.tail<4>().cwiseAbs().maxCoeff(), 0.002) << payload_kg;
  }
}

TEST_F(QuasiStaticMap, DoesNotAllocate) {
  const NoAlloc armed;
  const auto sample = QuasiStaticOver(arm_, 0.37, StudyMove().Around(20), kPeriod_s);
  EXPECT_GT(sample.torque_nm[0], 0.0);
}

}  // namespace
}  // namespace flexarm
