#include "controller/types/runtime_config.h"

#include <cstddef>

#include "model/problem_list.h"

namespace flexarm {

std::vector<Problem> LoopConfig::Problems() const {
  ProblemList list("loop.");
  list.Within("period_ms", period_ms, 5.0, 100.0,
              "a slower grid cannot see the arm bend at 9 Hz, the buses do not serve a faster one");
  list.Within("acquire_before_ms", acquire_before_ms, 0.0, 100.0,
              "the time that the buses need to bring a frame");
  list.Positive("step_deadline_ms", step_deadline_ms, 100.0,
                "a command later than this after its release missed its deadline");
  list.Within("output_after_ms", output_after_ms, 0.0, 100.0,
              "when a torque that is put out at once leaves for the drives");
  list.Within("actuation_delay_ms", actuation_delay_ms, 0.0, 200.0,
              "what bus and drive need from the output to the torque");
  if (!list.empty()) return list.Take();  // rules between values need sound values
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
          ": a step has its deadline, then its torque is put out");
  list.Require(actuation_delay_ms <= 2.0 * period_ms, "actuation_delay_ms",
               NumberText(actuation_delay_ms),
               "must be at most two periods of the loop: the prediction remembers no further");
  return list.Take();
}

std::vector<Problem> DaemonConfig::Problems() const {
  constexpr std::size_t kLongestSocket = 107;  // sockaddr_un::sun_path less its final zero
  ProblemList list("");
  list.Require(!socket.empty() && socket.size() <= kLongestSocket, "daemon.socket", socket,
               "must be a path of 1 to 107 bytes: a Unix socket's address holds no more");
  list.Require(socket.find('$') == std::string::npos, "daemon.socket", socket,
               "must be the path itself: environment variables are not expanded");
  list.Require(!log_directory.empty(), "log.directory", log_directory,
               "must name the directory that holds the run logs");
  return list.Take();
}

}  // namespace flexarm
