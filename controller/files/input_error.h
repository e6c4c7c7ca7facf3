#pragma once

#include <stdexcept>

namespace flexarm {

/// A file that the user named cannot be used. what() gives the file, what was found and what was
/// expected. Tools end with exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace flexarm
