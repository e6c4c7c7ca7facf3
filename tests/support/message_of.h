#pragma once

#include <string>

namespace flexarm {

/// The message of the `Error` that `action` throws; "" if it does not throw.
template <typename Error, typename Action>
std::string MessageOf(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace flexarm
