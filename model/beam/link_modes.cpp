#include "model/beam/link_modes.h"

#include <cmath>

#include "model/beam/quadrature.h"

namespace flexarm {
namespace {

// C_a I of (3.8), per section, by the chosen reading. Units N m^2 s for kCurvatureRho, which needs
// rho A and EI only: C_a I = xi L^2 sqrt(rho A EI).
double DampingStiffness(const BeamSection& s, double xi, double L, DampingReading reading) {
  const double A = s.area_m2, I = s.second_moment_m4, E = s.youngs_modulus_pa;
  switch (reading) {
    case DampingReading::kCurvatureRho:
      if (!s.has_cross_section) {
        return xi * L * L * std::sqrt(s.mass_per_length_kg_m() * s.bending_stiffness_nm2());
      }
      return xi * L * L * std::sqrt(s.density_kg_m3 * A * E / I) * I;
    case DampingReading::kCurvatureAsPrinted:
      return xi * L * L * std::sqrt(A * E / I) * I;
    case DampingReading::kNone:
    case DampingReading::kModal:
      return 0.0;
  }
  return 0.0;
}

// c_i = 2 xi w_i m_i with the modal mass m_i of the clamped link with its tip; modes are
// orthogonal.
Eigen::MatrixXd ModalDamping(const LinkModes& link, const BeamTip& tip, double xi) {
  Eigen::VectorXd c(link.count());
  for (int i = 0; i < link.count(); ++i) {
    const double modal_mass = link.N(i, i) + tip.mass_kg * link.psi_tip[i] * link.psi_tip[i] +
                              tip.inertia_kgm2 * link.slope_tip[i] * link.slope_tip[i];
    c[i] = 2.0 * xi * link.mode[static_cast<std::size_t>(i)].frequency_rad_s() * modal_mass;
  }
  return c.asDiagonal();
}

void FillPairIntegrals(LinkModes* link, const LinkParameters& p, double panel,
                       DampingReading reading) {
  const double L = p.length_m();
  for (int i = 0; i < link->count(); ++i) {
    for (int j = 0; j <= i; ++j) {
      const BeamMode &psi_i = link->mode[static_cast<std::size_t>(i)],
                     &psi_j = link->mode[static_cast<std::size_t>(j)];
      const auto value = [&](double x) { return psi_i.Value(x) * psi_j.Value(x); };
      const auto bend = [&](double x) { return psi_i.Curvature(x) * psi_j.Curvature(x); };
      const auto lam = [&](double x, const BeamSection& s) {
        return s.mass_per_length_kg_m() * value(x);
      };
      const auto EI = [&](double x, const BeamSection& s) {
        return s.bending_stiffness_nm2() * bend(x);
      };
      const auto CaI = [&](double x, const BeamSection& s) {
        return DampingStiffness(s, p.damping_ratio, L, reading) * bend(x);
      };
      link->N(i, j) = link->N(j, i) = IntegrateAlong(p.section, panel, lam);
      link->G(i, j) = link->G(j, i) = IntegrateAlong(p.section, panel, EI);
      link->D(i, j) = link->D(j, i) = IntegrateAlong(p.section, panel, CaI);
    }
  }
}

void FillSingleIntegrals(LinkModes* link, const LinkParameters& p, double panel) {
  for (int i = 0; i < link->count(); ++i) {
    const BeamMode& psi = link->mode[static_cast<std::size_t>(i)];
    link->k[i] = IntegrateAlong(p.section, panel, [&](double x, const BeamSection& s) {
      return s.mass_per_length_kg_m() * psi.Value(x);
    });
    link->a[i] = IntegrateAlong(p.section, panel, [&](double x, const BeamSection& s) {
      return s.mass_per_length_kg_m() * x * psi.Value(x);
    });
    link->psi_tip[i] = psi.Value(link->length_m);
    link->slope_tip[i] = psi.Slope(link->length_m);
  }
  link->m = p.mass_kg();
  link->first_moment = IntegrateAlong(p.section, panel, [](double x, const BeamSection& s) {
    return s.mass_per_length_kg_m() * x;
  });
  link->second_moment = IntegrateAlong(p.section, panel, [](double x, const BeamSection& s) {
    return s.mass_per_length_kg_m() * x * x;
  });
}

LinkModes MakeLinkModes(const LinkParameters& p, const BeamTip& tip, DampingReading reading,
                        int count, const std::string& name) {
  LinkModes link;
  link.mode = ClampedModes(p.section, tip, count, name);
  link.a = link.k = link.psi_tip = link.slope_tip = Eigen::VectorXd::Zero(count);
  link.N = link.G = link.D = Eigen::MatrixXd::Zero(count, count);
  link.length_m = p.length_m();
  double beta_max = 0.0;
  for (const BeamMode::Piece& piece : link.mode.back().piece()) {
    beta_max = std::max(beta_max, piece.beta_per_m);
  }
  link.panel_m = 2.0 / beta_max;
  FillSingleIntegrals(&link, p, link.panel_m);
  FillPairIntegrals(&link, p, link.panel_m, reading);
  if (reading == DampingReading::kModal) link.D = ModalDamping(link, tip, p.damping_ratio);
  return link;
}

}  // namespace

double IntegrateAlong(const std::vector<BeamSection>& section, double panel_m,
                      const std::function<double(double, const BeamSection&)>& f) {
  double sum = 0.0, start = 0.0;
  for (const BeamSection& s : section) {
    const int panels = std::max(1, static_cast<int>(std::ceil(s.length_m / panel_m)));
    const double half = 0.5 * s.length_m / panels;
    for (int i = 0; i < panels; ++i) {
      const double middle = start + half * (2 * i + 1);
      for (std::size_t g = 0; g < kGaussNode.size(); ++g) {
        const double d = half * kGaussNode[g];
        sum += half * kGaussWeight[g] * (f(middle - d, s) + f(middle + d, s));
      }
    }
    start += s.length_m;
  }
  return sum;
}

BeamTip Link1Tip(const ArmParameters& p) {
  const double rotor =
      p.link1_tip_inertia == Link1TipInertia::kMotorAndRotor ? p.joint[1].rotor_inertia_kgm2 : 0.0;
  return {
      .mass_kg = p.motor2_mass_kg + p.hub2_mass_kg + p.link[1].mass_kg() + p.shape_payload_mass_kg,
      .inertia_kgm2 = p.motor2_inertia_kgm2 + rotor};
}

BeamTip Link2Tip(const ArmParameters& p) {
  return {.mass_kg = p.shape_payload_mass_kg, .inertia_kgm2 = p.payload_inertia_kgm2};
}

LinkModes Link1Modes(const ArmParameters& p, int count) {
  return MakeLinkModes(p.link[0], Link1Tip(p), p.damping, count, "link 1");
}

LinkModes Link2Modes(const ArmParameters& p, int count) {
  return MakeLinkModes(p.link[1], Link2Tip(p), p.damping, count, "link 2");
}

}  // namespace flexarm
