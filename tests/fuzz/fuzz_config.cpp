#include <cstdlib>
#include <string>

#include "config/config.h"
#include "tests/fuzz/fuzz_targets.h"

namespace flexarm {

// What is accepted is stored as text in every log, and must be accepted again, as the same text.
void FuzzConfig(FuzzBytes input) {
  try {
    const RigConfig config = ParseConfig(TextOf(input), "input");
    if (ParseConfig(config.text, "log").text != config.text) std::abort();
  } catch (const ConfigError& error) {
    if (error.problems().empty()) std::abort();
  }
}

}  // namespace flexarm
