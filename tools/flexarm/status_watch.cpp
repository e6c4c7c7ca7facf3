#include "tools/flexarm/status_watch.h"

#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string_view>
#include <system_error>

#include "controller/runlog/file_descriptor.h"
#include "tools/command_line/verbs.h"
#include "tools/flexarm/status_feed.h"
#include "tools/status/terminal.h"

namespace flexarm {
namespace {

// So often the age of values that get no younger is shown again.
constexpr int kAgeEvery_ms = 500;
// Of text that is no screen: more than all parts have.
constexpr int kBlockRows = 200;

/// Signals as something to read. The threads that are made later do not get them either. They are
/// blocked until the program ends: a second Ctrl-C while it waits for the last answer does nothing.
class SignalQueue {
 public:
  SignalQueue() {
    sigset_t taken;
    sigemptyset(&taken);
    for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGWINCH, SIGTSTP}) {
      sigaddset(&taken, number);
    }
    pthread_sigmask(SIG_BLOCK, &taken, nullptr);
    queue_ = FileDescriptor(signalfd(-1, &taken, SFD_CLOEXEC | SFD_NONBLOCK));
    if (!queue_.is_open()) throw std::system_error(errno, std::generic_category(), "signalfd");
  }
  int descriptor() const { return queue_.get(); }

  /// The next one; 0: none has come.
  int Take() {
    signalfd_siginfo signal{};
    const ssize_t count = read(queue_.get(), &signal, sizeof signal);
    return count == sizeof signal ? static_cast<int>(signal.ssi_signo) : 0;
  }

 private:
  FileDescriptor queue_;
};

int BlockColumns() {
  const char* told = std::getenv("COLUMNS");
  const std::string_view text = told != nullptr ? told : "";
  int columns = 0;
  std::from_chars(text.data(), text.data() + text.size(), columns);
  return columns > 0 ? columns : 80;
}

/// Shows a status as the reader of standard output wants it.
class View {
 public:
  explicit View(bool json) : json_(json), style_(StyleOfOutput()) {
    if (!json && OutputIsScreen()) screen_ = std::make_unique<Terminal>();
  }

  Terminal* screen() { return screen_.get(); }

  void Show(const WatchedStatus& watched) {
    if (screen_) return screen_->Show(WatchScreen(watched, Terminal::Size(), style_));
    if (json_) {
      ShowLine(watched);
    } else {
      const ScreenSize size{.columns = BlockColumns(), .rows = kBlockRows};
      for (const std::string& line : WatchScreen(watched, size, style_)) std::cout << line << '\n';
      std::cout << '\n';
    }
    std::cout.flush();
  }

 private:
  static void ShowLine(const WatchedStatus& watched) {
    const bool answered = watched.no_answer.empty();
    const Reply line =
        answered ? watched.status : Reply{{"ok", false}, {"error", watched.no_answer}};
    std::cout << line.dump() << '\n';
  }

  bool json_;
  ScreenStyle style_;
  std::unique_ptr<Terminal> screen_;
};

/// The watch goes on until one of these ends it.
class Watch {
 public:
  Watch(const DaemonClient& daemon, double period_s)
      : feed_(daemon, period_s), view_(daemon.json) {}

  void Run() {
    while (!ended_ && std::cout) {
      Await();
      TakeSignals();
      if (view_.screen() != nullptr && view_.screen()->Pressed('q')) ended_ = true;
      if (!ended_ && (news_ || view_.screen() != nullptr)) Show();
    }
  }

 private:
  void Await() {
    std::array<pollfd, 3> sources = {{{.fd = feed_.descriptor(), .events = POLLIN, .revents = 0},
                                      {.fd = signals_.descriptor(), .events = POLLIN, .revents = 0},
                                      {.fd = KeySource(), .events = POLLIN, .revents = 0}}};
    poll(sources.data(), sources.size(), kAgeEvery_ms);
    news_ = sources[0].revents != 0;
  }
  int KeySource() {
    const bool has_keys = view_.screen() != nullptr && view_.screen()->has_keys();
    return has_keys ? STDIN_FILENO : -1;
  }
  void Show() {
    const WatchedStatus watched = feed_.Take();
    const bool asked = watched.status.is_object() || !watched.no_answer.empty();
    if (asked) view_.Show(watched);
  }
  void TakeSignals() {
    while (const int signal = signals_.Take()) {
      if (signal == SIGTSTP) Suspend();
      if (signal != SIGTSTP && signal != SIGWINCH) ended_ = true;
    }
  }
  // Ctrl-Z: the shell gets its terminal; `fg` goes on here.
  void Suspend() {
    if (view_.screen() != nullptr) view_.screen()->Leave();
    raise(SIGSTOP);
    if (view_.screen() != nullptr) view_.screen()->Enter();
  }

  SignalQueue signals_;  // before the thread of the feed: it inherits that they are blocked
  bool ended_ = false, news_ = false;
  StatusFeed feed_;
  View view_;  // ends before the feed, which may wait a second for an answer: the terminal is free
};

}  // namespace

int WatchStatus(const DaemonClient& daemon, double period_s) {
  Watch(daemon, period_s).Run();
  return Exit::kDone;
}

}  // namespace flexarm
