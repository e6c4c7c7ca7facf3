#include "tools/bench_host/bench_row.h"

#include <utility>

namespace flexarm {

BenchRow NotMeasured(std::string name, std::string what, std::string why) {
  return {.name = std::move(name), .what = std::move(what), .not_measured = std::move(why)};
}

std::optional<double> BoundShare(const BenchRow& row, double bound_flops_per_s) {
  if (!row.work || !row.time || row.time->median_s <= 0.0) return std::nullopt;
  return static_cast<double>(row.work->flops) / row.time->median_s / bound_flops_per_s;
}

void AddCount(BenchRow* row, const CountResult& counted) {
  if (counted.counted()) {
    row->work = counted.count;
    row->counted = kSingleStepped;
  } else {
    row->counted = "not counted: " + counted.problem;
  }
}

}  // namespace flexarm
