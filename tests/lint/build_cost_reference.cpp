// What tools/lint/build_cost.py compares the product's compile times with: headers and templates of
// the kind that the product uses, and nothing of this tree. A change here changes every figure.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace {

template <int kSize>
double Solved(double seed) {
  using Square = Eigen::Matrix<double, kSize, kSize>;
  using Column = Eigen::Matrix<double, kSize, 1>;
  Square square = Square::Identity() * seed;
  square.template triangularView<Eigen::Upper>().setConstant(0.5 * seed);
  const Column column = Column::LinSpaced(kSize, 0.0, seed);
  const Column solved = square.template triangularView<Eigen::Upper>().solve(column);
  return (square * solved).squaredNorm() + (square * square.transpose()).trace();
}

std::map<std::string, std::vector<double>> Named(int count) {
  std::map<std::string, std::vector<double>> named;
  for (int i = 0; i < count; ++i) {
    named["value " + std::to_string(i)].push_back(std::sqrt(i));
  }
  for (auto& [name, values] : named) {
    std::sort(values.begin(), values.end(), std::greater<>());
  }
  return named;
}

}  // namespace

double Reference(double seed) {
  const std::array<std::function<double(double)>, 2> functions{Solved<3>, Solved<4>};
  std::optional<double> sum;
  for (const auto& function : functions) {
    sum = sum.value_or(0.0) + function(seed);
  }
  return *sum + static_cast<double>(Named(4).size());
}
