#pragma once

#include <stdexcept>
#include <string>

namespace flexarm {

/// A natural frequency was not found: names the beam, the mode and the interval searched.
/// what() reads "link 2, mode 4, between 0 and 5e3 rad/s: ...".
class RootSearchError : public std::runtime_error {
 public:
  /// @param mode  number of the mode, from 1
  RootSearchError(const std::string& beam, int mode, double low_rad_s, double high_rad_s,
                  const std::string& reason);
};

}  // namespace flexarm
