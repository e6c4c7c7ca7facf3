#pragma once

#include <string>

#include "controller/types/rejected_error.h"

namespace flexarm {

/// A request that is refused for a reason with a machine name, one of RefusalList
/// (controller/operator/refusal_list.h): key `refusal` of the answer.
class NamedRejection : public RejectedError {
 public:
  NamedRejection(const char* name, const std::string& text) : RejectedError(text), name_(name) {}
  const char* name() const noexcept { return name_; }

 private:
  const char* name_;  // a literal
};

}  // namespace flexarm
