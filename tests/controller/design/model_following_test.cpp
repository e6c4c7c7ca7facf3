// Condition (7.3). The ranks were computed by a program in Python from the matrices of golden.json
// too; their smallest singular value that counts is 5e-4, the largest that does not 1e-15.

#include "controller/design/model_following.h"

#include <gtest/gtest.h>

#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

void ExpectRanks(const FollowingRanks& ranks, int input, int difference) {
  EXPECT_EQ(ranks.input, input);
  EXPECT_EQ(ranks.difference, difference);
}

TEST(ModelFollowing, FailsWithoutFrictionAndBacklash) {
  const ModelFollowing r12 = TestModelFollowing(ShippedRig(), kR12);
  ExpectRanks(r12.continuous, 2, 6);
  ExpectRanks(r12.discrete, 2, 10);
  EXPECT_FALSE(r12.continuous.follows());
  EXPECT_EQ(r12.continuous.reference, 2);  // B_m = B
  EXPECT_EQ(r12.discrete.reference, 4);    // the sampled ones differ
  const ModelFollowing t12 = TestModelFollowing(ShippedRig(), kT12);
  ExpectRanks(t12.continuous, 2, 4);  // two modes are damped
  ExpectRanks(t12.discrete, 2, 10);
}

TEST(ModelFollowing, FrictionAddsNothingWhereTheTorquesAct) {
  const FollowingPlant friction{.friction_gain_s_per_rad = 50.0};
  const ModelFollowing r12 = TestModelFollowing(ShippedRig(), kR12, friction);
  ExpectRanks(r12.continuous, 2, 6);
  // The links damped as the reference: now friction alone is the difference.
  const FollowingPlant alone{.friction_gain_s_per_rad = 50.0, .damping_of_reference = true};
  const ModelFollowing satisfied = TestModelFollowing(ShippedRig(), kR12, alone);
  ExpectRanks(satisfied.continuous, 2, 2);
  EXPECT_TRUE(satisfied.continuous.follows());
  // With elastic joints it acts on the hubs, beyond the springs.
  ExpectRanks(TestModelFollowing(ShippedRig(), kT12, alone).continuous, 2, 4);
}

TEST(ModelFollowing, BacklashChangesTheStiffnessOfAnElasticJoint) {
  const FollowingPlant open{.in_clearance = true, .damping_of_reference = true};
  ExpectRanks(TestModelFollowing(ShippedRig(), kT12, open).continuous, 2, 3);
  ExpectRanks(TestModelFollowing(ShippedRig(), kR12, open).continuous, 2, 2);
}

TEST(ModelFollowing, HoldsForTheReferenceItself) {
  const ModelFollowing same =
      TestModelFollowing(ShippedRig(), kR12, {.damping_of_reference = true});
  EXPECT_TRUE(same.continuous.follows());
  EXPECT_TRUE(same.discrete.follows());
}

}  // namespace
}  // namespace flexarm
