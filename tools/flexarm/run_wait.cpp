#include "tools/flexarm/run_wait.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <ctime>
#include <future>
#include <iostream>
#include <string>

#include "controller/types/rejected_error.h"
#include "tools/command_line/verbs.h"
#include "tools/status/reply.h"
#include "tools/status/status_text.h"

namespace flexarm {
namespace {

constexpr timespec kStatusPause{.tv_sec = 0, .tv_nsec = 100'000'000};
constexpr std::chrono::milliseconds kPlanLook{50};
constexpr double kLineEvery_s = 5.0;
constexpr int kBarWidth = 30;

// How often an interrupt came. Only this program's one thread waits for it.
volatile std::sig_atomic_t interrupts = 0;

void CountInterrupt(int /*signal*/) { interrupts = interrupts + 1; }

/// Counts interrupts instead of ending, until its end.
class InterruptCount {
 public:
  InterruptCount() {
    struct sigaction counting{};
    counting.sa_handler = CountInterrupt;  // no SA_RESTART: a pause ends at once
    sigaction(SIGINT, &counting, &before_int_);
    sigaction(SIGTERM, &counting, &before_term_);
  }
  ~InterruptCount() {
    sigaction(SIGINT, &before_int_, nullptr);
    sigaction(SIGTERM, &before_term_, nullptr);
  }
  InterruptCount(const InterruptCount&) = delete;
  InterruptCount& operator=(const InterruptCount&) = delete;

 private:
  struct sigaction before_int_{}, before_term_{};
};

/// Shows how far a run has come.
class Progress {
 public:
  explicit Progress(bool shown) : shown_(shown), terminal_(shown && isatty(STDOUT_FILENO) == 1) {}
  ~Progress() {
    if (terminal_) std::cout << '\n';
  }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Show(const Reply& run) {
    if (!shown_) return;
    const double elapsed_s = NumberIn(run, "elapsed_s");
    const bool begins = elapsed_s <= 0.0 && !In(run, "duration_s").is_number();
    if (begins || (!terminal_ && elapsed_s < next_s_)) return;
    next_s_ = elapsed_s + kLineEvery_s;
    const std::string line = Bar(run, elapsed_s) + ProgressText(run);
    std::cout << (terminal_ ? "\r" + line + "\033[K" : line + "\n") << std::flush;
  }

 private:
  std::string Bar(const Reply& run, double elapsed_s) const {
    const double duration_s = NumberIn(run, "duration_s");
    if (!terminal_ || duration_s <= 0.0) return {};
    const double share = std::clamp(elapsed_s / duration_s, 0.0, 1.0);
    std::string bar(kBarWidth, '.');
    std::fill_n(bar.begin(), static_cast<int>(share * kBarWidth), '#');
    return "[" + bar + "] ";
  }

  bool shown_, terminal_;
  double next_s_ = 0.0;
};

int Fail(const std::string& what) {
  std::cerr << "flexarm: " << what << '\n';
  return Exit::kFailed;
}

int Ended(const DaemonClient& daemon, const Reply& run) {
  if (daemon.json) std::cout << run.dump(2) << '\n';
  const std::string outcome = TextIn(run, "outcome", "-");
  if (outcome == "done") {
    if (!daemon.json) std::cout << "run: done\n";
    return Exit::kDone;
  }
  const std::string trip = TextIn(run, "trip");
  return Fail("the run was not completed: " + outcome + (trip.empty() ? "" : " by " + trip) +
              (trip.empty() ? "" : "; see `flexarm status`"));
}

/// Sends one `stop` once an interrupt has come.
class StopOnInterrupt {
 public:
  explicit StopOnInterrupt(const DaemonClient& daemon) : daemon_(daemon) {}

  void Look() {
    if (sent_ || interrupts == before_) return;
    sent_ = true;
    daemon_.Ask({{"command", "stop"}});
  }
  bool twice() const { return interrupts - before_ > 1; }

 private:
  const DaemonClient& daemon_;
  int before_ = interrupts;
  bool sent_ = false;
};

// The last status of the run; its "outcome" is "running" if it is left to itself.
Reply Follow(const DaemonClient& daemon, double number, StopOnInterrupt* stop) {
  Progress progress(!daemon.json);
  for (;;) {
    stop->Look();
    Reply run = In(daemon.Ask({{"command", "status"}}), "run");
    if (NumberIn(run, "number", -1.0) != number) return nullptr;
    progress.Show(run);
    if (TextIn(run, "outcome") != "running" || stop->twice()) return run;
    nanosleep(&kStatusPause, nullptr);
  }
}

}  // namespace

int RunAndWait(const DaemonClient& daemon, const Reply& command, double within_s) {
  const InterruptCount counting;
  StopOnInterrupt stop(daemon);
  std::future<Reply> asked =
      std::async(std::launch::async, [&] { return daemon.Ask(command, within_s); });
  while (asked.wait_for(kPlanLook) != std::future_status::ready) stop.Look();
  const Reply answer = asked.get();
  if (!FlagIn(answer, "ok")) return daemon.Conclude(answer);
  Reply run;
  try {
    run = Follow(daemon, NumberIn(answer, "run"), &stop);
  } catch (const RejectedError& error) {
    return Fail("the daemon has ended, or is stuck, during the run: " + std::string(error.what()));
  }
  if (run.is_null()) return Fail("another run has begun: how this one ended is in its log");
  if (TextIn(run, "outcome") == "running") {
    return Fail("interrupted twice: the run goes on; `flexarm stop` stops it");
  }
  return Ended(daemon, run);
}

}  // namespace flexarm
