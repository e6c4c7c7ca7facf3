#include "controller/runtime/runtime_config.h"

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
  if (!list.empty()) return list.Take();  // rules between values need sound values
  list.Require(acquire_before_ms + step_deadline_ms < period_ms, "step_deadline_ms",
               NumberText(step_deadline_ms),
               "must leave acquire_before_ms + step_deadline_ms below period_ms: " +
                   NumberText(acquire_before_ms) + " + " + NumberText(step_deadline_ms) + " < " +
                   NumberText(period_ms) + " does not hold");
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
