#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "model/reduction/power_balancing.h"
#include "model/reduction/spectral_split.h"

namespace flexarm {

/// A linear system read from a file, in the forms that the order reductions need.
struct LinearSystemFile {
  std::string name;  ///< key "name"; without it the file's name
  StateSpace system;
  /// Its oscillating part without damping; empty if the system does not have the form (6.5).
  std::optional<UndampedSystem> undamped;
  std::string not_undamped;  ///< why `undamped` is missing
  bool damping_left_out;     ///< `undamped` is `system` without its damping, which is not zero
};

/// Reads one JSON object: {"M", "K", optionally "D", "B", "C"} for M q'' + D q' + K q = B u, y = C
/// q with M symmetric positive definite, or {"A", "B", "C"} for x' = A x + B u, y = C x. Matrices
/// are arrays of rows; optionally "name".
/// @throws InputError that names the file, the key, the row, and what was expected
LinearSystemFile LoadLinearSystem(const std::filesystem::path& file);

}  // namespace flexarm
