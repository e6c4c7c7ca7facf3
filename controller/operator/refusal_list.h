#pragma once

#include <span>

namespace flexarm {

/// A reason for which the daemon refuses a command.
struct RefusalAdvice {
  const char* name;             ///< key `refusal` of the answer: "no-log"
  const char* commands;         ///< that it may answer: "arm, run"
  const char* happened;         ///< and what it means
  const char* check;            ///< how to find which of the causes it was
  const char* remedy;           ///< what to do
  const char* override_option;  ///< option that does without the condition; "": there is none
};

/// Every name that the daemon may answer as `refusal`, in the order in which a command meets them.
std::span<const RefusalAdvice> RefusalList() noexcept;

}  // namespace flexarm
