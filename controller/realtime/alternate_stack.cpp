#include "controller/realtime/alternate_stack.h"

#include <cstddef>

namespace flexarm {
namespace {

// The kernel alone stores up to 11 KiB of registers there (AMX); a sanitizer's report needs the
// rest.
constexpr std::size_t kBytes = std::size_t{64} << 10;

}  // namespace

AlternateStack::AlternateStack() {
  stack_t present{};
  if (sigaltstack(nullptr, &present) != 0 || (present.ss_flags & SS_DISABLE) == 0) return;
  // Written to, so that no page is missing when it is needed.
  bytes_.resize(kBytes);
  const stack_t stack{.ss_sp = bytes_.data(), .ss_flags = 0, .ss_size = kBytes};
  if (sigaltstack(&stack, nullptr) != 0) bytes_.clear();
}

AlternateStack::~AlternateStack() {
  if (bytes_.empty()) return;
  const stack_t none{.ss_sp = nullptr, .ss_flags = SS_DISABLE, .ss_size = 0};
  sigaltstack(&none, nullptr);
}

}  // namespace flexarm
