#include "hal/emulation/wire_fault.h"

namespace flexarm {
namespace {

constexpr std::array<const char*, kWireFaults> kNames = {"well",
                                                         "silent",
                                                         "late",
                                                         "one-behind",
                                                         "byte-by-byte",
                                                         "wrong-transaction",
                                                         "wrong-protocol",
                                                         "wrong-length",
                                                         "wrong-unit",
                                                         "wrong-function",
                                                         "long-payload",
                                                         "short-payload",
                                                         "huge-payload",
                                                         "bad-checksum",
                                                         "garbage",
                                                         "three-bytes",
                                                         "half-frame",
                                                         "half-frame-then-close",
                                                         "twice",
                                                         "exception",
                                                         "flood",
                                                         "reset",
                                                         "close",
                                                         "never-reads",
                                                         "away"};
static_assert(kNames.back() != nullptr, "every fault must have a name");

}  // namespace

const char* ToString(WireFault fault) noexcept { return kNames[static_cast<std::size_t>(fault)]; }

std::optional<WireFault> WireFaultByName(std::string_view name) noexcept {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<WireFault>(i);
  }
  return std::nullopt;
}

}  // namespace flexarm
