#pragma once

#include <functional>

namespace flexarm {

/// A call whose instructions callgrind counts. A class of its own, because callgrind knows a
/// function by its signature, which must not contain a `*`.
struct CountedWork final : std::function<void()> {
  using std::function<void()>::function;
};

/// Does the work. tests/bench/callgrind.py has callgrind collect within this function alone.
void Counted(const CountedWork& work);

}  // namespace flexarm
