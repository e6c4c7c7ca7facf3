#include "model/beam/beam_basis.h"

#include <cmath>
#include <utility>

namespace flexarm {
namespace {

// sum over k of z^(4k+first) / (4k+first)!: first = 0, 1, 2, 3 gives S, T, U, V. For z < 2 the
// eighth term is below 1e-22 of the first.
double KrylovSeries(double z, int first) {
  double term = 1.0;
  for (int i = 1; i <= first; ++i) term *= z / i;
  double sum = 0.0;
  for (int k = 0; k < 8; ++k) {
    sum += term;
    for (int i = 1; i <= 4; ++i) term *= z / (4 * k + first + i);
  }
  return sum;
}

}  // namespace

std::array<double, 4> BeamBasis(bool decaying, double beta_per_m, double length_m, double x_m,
                                int order) {
  const double z = beta_per_m * x_m;
  std::array<double, 4> f{};
  if (!decaying) {  // S' = V, T' = S, U' = T, V' = U
    for (int i = 0; i < 4; ++i) {
      f[static_cast<std::size_t>(i)] = KrylovSeries(z, (i - order + 4) % 4);
    }
    return f;
  }
  const double c = std::cos(z), s = std::sin(z);
  const std::array<std::pair<double, double>, 4> turn = {{{c, s}, {-s, c}, {-c, -s}, {s, -c}}};
  const auto [dcos, dsin] = turn[static_cast<std::size_t>(order)];
  const double decay = std::exp(-z);
  f = {dcos, dsin, order % 2 == 0 ? decay : -decay, std::exp(-beta_per_m * (length_m - x_m))};
  return f;
}

}  // namespace flexarm
