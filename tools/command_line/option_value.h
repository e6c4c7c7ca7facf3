#pragma once

#include <CLI/CLI.hpp>

namespace flexarm {

/// False for a flag.
inline bool TakesValue(const CLI::Option& option) {
  return option.get_type_size_max() > 0 && option.get_items_expected_max() > 0;
}

}  // namespace flexarm
