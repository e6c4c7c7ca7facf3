// The numbers come from a program in Python written for these tests: Prandtl's stress function by
// finite differences, finite elements for torsion and for bending coupled with it.

#include "model/beam_methods/link_torsion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

constexpr double kPoisson = 0.33;

TwistingLink Link(std::size_t i) { return TwistingLink(ThesisRig().link[i].section, kPoisson); }

// By area b h and second moment b h^3 / 12. A square: 0.140577 b^4 (Timoshenko and Goodier, art.
// 109); a thin strip: b h^3 / 3.
TEST(RectangularSection, HasTheTorsionConstantOfTheTables) {
  const auto section = [](double b, double h) {
    BeamSection s = ThesisRig().link[0].section[0];
    s.area_m2 = b * h;
    s.second_moment_m4 = b * h * h * h / 12.0;
    return RectangularSection(s);
  };
  EXPECT_NEAR(section(0.01, 0.01).TorsionConstant_m4() / 1e-8, 0.140577, 1e-6);
  EXPECT_NEAR(section(0.02, 0.01).TorsionConstant_m4() / 2e-8, 0.228682, 1e-6);
  EXPECT_NEAR(section(0.01, 0.02).TorsionConstant_m4() / 2e-8, 0.228682, 1e-6);  // on edge
  EXPECT_NEAR(section(1.0, 1e-3).TorsionConstant_m4() * 3e9, 1.0, 1e-3);
  // Stress function on 80 and 160 cells, extrapolated: good to 3e-5.
  const RectangularSection link1(ThesisRig().link[0].section[0]);
  EXPECT_NEAR(link1.width_m, 0.03500535, 1e-8);
  EXPECT_NEAR(link1.thickness_m, 0.00449931, 1e-8);
  EXPECT_NEAR(link1.TorsionConstant_m4() / 9.76705524e-10, 1.0, 5e-5);
  const RectangularSection link2(ThesisRig().link[1].section[0]);
  EXPECT_NEAR(link2.TorsionConstant_m4() / 2.98694226e-10, 1.0, 5e-5);
}

TEST(TwistingLink, HasTheStiffnessesOfAShaftAndOfABeamOnEdge) {
  EXPECT_NEAR(Link(0).Stiffness_nm_per_rad(), 31.6236, 2e-3);
  EXPECT_NEAR(Link(1).Stiffness_nm_per_rad(), 8.5965, 1e-3);
  EXPECT_NEAR(Link(0).StiffnessAcross_n_per_m(), 6492.8998, 1e-3);  // 3 E I / L^3
}

TEST(TwistingLink, HasTheFrequenciesOfFiniteElementsInPureTorsion) {
  // Without an inertia: sqrt(G I_t / (rho I_p)) / (4 L).
  EXPECT_NEAR(Link(0).TorsionHz(0.0) / 236.2731, 1.0, 5e-5);
  EXPECT_NEAR(Link(1).TorsionHz(0.0) / 174.7192, 1.0, 5e-5);
  // Link 2 with 0, 0.1 and 0.2 kg at right angles to link 1.
  EXPECT_NEAR(Link(0).TorsionHz(0.06265554525) / 3.575239, 1.0, 5e-5);
  EXPECT_NEAR(Link(0).TorsionHz(0.14365554525) / 2.361276, 1.0, 5e-5);
  EXPECT_NEAR(Link(0).TorsionHz(0.22465554525) / 1.888234, 1.0, 5e-5);
}

TEST(TwistingLink, CouplesByThePayloadsOffsetAsFiniteElementsDo) {
  struct Row {
    double offset_m, axial_kgm2, hz[4], twist_rad_per_m;
  };
  const Row rows[] = {
      {0.01, 0.0, {1.92369777, 15.50572818, 47.01760534, 95.57519398}, 0.01699921},
      {0.02, 0.0, {1.92338298, 15.46742053, 46.50020482, 92.17807079}, 0.03400463},
      {0.05, 0.0, {1.92118157, 15.19279974, 42.33476245, 72.19346196}, 0.08512011},
      {0.02, 1e-4, {1.92338282, 15.46105227, 41.98242103, 49.68389234}, 0.03406252},
  };
  const ArmParameters arm = ThesisRig();
  for (const Row& row : rows) {
    const TwistTip tip{
        {arm.payload_mass_kg, arm.payload_inertia_kgm2}, row.offset_m, row.axial_kgm2};
    const std::vector<double> hz = Link(1).CoupledHz(tip, 4);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(hz[i] / row.hz[i], 1.0, 1e-4) << i;
    EXPECT_NEAR(Link(1).TwistPerDeflection_rad_per_m(tip, hz[0]) / row.twist_rad_per_m, 1.0, 2e-4);
  }
}

TEST(TwistingLink, IsTheBeamOfBeamModesWithoutAnOffset) {
  const ArmParameters arm = ThesisRig();
  const BeamTip payload{arm.payload_mass_kg, arm.payload_inertia_kgm2};
  const auto bending = ClampedModes(arm.link[1].section, payload, 3);
  const std::vector<double> hz = Link(1).CoupledHz({payload, 0.0, 0.0}, 3);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(hz[i] * 2.0 * M_PI / bending[i].frequency_rad_s(), 1.0, 1e-9);
  }
}

// A link cut in three equal pieces is the same link.
TEST(TwistingLink, MayHaveAnyNumberOfSections) {
  BeamSection third = ThesisRig().link[1].section[0];
  third.length_m /= 3.0;
  const TwistingLink cut({third, third, third}, kPoisson);
  const TwistTip tip{{0.1, 1e-4}, 0.03, 2e-4};
  EXPECT_NEAR(cut.Stiffness_nm_per_rad() / Link(1).Stiffness_nm_per_rad(), 1.0, 1e-12);
  EXPECT_NEAR(cut.StiffnessAcross_n_per_m() / Link(1).StiffnessAcross_n_per_m(), 1.0, 1e-12);
  const auto whole_hz = Link(1).CoupledHz(tip, 6), cut_hz = cut.CoupledHz(tip, 6);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(cut_hz[i] / whole_hz[i], 1.0, 1e-9) << i;
  EXPECT_NEAR(cut.TwistPerDeflection_rad_per_m(tip, cut_hz[0]) /
                  Link(1).TwistPerDeflection_rad_per_m(tip, whole_hz[0]),
              1.0, 1e-6);
}

TEST(TwistingLink, RefusesWhatIsNoMaterial) {
  EXPECT_THROW(TwistingLink(ThesisRig().link[0].section, 0.5), std::invalid_argument);
  EXPECT_THROW(TwistingLink({}, 0.3), std::invalid_argument);
}

}  // namespace
}  // namespace flexarm
