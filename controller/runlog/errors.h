#pragma once

#include <stdexcept>

#include "controller/files/input_error.h"  // IWYU pragma: export

namespace flexarm {

/// A run log could not be written. what() says the file and the cause.
class RunLogError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace flexarm
