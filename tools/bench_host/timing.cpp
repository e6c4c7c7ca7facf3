#include "tools/bench_host/timing.h"

#include <algorithm>
#include <ctime>

namespace flexarm {
namespace {

double Read_s(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double TimeCalls_s(const std::function<void()>& work, std::size_t calls) {
  const double begin_s = ThreadTime_s();
  for (std::size_t i = 0; i < calls; ++i) work();
  return ThreadTime_s() - begin_s;
}

}  // namespace

double Quantile(std::vector<double> samples, double share) {
  std::sort(samples.begin(), samples.end());
  const double place = share * static_cast<double>(samples.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, samples.size() - 1);
  return samples[below] + (place - static_cast<double>(below)) * (samples[above] - samples[below]);
}

Timing TimingOf(const std::vector<double>& samples_s) {
  return {.least_s = Quantile(samples_s, 0.0),
          .median_s = Quantile(samples_s, 0.5),
          .lower_quartile_s = Quantile(samples_s, 0.25),
          .upper_quartile_s = Quantile(samples_s, 0.75),
          .repetitions = samples_s.size()};
}

double ThreadTime_s() { return Read_s(CLOCK_THREAD_CPUTIME_ID); }
double WallTime_s() { return Read_s(CLOCK_MONOTONIC); }

Timing TimeWork(const std::function<void()>& work, const Repetitions& repetitions) {
  work();
  std::size_t calls = 1;
  double taken_s = TimeCalls_s(work, calls);
  while (taken_s < repetitions.each_s) {
    calls *= 2;
    taken_s = TimeCalls_s(work, calls);
  }
  std::vector<double> samples_s;
  for (std::size_t i = 0; i < repetitions.count; ++i) {
    samples_s.push_back(TimeCalls_s(work, calls) / static_cast<double>(calls));
  }
  return TimingOf(samples_s);
}

}  // namespace flexarm
