#pragma once

#include <stdexcept>

namespace flexarm {

/// A request that this rig cannot carry out: gains that do not fit, a design that fails its checks,
/// an experiment beyond the limits. what() gives the reason and what was expected. Tools end with
/// exit code 2.
class RejectedError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace flexarm
