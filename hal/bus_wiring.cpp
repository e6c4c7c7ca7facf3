#include "hal/bus_wiring.h"

#include <set>

namespace flexarm {

std::int64_t BusCost::other_ns() const {
  std::int64_t rest_ns = worst_ns;
  std::set<int> counted;
  for (const ChannelCost& cost : channel) {
    if (counted.insert(cost.transaction).second) rest_ns -= cost.cost_ns;
  }
  return rest_ns;
}

}  // namespace flexarm
