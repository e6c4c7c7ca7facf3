#include "controller/types/runtime_config.h"

#include <cstddef>

#include "model/problem_list.h"

namespace flexarm {

std::vector<Problem> LoopConfig::Problems() const {
  ProblemList list("loop.");
  list.Within("period_ms", period_ms, 1.0, 100.0,
              "a slower grid undersamples the bending, safety acts every millisecond");
  list.Within("acquire_before_ms", acquire_before_ms, 0.0, 100.0,
              "the time that the buses need to deliver a frame");
  list.Positive("step_deadline_ms", step_deadline_ms, 100.0,
                "a command later than this after its due instant misses its deadline");
  list.Within("output_after_ms", output_after_ms, 0.0, 100.0,
              "from the sampling instant to the output of a torque, with output = \"at_once\"");
  list.Within("actuation_delay_ms", actuation_delay_ms, 0.0, 200.0,
              "the delay of bus and drive from the output to the torque");
  if (!list.empty())
    return list.Take();  // the rules between values assume that each value is valid
  list.Require(acquire_before_ms + step_deadline_ms < period_ms, "step_deadline_ms",
               NumberText(step_deadline_ms),
               "must leave acquire_before_ms + step_deadline_ms below period_ms: " +
                   NumberText(acquire_before_ms) + " + " + NumberText(step_deadline_ms) + " < " +
                   NumberText(period_ms) + " does not hold");
  list.Require(
      output == OutputTiming::kNextTick ||
          (acquire_before_ms + step_deadline_ms <= output_after_ms && output_after_ms <= period_ms),
      "output_after_ms", NumberText(output_after_ms),
      "must lie in acquire_before_ms + step_deadline_ms .. period_ms = " +
          NumberText(acquire_before_ms + step_deadline_ms) + " .. " + NumberText(period_ms) +
          ": a torque is output after the deadline of its step");
  list.Require(actuation_delay_ms <= 2.0 * period_ms, "actuation_delay_ms",
               NumberText(actuation_delay_ms),
               "must be at most two periods of the loop: the prediction stores no older torques");
  return list.Take();
}

std::vector<Problem> DaemonConfig::Problems() const {
  constexpr std::size_t kLongestSocket = 107;  // sockaddr_un::sun_path without its terminating zero
  ProblemList list("");
  list.Require(!socket.empty() && socket.size() <= kLongestSocket, "daemon.socket", socket,
               "must be a path of 1 to 107 bytes: a Unix socket's address holds no more");
  list.Require(socket.find('$') == std::string::npos, "daemon.socket", socket,
               "must be the path itself: environment variables are not expanded");
  list.Require(!state_directory.empty(), "daemon.state_directory", state_directory,
               "must name the directory that keeps a trip over a restart");
  list.Require(!log_directory.empty(), "log.directory", log_directory,
               "must name the directory that holds the run logs");
  list.Within("log.reserve_mb", log.reserve_mb, 0.1, 1e5,
              "the space reserved for the next run; 2 MB are one minute at 50 Hz");
  list.Within("log.keep_free_mb", log.keep_free_mb, 0.0, 1e6,
              "the space that must remain free when a run begins");
  list.Within("log.keep_days", log.keep_days, 0.0, 36525.0,
              "how long runs are kept; 0 keeps them all");
  list.Within("log.keep_total_mb", log.keep_total_mb, 0.0, 1e9,
              "how much all runs may take; 0 keeps them all");
  return list.Take();
}

}  // namespace flexarm
