#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "config/derivation/derivation.h"
#include "model/problem_list.h"

namespace flexarm {

/// Collects derived values, rounded to three significant digits.
class DerivedList {
 public:
  void Number(std::string key, double value, std::string how) {
    list_.push_back({std::move(key), {Rounded(value)}, false, false, std::move(how)});
  }
  /// The same for every arm: `how` begins with the value.
  void Constant(std::string key, double value, const std::string& how) {
    Number(std::move(key), value, NumberText(value) + ", " + how);
  }
  void Whole(std::string key, int value, std::string how) {
    list_.push_back({std::move(key), {static_cast<double>(value)}, false, true, std::move(how)});
  }
  /// Not rounded.
  void Exact(std::string key, double value, std::string how) {
    list_.push_back({std::move(key), {value}, false, false, std::move(how)});
  }
  template <std::size_t n>
  void List(std::string key, const std::array<double, n>& values, std::string how) {
    DerivedValue& row = list_.emplace_back(DerivedValue{std::move(key), {}, true, false, {}});
    for (const double value : values) row.value.push_back(Rounded(value));
    row.how = std::move(how);
  }
  std::vector<DerivedValue> Take() { return std::move(list_); }

 private:
  static double Rounded(double value) {
    if (value == 0.0 || !std::isfinite(value)) return value;
    const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 2.0);
    const double steps = std::round(value / unit);
    // Divides for a unit below 1, so that 0.01 is the double nearest to it.
    return unit < 1.0 ? steps / std::round(1.0 / unit) : steps * unit;
  }

  std::vector<DerivedValue> list_;
};

}  // namespace flexarm
