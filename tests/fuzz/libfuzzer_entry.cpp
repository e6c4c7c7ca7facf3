// The program of one target: FLEXARM_FUZZ_TARGET is its function.

#include <cstddef>
#include <cstdint>

#include "tests/fuzz/fuzz_targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  flexarm::FLEXARM_FUZZ_TARGET({data, size});
  return 0;
}
