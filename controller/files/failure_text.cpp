#include "controller/files/failure_text.h"

#include <new>
#include <nlohmann/json.hpp>

#include "controller/files/external_text.h"

namespace flexarm {

std::string FailureText(const std::exception& error) {
  if (dynamic_cast<const nlohmann::detail::exception*>(&error) != nullptr) {
    return "found a JSON value of another type than expected";
  }
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
    return "there is not enough memory for this";
  }
  return ShownMessage(error.what());
}

}  // namespace flexarm
