#pragma once

#include <array>
#include <cstddef>

namespace flexarm {

/// 10-point Gauss-Legendre rule on [-1, 1], symmetric: exact to degree 19.
/// Source: Abramowitz and Stegun, table 25.4.
inline constexpr std::array<double, 5> kGaussNode = {0.14887433898163121089, 0.43339539412924719080,
                                                     0.67940956829902440623, 0.86506336668898451073,
                                                     0.97390652851717172008};
inline constexpr std::array<double, 5> kGaussWeight = {
    0.29552422471475287017, 0.26926671930999635509, 0.21908636251598204400, 0.14945134915058059315,
    0.06667134430868813759};

/// Calls f(x, weight) at every node of the rule on [from, to].
template <typename Function>
void AtGaussNodes(double from, double to, const Function& f) {
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  for (std::size_t i = 0; i < kGaussNode.size(); ++i) {
    f(middle - half * kGaussNode[i], half * kGaussWeight[i]);
    f(middle + half * kGaussNode[i], half * kGaussWeight[i]);
  }
}

}  // namespace flexarm
