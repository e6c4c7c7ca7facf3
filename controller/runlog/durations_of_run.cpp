#include "controller/runlog/durations_of_run.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace flexarm {
namespace {

struct PathSample {
  int sample;  // of the experiment
  bool moves;
};

std::vector<PathSample> PathOf(std::span<const TickRecord> ticks) {
  std::vector<PathSample> path;
  int number = 0, delay_found = 0;
  for (const TickRecord& record : ticks) {
    if (record.input.safety_state != SafetyState::kRunning) {
      if (number > 0) break;
      continue;
    }
    if (record.input.reset != 0) delay_found = 0;
    const auto& rate_rad_s = record.input.path[1].rate_rad_s;
    path.push_back(
        {.sample = number + delay_found, .moves = rate_rad_s[0] != 0.0 || rate_rad_s[1] != 0.0});
    delay_found = int{record.output.delay_found};
    ++number;
  }
  return path;
}

// The periods of the move from sample `first` on; nothing if the path still moves at its end.
std::optional<int> PeriodsOf(const std::vector<PathSample>& path, int first, int until) {
  int last_moving = first;
  bool ended = false;
  for (const PathSample& at : path) {
    if (at.sample < first || at.sample >= until) continue;
    if (at.moves) last_moving = std::max(last_moving, at.sample);
    ended = !at.moves;
  }
  if (!ended || last_moving == first) return std::nullopt;
  return last_moving + 1 - first;
}

}  // namespace

Experiment WithDurationsOfRun(const Experiment& experiment, std::span<const TickRecord> ticks,
                              double period_s) {
  Experiment of_run = experiment;
  if (std::none_of(experiment.move.begin(), experiment.move.end(),
                   [](const Move& move) { return move.shortest; })) {
    return of_run;
  }
  const auto on_grid = [&](double time_s) {
    return static_cast<int>(std::lround(time_s / period_s));
  };
  const std::vector<PathSample> path = PathOf(ticks);
  for (std::size_t i = 0; i < of_run.move.size(); ++i) {
    Move& move = of_run.move[i];
    if (!move.shortest) continue;
    const int until = i + 1 < of_run.move.size() ? on_grid(of_run.move[i + 1].start_s)
                                                 : std::numeric_limits<int>::max();
    const auto periods = PeriodsOf(path, on_grid(move.start_s), until);
    // To the microsecond, as in a file.
    if (periods) move.duration_s = std::round(1e6 * *periods * period_s) / 1e6;
  }
  return of_run;
}

}  // namespace flexarm
