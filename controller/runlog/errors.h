#pragma once

#include <stdexcept>

namespace flexarm {

/// An input file is not valid. what() gives the file, what was found and what was expected. Tools
/// end with exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A run log could not be written. what() says the file and the cause.
class RunLogError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace flexarm
