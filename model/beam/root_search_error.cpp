#include "model/beam/root_search_error.h"

#include <array>
#include <charconv>

namespace flexarm {
namespace {

std::string Digits(double value) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end.ptr};
}

}  // namespace

RootSearchError::RootSearchError(const std::string& beam, int mode, double low_rad_s,
                                 double high_rad_s, const std::string& reason)
    : std::runtime_error(beam + ", mode " + std::to_string(mode) + ", between " +
                         Digits(low_rad_s) + " and " + Digits(high_rad_s) + " rad/s: " + reason) {}

}  // namespace flexarm
