#include "model/beam/beam_modes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "model/beam/dynamic_stiffness.h"
#include "model/beam/link_modes.h"
#include "model/beam/root_search_error.h"
#include "model/beam_methods/friction_root.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

BeamSection Strip(double length) {
  BeamSection s = ThesisRig().link[1].section[0];
  s.length_m = length;
  return s;
}

std::vector<BeamSection> CutInto(const BeamSection& whole, const std::vector<double>& length) {
  std::vector<BeamSection> out(length.size(), whole);
  for (std::size_t i = 0; i < length.size(); ++i) out[i].length_m = length[i];
  return out;
}

// Roots of 1 + cos z cosh z = 0 to 16 digits (docs/theory/plant.md 2.5). The search stops at
// round-off of w, and z is its square root: 1e-12 has a margin of three digits.
TEST(BeamModes, BareCantileverHasTheRootsOfTheClosedForm) {
  const auto mode = ClampedModes({Strip(0.9)}, {0.0, 0.0}, 3);
  EXPECT_NEAR(mode[0].beta_length(), 1.875104068711961, 1e-12);
  EXPECT_NEAR(mode[1].beta_length(), 4.694091132974175, 1e-12);
  EXPECT_NEAR(mode[2].beta_length(), 7.854757438237613, 1e-12);
}

// Its frequencies crowd: their number below 1 rad/s is no int. Found by fuzzing a config.
TEST(BeamModes, ASectionWithoutStiffnessIsRefused) {
  BeamSection soft = Strip(0.9);
  soft.second_moment_m4 = 2.657e-90;
  EXPECT_EQ(CountClampedClamped(Strip(0.9), 1.0), 0);
  EXPECT_EQ(CountClampedClamped(soft, 1.0), 1'000'000) << "as many are counted";
  EXPECT_THROW(ClampedModes({soft}, {0.0, 0.0}, 1), RootSearchError);
}

struct TableRow {
  int link;
  double tip_inertia;  // kg m^2; docs/theory/plant.md 2.5 has 10 to 13 digits
  double beta1, beta2;
  double hz[3];
};

// The table of link modes in docs/theory/plant.md 2.5. Its printed digits are the tolerance.
TEST(BeamModes, RigLinksMatchTheReferenceTable) {
  const ArmParameters p = ThesisRig();
  const double carried = 3.03 + 0.24 + p.link[1].mass_kg() + 0.1;
  const double locked =
      1.15e-2 + 9.25e-3 + 1.05e-7 + 1.078e-7 + 0.1 * 0.81 + p.link[1].mass_kg() * 0.81 / 3.0;
  const TableRow rows[] = {
      {1, 0.0, 0.7260376505331, 3.9378448858731, {0.8589728, 25.268435, 81.572580}},
      {1, 1.15e-2, 0.7240582154, 2.8199696870, {0.8542954, 12.958359, 39.649129}},
      {1, locked, 0.6990128384, 1.5669628238, {0.7962169, 4.0010918, 36.941480}},
      {2, 1.078e-7, 1.4551580656, 4.1328908838, {1.9238029, 15.518441, 47.183813}}};
  for (const TableRow& row : rows) {
    const auto& section = p.link[static_cast<std::size_t>(row.link - 1)].section;
    const BeamTip tip{row.link == 1 ? carried : 0.1, row.tip_inertia};
    const auto mode = ClampedModes(section, tip, 3);
    EXPECT_NEAR(mode[0].beta_length(), row.beta1, 1.1e-10) << row.tip_inertia;
    EXPECT_NEAR(mode[1].beta_length(), row.beta2, 1.1e-10) << row.tip_inertia;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(mode[i].frequency_rad_s() / (2.0 * M_PI) / row.hz[i], 1.0, 2e-7);
    }
  }
}

// A uniform beam does not change when it is divided into sections, long ones and very short ones,
// in both bases. 1e-11: matching 5 sections loses a digit or two to round-off.
TEST(BeamModes, DividingAUniformBeamChangesNothing) {
  const BeamTip tip{0.1, 1e-4};
  const auto whole = ClampedModes({Strip(0.9)}, tip, 10);
  const auto cut = ClampedModes(CutInto(Strip(0.9), {0.3, 0.001, 0.4, 0.149, 0.05}), tip, 10);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_NEAR(cut[i].beta_length() / whole[i].beta_length(), 1.0, 1e-11) << "mode " << i + 1;
    for (double x = 0.0; x <= 0.9; x += 0.0333) {
      EXPECT_NEAR(cut[i].Value(x), whole[i].Value(x), 1e-8) << "mode " << i + 1 << " at " << x;
    }
  }
}

// Every shape satisfies its defining conditions: clamp, continuity, both tip conditions.
TEST(BeamModes, SteppedBeamSatisfiesItsConditions) {
  std::vector<BeamSection> section = {Strip(0.25), Strip(0.35), Strip(0.3)};
  section[0].second_moment_m4 *= 4.0;
  section[0].area_m2 *= 1.6;
  section[2].youngs_modulus_pa *= 0.3;
  const BeamTip tip{0.2, 2e-3};
  const auto EI = [&](std::size_t i) { return section[i].bending_stiffness_nm2(); };
  for (const BeamMode& psi : ClampedModes(section, tip, 10)) {
    EXPECT_NEAR(psi.Value(0.0), 0.0, 1e-10);
    EXPECT_NEAR(psi.Value(0.9), 1.0, 1e-12);
    const double moment_scale = EI(0) * std::fabs(psi.Curvature(0.0));
    double x = 0.0;
    for (std::size_t i = 0; i < 2; ++i) {
      x += section[i].length_m;
      const double before = std::nextafter(x, 0.0);
      EXPECT_NEAR(psi.Value(before), psi.Value(x), 1e-9 * moment_scale);
      EXPECT_NEAR(EI(i) * psi.Curvature(before), EI(i + 1) * psi.Curvature(x), 1e-9 * moment_scale);
      EXPECT_NEAR(EI(i) * psi.Third(before), EI(i + 1) * psi.Third(x), 1e-7 * moment_scale);
    }
    const double w2 = psi.frequency_rad_s() * psi.frequency_rad_s();
    EXPECT_NEAR(EI(2) * psi.Curvature(0.9), w2 * tip.inertia_kgm2 * psi.Slope(0.9),
                1e-9 * moment_scale);
    EXPECT_NEAR(EI(2) * psi.Third(0.9), -w2 * tip.mass_kg, 1e-7 * moment_scale);
  }
}

// Two equal strips joined by a link so soft that the halves vibrate almost independently: pairs of
// close roots that a sign search on a grid would miss. Counting cannot miss one.
TEST(BeamModes, CloseRootsAreAllFound) {
  std::vector<BeamSection> section = {Strip(0.5), Strip(1e-3), Strip(0.5)};
  section[1].youngs_modulus_pa *= 1e-6;
  const BeamTip none{0.0, 0.0};
  const auto mode = ClampedModes(section, none, 8);
  for (int i = 0; i < 8; ++i) {
    const double w = mode[static_cast<std::size_t>(i)].frequency_rad_s();
    EXPECT_EQ(CountFrequenciesBelow(section, none, w * (1.0 - 1e-7)), i);
    EXPECT_EQ(CountFrequenciesBelow(section, none, w * (1.0 + 1e-7)), i + 1);
  }
}

// With a heavy tip the link is a massless spring: w^2 -> 3EI / ((m_t + 33/140 m) L^3), Rayleigh's
// estimate, accurate to 8e-8 at m_t = 100 m. Without the 33/140 the error is 1.2e-3.
TEST(BeamModes, HeavyTipMassRecoversTheMasslessSpring) {
  const BeamSection s = Strip(0.9);
  const double mass = s.mass_per_length_kg_m() * 0.9;
  const double stiffness = 3.0 * s.bending_stiffness_nm2() / std::pow(0.9, 3);
  const double expected = std::sqrt(stiffness / (100.0 * mass + 33.0 / 140.0 * mass));
  EXPECT_NEAR(ClampedModes({s}, {100.0 * mass, 0.0}, 1)[0].frequency_rad_s() / expected, 1.0, 1e-6);
}

// Pinned-free roots of tan z = tanh z (docs/theory/plant.md 2.5), after the rigid-body root, to the
// digits given.
TEST(BeamModes, PinnedBeamHasTheRootsOfTheClosedForm) {
  const BeamSection s = Strip(0.9);
  const auto beta_length = [&](int order) {
    const double w = PinnedFrequency({s}, {0.0, 0.0}, order);
    return 0.9 * std::sqrt(w * std::sqrt(s.mass_per_length_kg_m() / s.bending_stiffness_nm2()));
  };
  EXPECT_EQ(PinnedFrequency({s}, {0.0, 0.0}, 1), 0.0);
  EXPECT_NEAR(beta_length(2), 3.926602312047919, 1e-12);
  EXPECT_NEAR(beta_length(3), 7.068582745628732, 1e-12);
}

// A bare uniform beam on a root spring k: z (sin z cosh z - cos z sinh z) = k L/(EI) (1 + cos z
// cosh z), from the free end's conditions by hand. Both sides over cosh z: an error of 1e-11 in z
// is detected.
TEST(BeamModes, BeamOnARootSpringSatisfiesTheClosedForm) {
  const BeamSection s = Strip(0.9);
  for (const double k : {0.01, 1.0, 50.0, 3000.0}) {
    const double kappa = k * 0.9 / s.bending_stiffness_nm2();
    for (const BeamMode& mode : NaturalModes({s}, {0.0, 0.0}, BeamRoot::Spring(k), 4)) {
      const double z = mode.beta_length();
      const double left = z * (std::sin(z) - std::cos(z) * std::tanh(z));
      const double right = kappa * (1.0 / std::cosh(z) + std::cos(z));
      EXPECT_NEAR(left, right, 1e-10 * (z + kappa)) << "k = " << k << " z = " << z;
      EXPECT_NEAR(s.bending_stiffness_nm2() * mode.Curvature(0.0), k * mode.Slope(0.0),
                  1e-9 * s.bending_stiffness_nm2() * z * z)
          << k;
    }
  }
}

// The two ends of the spring's range. First order in 1/k and k: 1e-9 of the range's middle.
TEST(BeamModes, RootSpringRangesFromPinnedToClamped) {
  const BeamTip tip{0.1, 1e-4};
  const auto clamped = ClampedModes({Strip(0.9)}, tip, 3);
  const auto pinned = NaturalModes({Strip(0.9)}, tip, BeamRoot::Pinned(), 3);
  const auto stiff = NaturalModes({Strip(0.9)}, tip, BeamRoot::Spring(1e10), 3);
  const auto soft = NaturalModes({Strip(0.9)}, tip, BeamRoot::Spring(1e-8), 4);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(stiff[i].frequency_rad_s() / clamped[i].frequency_rad_s(), 1.0, 1e-7) << i;
    EXPECT_NEAR(soft[i + 1].frequency_rad_s() / pinned[i].frequency_rad_s(), 1.0, 1e-8) << i;
    EXPECT_GT(clamped[i].frequency_rad_s(), soft[i].frequency_rad_s());
    EXPECT_NEAR(pinned[i].Curvature(0.0), 0.0, 1e-7);
  }
  EXPECT_LT(soft[0].frequency_rad_s(), 1e-3) << "nearly a rigid body on a soft spring";
}

// The example of docs/theory/plant.md 2.4, its digits are the tolerance: link 1 with I_r2 at its
// tip, 0.16 N m.
TEST(FrictionRootMode, RigExampleSlipsAtFiveMillimetresAndSticksAtOne) {
  const ArmParameters p = ThesisRig();
  const BeamTip tip{3.03 + 0.24 + p.link[1].mass_kg() + 0.1, 1.15e-2};
  const FrictionRoot five = FrictionRootMode(p.link[0].section, tip, 1, 5e-3, 0.16);
  EXPECT_FALSE(five.sticks);
  EXPECT_NEAR(five.clamped_moment_nm, 0.42905, 5e-6);
  EXPECT_NEAR(five.frequency_rad_s / (2.0 * M_PI), 0.52121261973, 1e-10);
  const FrictionRoot one = FrictionRootMode(p.link[0].section, tip, 1, 1e-3, 0.16);
  EXPECT_TRUE(one.sticks);
  EXPECT_NEAR(one.clamped_moment_nm, 0.0858, 5e-5);
  EXPECT_NEAR(one.frequency_rad_s / (2.0 * M_PI), 0.8542954, 2e-7);
  EXPECT_THROW(FrictionRootMode(p.link[0].section, tip, 1, 0.0, 0.16), std::invalid_argument);
}

TEST(BeamModes, InvalidBeamsAreRejected) {
  EXPECT_THROW(ClampedModes({}, {0.0, 0.0}, 1), std::invalid_argument);
  EXPECT_THROW(ClampedModes({Strip(0.9)}, {0.0, 0.0}, 0), std::invalid_argument);
  EXPECT_THROW(ClampedModes({Strip(0.9)}, {-0.1, 0.0}, 1), std::invalid_argument);
  EXPECT_THROW(ClampedModes({Strip(-0.9)}, {0.1, 0.0}, 1), std::invalid_argument);
  EXPECT_THROW(NaturalModes({Strip(0.9)}, {0.1, 0.0}, BeamRoot::Spring(-1.0), 1),
               std::invalid_argument);
}

// Distinct clamped modes are orthogonal in mass (with the tip) and in stiffness, and w^2 is their
// ratio: three relations between shapes, integrals and frequencies. 1e-9 is round-off of the
// tip-normalised shapes (max psi is 70 on link 1); a wrong tip term leaves 0.1 and more.
TEST(LinkModes, ModesAreOrthogonalInMassAndStiffness) {
  const ArmParameters p = ThesisRig();
  const LinkModes links[] = {Link1Modes(p, 6), Link2Modes(p, 6)};
  const BeamTip tips[] = {{3.03 + 0.24 + p.link[1].mass_kg() + 0.1, 1.15e-2 + 9.25e-3},
                          {0.1, 1.078e-7}};
  for (std::size_t k = 0; k < 2; ++k) {
    const LinkModes& link = links[k];
    const Eigen::MatrixXd mass = link.N +
                                 tips[k].mass_kg * link.psi_tip * link.psi_tip.transpose() +
                                 tips[k].inertia_kgm2 * link.slope_tip * link.slope_tip.transpose();
    for (int i = 0; i < 6; ++i) {
      const double w = link.mode[static_cast<std::size_t>(i)].frequency_rad_s();
      EXPECT_NEAR(link.G(i, i) / (w * w * mass(i, i)), 1.0, 1e-9);
      for (int j = 0; j < i; ++j) {
        EXPECT_NEAR(mass(i, j) / std::sqrt(mass(i, i) * mass(j, j)), 0.0, 1e-9);
        EXPECT_NEAR(link.G(i, j) / std::sqrt(link.G(i, i) * link.G(j, j)), 0.0, 1e-9);
      }
    }
  }
}

// The stated error of the quadrature: panels twice and four times as fine agree to 1e-13 relative.
TEST(LinkModes, IntegralsAreConverged) {
  const ArmParameters p = ThesisRig();
  const LinkModes link = Link2Modes(p, 6);
  const BeamMode& psi = link.mode.back();
  const auto square = [&](double x, const BeamSection& s) {
    return s.mass_per_length_kg_m() * psi.Value(x) * psi.Value(x);
  };
  const double fine = IntegrateAlong(p.link[1].section, 0.01, square);
  EXPECT_NEAR(link.N(5, 5) / fine, 1.0, 1e-13);
  EXPECT_NEAR(link.second_moment, link.m * 0.81 / 3.0, 1e-15);
}

TEST(LinkModes, DampingReadingsGiveTheirStatedRatios) {
  ArmParameters p = ThesisRig();
  const auto ratio = [&](DampingReading reading, int i) {  // zeta_i = D_ii / (2 w m), m = G_ii/w^2
    p.damping = reading;
    const LinkModes link = Link2Modes(p, 3);
    const double w = link.mode[static_cast<std::size_t>(i)].frequency_rad_s();
    return 0.5 * link.D(i, i) * w / link.G(i, i);
  };
  // zeta = xi (beta L)^2 / 2 for the reading with rho: 0.0318, 0.256 (docs/theory/plant.md 5);
  // sqrt(rho) = 52 times less as printed; xi itself when modal.
  EXPECT_NEAR(ratio(DampingReading::kCurvatureRho, 0), 0.015 * std::pow(1.4551580656, 2), 1e-8);
  EXPECT_NEAR(ratio(DampingReading::kCurvatureRho, 1), 0.015 * std::pow(4.1328908838, 2), 1e-8);
  EXPECT_NEAR(ratio(DampingReading::kCurvatureAsPrinted, 0),
              0.015 * std::pow(1.4551580656, 2) / std::sqrt(2707.0), 1e-9);
  EXPECT_NEAR(ratio(DampingReading::kModal, 2), 0.03, 1e-12);
  EXPECT_EQ(ratio(DampingReading::kNone, 0), 0.0);
}

// The products are those of the cross-section up to rounding, and C_a I = xi L^2 sqrt(rho A EI).
TEST(LinkModes, MassPerLengthAndBendingStiffnessGiveTheLinkOfTheirCrossSection) {
  ArmParameters p = ThesisRig();
  const LinkModes with = Link2Modes(p, 3);
  BeamSection& s = p.link[1].section[0];
  s = {.length_m = s.length_m,
       .area_m2 = 0.0,
       .second_moment_m4 = 0.0,
       .density_kg_m3 = 0.0,
       .youngs_modulus_pa = 0.0,
       .half_thickness_m = s.half_thickness_m,
       .given_mass_per_length_kg_m = s.mass_per_length_kg_m(),
       .given_bending_stiffness_nm2 = s.bending_stiffness_nm2(),
       .has_cross_section = false};
  EXPECT_TRUE(p.Problems().empty());
  const LinkModes without = Link2Modes(p, 3);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(without.mode[i].frequency_rad_s(), with.mode[i].frequency_rad_s());
  }
  EXPECT_LT((without.D - with.D).cwiseAbs().maxCoeff(), 1e-13 * with.D.cwiseAbs().maxCoeff());
  p.damping = DampingReading::kCurvatureAsPrinted;
  ASSERT_EQ(p.Problems().size(), 1U);
  EXPECT_EQ(p.Problems()[0].key, "arm.damping");
}

// docs/theory/plant.md 5: zeta_k = xi (beta_k L)^2 / 2; link 1 (I_r2 at its tip) 0.008, 0.119, link
// 2 0.032, 0.256.
TEST(LinkModes, DampingOfTheRigAgreesWithTheReference) {
  ArmParameters p = ThesisRig();
  p.link1_tip_inertia = Link1TipInertia::kMotor;
  const LinkModes links[] = {Link1Modes(p, 2), Link2Modes(p, 2)};
  const double expected[2][2] = {{0.008, 0.119}, {0.032, 0.256}};
  for (std::size_t link = 0; link < 2; ++link) {
    for (int i = 0; i < 2; ++i) {
      const double w = links[link].mode[static_cast<std::size_t>(i)].frequency_rad_s();
      EXPECT_NEAR(0.5 * links[link].D(i, i) * w / links[link].G(i, i), expected[link][i], 5e-4);
    }
  }
}

}  // namespace
}  // namespace flexarm
