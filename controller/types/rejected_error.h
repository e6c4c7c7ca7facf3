#pragma once

#include <stdexcept>

namespace flexarm {

/// What was asked for cannot be done with this rig: gains that do not fit, a design that fails its
/// checks, an experiment beyond the limits. what() says why and what was expected. Tools end with
/// exit code 2.
class RejectedError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace flexarm
