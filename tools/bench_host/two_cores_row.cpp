#include "tools/bench_host/two_cores_row.h"

#include <fmt/format.h>

#include <thread>

#include "tools/sweep/sweep.h"

namespace flexarm {
namespace {

constexpr double kTwoCoresBar = 1.9;

// Wall time of all points of the plan, with a new file of results.
double SweepTime_s(const SweepPlan& plan, std::size_t jobs, const std::filesystem::path& file) {
  std::filesystem::remove(file);
  SweepFile results = SweepFile::Resume(file, IdentityOf(plan));
  const std::vector<std::size_t> points = PointsToRun(&results, {});
  const double begin_s = WallTime_s();
  RunSweep(plan, points, &results, jobs);
  return WallTime_s() - begin_s;
}

}  // namespace

BenchRow TwoCoresRow(const BenchSetting& setting, const std::filesystem::path& scratch) {
  const std::size_t runs = setting.quick ? 2 : 16;
  BenchRow row{.name = "sweep-two-cores",
               .what = "Sweep of " + std::to_string(runs) + " runs on two cores"};
  if (std::thread::hardware_concurrency() < 2) {
    return NotMeasured(row.name, row.what, "this machine has one core: run it on one with more");
  }
  SweepAxis seeds{.target = AxisTarget::kSeed, .key = "", .values = {}};
  for (std::size_t i = 1; i <= runs; ++i) seeds.values.push_back(std::to_string(i));
  const SweepPlan plan{
      .config = setting.config, .experiment = setting.experiment, .grid = SweepGrid({seeds})};
  std::vector<double> one_s, two_s, ratio;
  for (std::size_t i = 0; i < (setting.quick ? 1U : 5U); ++i) {  // in turn: load meets both
    one_s.push_back(SweepTime_s(plan, 1, scratch / "one.sqlite"));
    two_s.push_back(SweepTime_s(plan, 2, scratch / "two.sqlite"));
    ratio.push_back(one_s.back() / two_s.back());
  }
  row.time = TimingOf(two_s);
  row.ratio = {.name = "speed_over_one_core",
               .unit = "times the speed of one core",
               .value = Quantile(ratio, 0.5),
               .bar = kTwoCoresBar};
  row.result = fmt::format("{:.2f} s on one core", Quantile(one_s, 0.5));
  return row;
}

}  // namespace flexarm
