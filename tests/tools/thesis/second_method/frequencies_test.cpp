// Statements on natural frequencies a second time: finite elements of the whole arm (fe_arm.h), of
// a link, and influence coefficients, in place of assumed modes and root searches. The config and
// the cases are those of docs/thesis-check.md.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "model/arm/linearization.h"
#include "tests/model/arm/fe_arm.h"
#include "tests/tools/thesis/second_method/element_link.h"
#include "tests/tools/thesis/second_method/shipped_arm.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using second_method::ElementLink;

constexpr int kElements = 30;  // an element less than a tenth of the shortest wave

// Largest relative difference of the lowest two frequencies with motors free and held.
double Difference(const ArmParameters& arm) {
  const ArmModel modes(arm, {4, 4});
  const FeArm elements(arm, 0.0, kElements);
  const auto worst = [](const VectorXd& a, const VectorXd& b) {
    return (a.head(2).array() / b.head(2).array() - 1.0).abs().maxCoeff();
  };
  const double d =
      std::max(worst(FreeMotorFrequenciesHz(modes, 0.0), elements.FreeFrequenciesHz()),
               worst(HeldMotorFrequenciesHz(modes, 0.0), elements.HeldFrequenciesHz()));
  printf("D %g\n", d);
  return d;
}

ArmParameters Changed(const std::function<void(ArmParameters*)>& change) {
  ArmParameters arm = ShippedArm();
  change(&arm);
  return arm;
}

void ScaleLength(LinkParameters* link, double to_m) { link->section.front().length_m = to_m; }

// A link with what its tip carries in the mode shapes of the product.
ElementLink ElementsOf(const ArmParameters& p, std::size_t i) {
  const BeamSection& section = p.link[i].section.front();
  if (i == 1) {
    return {section, p.shape_payload_mass_kg, p.payload_inertia_kgm2, kElements, 2};
  }
  return {section,
          p.motor2_mass_kg + p.hub2_mass_kg + p.link[1].mass_kg() + p.shape_payload_mass_kg,
          p.motor2_inertia_kgm2 + p.joint[1].rotor_inertia_kgm2, kElements, 2};
}

// The error of four assumed modes: 4.4e-5 at most, measured.
constexpr double kSameFrequency = 1e-4;

// 4.2.1, 4.3: links a tenth longer, a tenth thinner, of exchanged lengths, of Table 2's material
// and of a thousand times its inertias.
TEST(SecondMethod, FrequenciesOfChangedArmsOfChapter4) {
  const std::function<void(ArmParameters*)> changes[] = {
      [](ArmParameters*) {},
      [](ArmParameters* p) {
        for (LinkParameters& link : p->link) ScaleLength(&link, 1.1 * link.length_m());
      },
      [](ArmParameters* p) {
        for (LinkParameters& link : p->link) {
          link.section.front().area_m2 *= 0.9;
          link.section.front().second_moment_m4 *= 0.9 * 0.9 * 0.9;
        }
      },
      [](ArmParameters* p) {
        ScaleLength(&p->link.front(), 0.9);
        ScaleLength(&p->link[1], 0.8);
      },
      [](ArmParameters* p) {
        for (LinkParameters& link : p->link) {
          link.section.front().youngs_modulus_pa *= 10.0;
          link.section.front().density_kg_m3 *= 10.0;
        }
      },
      [](ArmParameters* p) {
        for (JointParameters& joint : p->joint) joint.hub_inertia_kgm2 *= 1000.0;
        p->payload_inertia_kgm2 *= 1000.0;
      }};
  for (const auto& change : changes) EXPECT_LT(Difference(Changed(change)), kSameFrequency);
}

// 5.2, 7.4: over the payloads, the joints' stiffnesses and the lengths of chapter 5.
TEST(SecondMethod, FrequenciesOverTheParametersOfChapter5) {
  for (const double kg : {0.0, 0.01, 0.1, 0.2, 0.5, 1.0}) {
    EXPECT_LT(Difference(Changed([kg](ArmParameters* p) { p->payload_mass_kg = kg; })),
              kSameFrequency)
        << kg;
  }
  for (const double times : {0.25, 1.0, 4.0}) {
    for (const std::size_t joint : {0U, 1U}) {
      EXPECT_LT(Difference(Changed(
                    [&](ArmParameters* p) { p->joint[joint].stiffness_nm_per_rad *= times; })),
                kSameFrequency);
    }
  }
  for (const double length_m : {0.4, 0.6, 1.2}) {
    for (const std::size_t link : {0U, 1U}) {
      EXPECT_LT(
          Difference(Changed([&](ArmParameters* p) { ScaleLength(&p->link[link], length_m); })),
          kSameFrequency);
    }
  }
}

// 3.6: two modes a link against all, by a model restricted to two shapes of elements.
TEST(SecondMethod, TwoModesALinkErrBySoMuch) {
  const ArmParameters arm = ShippedArm();
  const VectorXd two = FreeMotorFrequenciesHz(ArmModel(arm, {2, 2}), 0.0),
                 all = FeArm(arm, 0.0, kElements).FreeFrequenciesHz();
  const double percent[] = {0.019, 0.29, 0.16, 0.047};
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(100.0 * (two[i] / all[i] - 1.0), percent[i], 0.006) << i;
  }
}

// 4.2.1: under a force at its end.
TEST(SecondMethod, LinksBendSoManyTimesAsFarAsTheirJointsTurnThem) {
  const ArmParameters arm = ShippedArm();
  const double expected[] = {11.1, 27.1};
  for (const std::size_t i : {0U, 1U}) {
    const ElementLink link(arm.link[i].section.front(), 0.0, 0.0, kElements, 10);
    // Static deflection by all modes of a link without a tip: converges as 1/k^4.
    const double bends = link.stiffness.diagonal().cwiseInverse().sum();
    const double turns = link.length_m * link.length_m / arm.joint[i].stiffness_nm_per_rad;
    EXPECT_NEAR(bends / turns, expected[i], 0.06);
  }
}

// 3.3: zeta_k = xi L^2 sqrt(rho A / EI) omega_k / 2.
TEST(SecondMethod, DampingRatiosOfTheLinks) {
  const ArmParameters arm = ShippedArm();
  const double expected[2][2] = {{0.00783, 0.0929}, {0.0318, 0.256}};
  for (const std::size_t i : {0U, 1U}) {
    const ElementLink link = ElementsOf(arm, i);
    for (const Eigen::Index k : {0, 1}) {
      const double zeta = 0.5 * arm.link[i].damping_ratio * link.length_m * link.length_m *
                          std::sqrt(link.mass_per_m / link.bending_nm2) * link.frequency_rad_s[k];
      EXPECT_NEAR(zeta / expected[i][k], 1.0, 0.006);
    }
  }
}

// 3.2: what the clamp of link 1 holds at 1 and 5 mm of tip deflection, and its frequency.
TEST(SecondMethod, MomentOfTheClamp) {
  const ArmParameters arm = ShippedArm();
  const ElementLink link = ElementsOf(arm, 0);
  const double nm_per_m = link.bending_nm2 * std::abs(link.root_curve[0]);
  EXPECT_NEAR(1e-3 * nm_per_m, 0.0856, 5e-5);
  EXPECT_NEAR(5e-3 * nm_per_m, 0.428, 5e-4);
  EXPECT_NEAR(link.frequency_rad_s[0] / (2.0 * M_PI), 0.851, 5e-4);
}

// 3.2: lumps on a beam by influence coefficients, x^2 (3 y - x) / 6 EI, in place of pivots and
// transfer matrices; exact frequencies by the known roots of 1 + cos cosh.
TEST(SecondMethod, LumpsOnABeam) {
  const double root[] = {1.87510406871196, 4.69409113297418, 7.85475743823761, 10.9955407348755};
  const auto percent = [&](int parts, int mode) {
    MatrixXd influence(parts, parts);
    for (int i = 0; i < parts; ++i) {
      for (int j = 0; j < parts; ++j) {
        const double x = std::min(i, j) + 1.0, y = std::max(i, j) + 1.0;
        influence(i, j) = x * x * (3.0 * y - x) / 6.0 / std::pow(parts, 4);
        if (j == parts - 1) influence(i, j) *= 0.5;  // half a part's mass at the end
      }
    }
    VectorXd squares = influence.eigenvalues().real().cwiseInverse();
    std::sort(squares.begin(), squares.end());
    return 100.0 * (std::sqrt(squares[mode]) / (root[mode] * root[mode]) - 1.0);
  };
  const double expected[] = {-0.457, -1.56, -2.55, -3.57};
  for (int mode = 0; mode < 4; ++mode) {
    EXPECT_NEAR(percent(10, mode), expected[mode], 0.005);
  }
  EXPECT_GT(std::abs(percent(30, 0)), 0.05);
  EXPECT_LT(std::abs(percent(31, 0)), 0.05);
  EXPECT_GT(std::abs(percent(85, 3)), 0.05);
  EXPECT_LT(std::abs(percent(86, 3)), 0.05);
}

}  // namespace
}  // namespace flexarm
