#include "model/beam_methods/lumped_beam.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "model/beam/link_modes.h"
#include "model/beam/root_search_error.h"
#include "tests/support/message_of.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const BeamTip kBare{0.0, 0.0};

std::vector<BeamSection> Link2() { return ThesisRig().link[1].section; }

// Three sections, with tip mass and inertia.
std::vector<BeamSection> Stepped() {
  const BeamSection s = Link2()[0];
  std::vector<BeamSection> section = {s, s, s};
  section[0].length_m = 0.1, section[0].second_moment_m4 *= 5.0, section[0].area_m2 *= 2.0;
  section[1].length_m = 0.6;
  section[2].length_m = 0.2, section[2].youngs_modulus_pa *= 0.3;
  return section;
}

double ErrorPercent(int parts, int order, LumpInertia inertia = LumpInertia::kNone) {
  const double exact =
      ClampedModes(Link2(), kBare, order)[static_cast<std::size_t>(order - 1)].frequency_rad_s();
  const LumpedBeam beam(Link2(), kBare, BeamRoot::Clamped(), parts, "link 2", inertia);
  return 100.0 * (beam.Modes(order).back().frequency_rad_s / exact - 1.0);
}

// docs/theory/plant.md 2.3: bare link 2. Half of the last digit printed.
TEST(LumpedBeam, ErrorsOfBareLinkTwoAreThoseOfTheReference) {
  const double ten[] = {-0.457, -1.564, -2.550, -3.565}, fifty[] = {-0.018, -0.064, -0.105, -0.147};
  for (int order = 1; order <= 4; ++order) {
    EXPECT_NEAR(ErrorPercent(10, order), ten[order - 1], 5.1e-4) << order;
    EXPECT_NEAR(ErrorPercent(50, order), fifty[order - 1], 5.1e-4) << order;
  }
}

// The thesis's "less than 0.05 %" needs N >= 31 for one mode and N >= 86 for four
// (docs/theory/plant.md 2.3).
TEST(LumpedBeam, ClaimOfTheThesisNeedsTheStatedNumberOfParts) {
  EXPECT_GT(std::fabs(ErrorPercent(30, 1)), 0.05);
  EXPECT_LT(std::fabs(ErrorPercent(31, 1)), 0.05);
  EXPECT_GT(std::fabs(ErrorPercent(85, 4)), 0.05);
  EXPECT_LT(std::fabs(ErrorPercent(86, 4)), 0.05);
}

TEST(LumpedBeam, SlabInertiaIncreasesTheError) {
  for (int order = 1; order <= 4; ++order) {
    EXPECT_LT(ErrorPercent(20, order, LumpInertia::kSlab), ErrorPercent(20, order)) << order;
  }
}

// The two solvers share only the beam equation: as N doubles, the difference is a quarter. 5 % of 4
// allow for the next term (N^-4) at N = 80; modes of a stepped beam with tip, for every root.
TEST(LumpedBeam, ConvergesToTheExactModesAsTheSquareOfN) {
  const BeamTip tip{0.2, 1e-3};
  for (const BeamRoot root : {BeamRoot::Clamped(), BeamRoot::Pinned(), BeamRoot::Spring(15.0)}) {
    const auto exact = NaturalModes(Stepped(), tip, root, 4);
    const auto coarse = LumpedBeam(Stepped(), tip, root, 80).Modes(4);
    const auto fine = LumpedBeam(Stepped(), tip, root, 160).Modes(4);
    for (std::size_t i = 0; i < 4; ++i) {
      const double w = exact[i].frequency_rad_s();
      const double ratio = (coarse[i].frequency_rad_s - w) / (fine[i].frequency_rad_s - w);
      EXPECT_NEAR(ratio, 4.0, 0.2) << "root " << root.stiffness_nm_per_rad << " mode " << i + 1;
      EXPECT_NEAR(fine[i].frequency_rad_s / w, 1.0, 1e-3);
    }
  }
}

TEST(LumpedBeam, ShapesAgreeWithTheExactModes) {
  const BeamTip tip{0.2, 1e-3};
  const auto exact = NaturalModes(Stepped(), tip, BeamRoot::Spring(15.0), 4);
  const auto lumped = LumpedBeam(Stepped(), tip, BeamRoot::Spring(15.0), 100).Modes(4);
  for (std::size_t i = 0; i < 4; ++i) {
    double largest = 0.0, difference = 0.0;
    for (std::size_t j = 0; j < lumped[i].x_m.size(); ++j) {
      const double psi = exact[i].Value(lumped[i].x_m[j]);
      largest = std::fmax(largest, std::fabs(psi));
      difference = std::fmax(difference, std::fabs(psi - lumped[i].w[j]));
    }
    EXPECT_LT(difference, 2e-3 * largest) << "mode " << i + 1;
    EXPECT_EQ(lumped[i].w.front(), 0.0);
    EXPECT_NEAR(lumped[i].w.back(), 1.0, 1e-12);
  }
}

// Pivots and transfer matrices are independent methods for the frequencies of the lumped beam.
TEST(LumpedBeam, DeterminantChangesSignExactlyWhereTheCountSteps) {
  const LumpedBeam beam(Stepped(), {0.2, 1e-3}, BeamRoot::Spring(15.0), 12);
  double before = beam.EndDeterminant(0.5);
  int changes = 0;
  for (double w = 0.5; w < 3000.0; w *= 1.003) {
    const double now = beam.EndDeterminant(w);
    changes += now * before < 0.0 ? 1 : 0;
    before = now;
    ASSERT_EQ(changes, beam.CountBelow(w)) << w;
  }
  EXPECT_GE(changes, 6);
}

// Ten modes of a beam whose plain transfer matrix loses all digits (cosh of 30).
TEST(LumpedBeam, LongBeamsLoseNoDigits) {
  const auto exact = ClampedModes(Link2(), kBare, 10);
  const auto lumped = LumpedBeam(Link2(), kBare, BeamRoot::Clamped(), 800).Modes(10);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_NEAR(lumped[i].frequency_rad_s / exact[i].frequency_rad_s(), 1.0, 3e-4) << i + 1;
  }
}

TEST(LumpedBeam, SearchThatFailsSaysForWhichBeamModeAndInterval) {
  const LumpedBeam beam(Link2(), kBare, BeamRoot::Clamped(), 3, "link 2");
  EXPECT_THAT(MessageOf<RootSearchError>([&] { beam.Modes(4); }),
              AllOf(HasSubstr("link 2, mode 4"), HasSubstr("between 0 and"), HasSubstr("rad/s")));
}

TEST(NaturalModes, SearchThatFailsSaysForWhichBeamModeAndInterval) {
  auto section = Link2();
  section[0].youngs_modulus_pa = 1e60;
  EXPECT_THAT(MessageOf<RootSearchError>([&] { ClampedModes(section, kBare, 2, "link 2"); }),
              AllOf(HasSubstr("link 2, mode 1"), HasSubstr("between 1e-09 and 1e+12 rad/s")));
}

}  // namespace
}  // namespace flexarm
