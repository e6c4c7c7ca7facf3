#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/problem.h"

namespace flexarm {

/// A number as the shortest text that parses to the same number: "0.1", "6.89e+10".
template <typename Number>
std::string NumberText(Number value) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end};
}

/// Collects violated rules: the body of every Problems(). Allocates: start-up only.
///
/// Rules are written so that a NaN violates them. `why` states what the rule protects.
class ProblemList {
 public:
  /// `section` is the prefix of every key, e.g. "loop."; "" for none.
  explicit ProblemList(std::string section) : section_(std::move(section)) {}

  /// Records the problem unless `ok`.
  void Require(bool ok, std::string_view key, std::string value, std::string rule) {
    if (!ok) list_.push_back({section_ + std::string(key), std::move(value), std::move(rule)});
  }

  /// low <= value <= high
  template <typename Number>
  void Within(std::string_view key, Number value, Number low, Number high, std::string_view why) {
    Require(value >= low && value <= high, key, NumberText(value),
            "must lie in " + NumberText(low) + " .. " + NumberText(high) + ": " + std::string(why));
  }

  /// 0 < value <= high
  void Positive(std::string_view key, double value, double high, std::string_view why) {
    Require(value > 0.0 && value <= high, key, NumberText(value),
            "must be above 0 and at most " + NumberText(high) + ": " + std::string(why));
  }

  /// Each element: low <= value <= high
  template <std::size_t n>
  void EachWithin(std::string_view key, const std::array<double, n>& values, double low,
                  double high, std::string_view why) {
    for (std::size_t i = 0; i < n; ++i) Within(Element(key, i), values[i], low, high, why);
  }

  /// Each element: 0 < value <= high
  template <std::size_t n>
  void EachPositive(std::string_view key, const std::array<double, n>& values, double high,
                    std::string_view why) {
    for (std::size_t i = 0; i < n; ++i) Positive(Element(key, i), values[i], high, why);
  }

  /// "key[2]": the name of an element or a row in messages, counted from 0.
  static std::string Element(std::string_view key, std::size_t i) {
    return std::string(key) + "[" + NumberText(i) + "]";
  }

  /// True while no rule is violated: rules between several values can be checked.
  bool empty() const { return list_.empty(); }
  std::vector<Problem> Take() { return std::move(list_); }

 private:
  std::string section_;
  std::vector<Problem> list_;
};

}  // namespace flexarm
