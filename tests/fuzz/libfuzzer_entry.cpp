// The program of one target: FLEXARM_FUZZ_TARGET is its function.

#include <cstddef>
#include <cstdint>

#include "tests/fuzz/fuzz_targets.h"

// The first input makes what all share, such as a design, and may take longer than the limit of an
// input: it is an empty one, before the clock runs.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  flexarm::FLEXARM_FUZZ_TARGET({});
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  flexarm::FLEXARM_FUZZ_TARGET({data, size});
  return 0;
}
