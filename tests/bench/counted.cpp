#include "tests/bench/counted.h"

namespace flexarm {

void Counted(const CountedWork& work) { work(); }

}  // namespace flexarm
