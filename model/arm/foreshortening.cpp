#include "model/arm/foreshortening.h"

#include <algorithm>
#include <cmath>

#include "model/beam/quadrature.h"

namespace flexarm {
namespace {

using Eigen::VectorXd;

VectorXd Values(const LinkModes& link, double x) {
  VectorXd out(link.count());
  for (int i = 0; i < link.count(); ++i) out[i] = link.mode[static_cast<std::size_t>(i)].Value(x);
  return out;
}

// psi_i' psi_j' for i <= j, halved on the diagonal: dh/du.
VectorXd SlopeProducts(const LinkModes& link, double x) {
  VectorXd slope(link.count()), out(ProductCount(link.count()));
  for (int i = 0; i < link.count(); ++i) slope[i] = link.mode[static_cast<std::size_t>(i)].Slope(x);
  int n = 0;
  for (int i = 0; i < link.count(); ++i) {
    for (int j = i; j < link.count(); ++j) out[n++] = (i == j ? 0.5 : 1.0) * slope[i] * slope[j];
  }
  return out;
}

VectorXd Increment(const LinkModes& link, double from, double to) {
  VectorXd sum = VectorXd::Zero(ProductCount(link.count()));
  AtGaussNodes(from, to, [&](double x, double weight) { sum += weight * SlopeProducts(link, x); });
  return sum;
}

void AddPanel(const LinkModes& link, double lam, double from, double to, Foreshortening<>* out) {
  AtGaussNodes(from, to, [&](double x, double weight) {
    const VectorXd h = out->tip + Increment(link, from, x);
    const double mass = weight * lam;
    out->k += mass * h;
    out->b += mass * x * h;
    out->C += mass * h * Values(link, x).transpose();
    out->Q += mass * h * h.transpose();
  });
  out->tip += Increment(link, from, to);
}

}  // namespace

Foreshortening<> ForeshorteningOf(const LinkModes& link, const LinkParameters& p) {
  const int n = ProductCount(link.count());
  Foreshortening<> out;
  out.tip = out.k = out.b = VectorXd::Zero(n);
  out.C = Eigen::MatrixXd::Zero(n, link.count());
  out.Q = Eigen::MatrixXd::Zero(n, n);
  double start = 0.0;
  for (const BeamSection& s : p.section) {
    const int panels = std::max(1, static_cast<int>(std::ceil(s.length_m / link.panel_m)));
    const double step = s.length_m / panels;
    for (int i = 0; i < panels; ++i) {
      const double from = start + i * step;
      AddPanel(link, s.mass_per_length_kg_m(), from, from + step, &out);
    }
    start += s.length_m;
  }
  return out;
}

void AddTipMass(const LinkModes& link, double mass_kg, Foreshortening<>* out) {
  out->k += mass_kg * out->tip;
  out->b += mass_kg * link.length_m * out->tip;
  out->C.noalias() += mass_kg * out->tip * link.psi_tip.transpose();
  out->Q.noalias() += mass_kg * out->tip * out->tip.transpose();
}

double TipShortening(const Foreshortening<>& link, const Eigen::Ref<const VectorXd>& phi) {
  double sum = 0.0;
  Eigen::Index n = 0;
  for (Eigen::Index i = 0; i < phi.size(); ++i) {
    for (Eigen::Index j = i; j < phi.size(); ++j) sum += link.tip[n++] * phi[i] * phi[j];
  }
  return sum;
}

}  // namespace flexarm
