#include "controller/law/law_factory.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "controller/design/design_controller.h"
#include "controller/types/law_table.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

TEST(LawTable, HasOneRowForEachKindAndName) {
  std::set<ControllerKind> kinds;
  std::set<std::string> names;
  for (const LawRow& law : kLaws) {
    kinds.insert(law.kind);
    names.insert(law.name);
    EXPECT_EQ(&LawOf(law.kind), &law) << law.name;
  }
  EXPECT_EQ(kinds.size(), kLaws.size());
  EXPECT_EQ(names.size(), kLaws.size());
}

// The arm and the reference are at rest.
TEST(LawFactory, MakesEveryLawOfTheTable) {
  for (const LawRow& row : kLaws) {
    const RigConfig config = ShippedRig({std::string("controller.name=") + row.name});
    ASSERT_EQ(config.controller.kind, row.kind) << row.name;
    const Design design = DesignController(config);
    const std::unique_ptr<Law> law = MakeLaw(config, design);
    const StateVector x = StateVector::Zero(design.layout.states());
    const ReferenceSample reference{};
    const std::array<RigidPoint, 3> path{};
    PayloadKnowledge payload = kNoPayloadEstimate;
    if (row.is_scheduled || row.settles) {
      payload = {.payload_kg = 0.1,
                 .payload_sigma_kg = 0.0,
                 .friction_nm = {0.0, 0.0},
                 .mean_nis = 8.0,
                 .warnings = 0};
    }
    const LawOutput out = law->Compute({.x = &x,
                                        .reference = &reference,
                                        .path = &path,
                                        .plan = nullptr,
                                        .payload = payload,
                                        .rested_s = 10.0,
                                        .settling_share = 0.0,
                                        .may_adapt = true});
    EXPECT_TRUE(out.finite) << row.name;
    EXPECT_EQ(out.torque_nm, (std::array<double, 2>{0.0, 0.0})) << row.name;
    EXPECT_EQ((out.limits & kAdaptationHeld) == 0, !row.is_scheduled) << row.name;
  }
}

TEST(Saturation, ClipsEachTorqueToItsLimitAndFlagsIt) {
  const LawOutput out = Saturate({-40.0, 3.0}, {30.0, 6.0});
  EXPECT_EQ(out.torque_nm, (std::array<double, 2>{-30.0, 3.0}));
  EXPECT_EQ(out.limits, std::uint32_t{kLimitTorque1});
}

TEST(Saturation, ATorqueThatIsNotFiniteBecomesZeroAndIsFlagged) {
  const LawOutput out = SaturateWithoutAdaptation({std::nan(""), 3.0}, {30.0, 6.0});
  EXPECT_FALSE(out.finite);
  EXPECT_EQ(out.torque_nm, (std::array<double, 2>{0.0, 0.0}));
  EXPECT_EQ(out.limits, std::uint32_t{kAdaptationHeld});
}

}  // namespace
}  // namespace flexarm
