#include "controller/host/crash_handler.h"

#include <poll.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>

namespace flexarm {
namespace {

// A handler has no argument of its own. Written before the handlers are installed.
std::atomic<const CrashHandler::PowerOff*> power_off_at_crash{nullptr};
std::array<struct sigaction, kCrashSignals.size()> actions_before{};

/// One line of text in a buffer of its own: snprintf is not async-signal-safe.
class CrashLine {
 public:
  CrashLine& operator<<(const char* text) noexcept {
    const std::size_t count = std::min(std::strlen(text), buffer_.size() - length_);
    std::memcpy(buffer_.data() + length_, text, count);
    length_ += count;
    return *this;
  }
  CrashLine& Hex(std::uintptr_t value) noexcept {
    std::array<char, 2 * sizeof value + 1> digits{};
    std::size_t at = digits.size() - 1;
    do {
      digits[--at] = "0123456789abcdef"[value & 0xfU];
      value >>= 4U;
    } while (value != 0);
    return *this << "0x" << digits.data() + at;
  }

  // A pipe that is full would hold the process, which is to end: the line is lost then. A pipe that
  // is ready takes this many bytes (PIPE_BUF).
  void WriteUnlessItWaits() const noexcept {
    pollfd ready{.fd = STDERR_FILENO, .events = POLLOUT, .revents = 0};
    if (poll(&ready, 1, 0) != 1 || (ready.revents & POLLOUT) == 0) return;
    [[maybe_unused]] const ssize_t count = write(STDERR_FILENO, buffer_.data(), length_);
  }

 private:
  std::array<char, 240> buffer_{};
  std::size_t length_ = 0;
};

const char* NameOf(int signal) noexcept {
  switch (signal) {
    case SIGILL:
      return "SIGILL";
    case SIGTRAP:
      return "SIGTRAP";
    case SIGABRT:
      return "SIGABRT";
    case SIGBUS:
      return "SIGBUS";
    case SIGFPE:
      return "SIGFPE";
    case SIGSEGV:
      return "SIGSEGV";
    default:
      return "SIGSYS";
  }
}

// An instruction that failed fails again when the handler returns. What another process sent, and
// abort() or a trap, must be raised again.
bool ComesAgain(int signal, const siginfo_t& info) noexcept {
  return info.si_code > 0 &&
         (signal == SIGSEGV || signal == SIGBUS || signal == SIGFPE || signal == SIGILL);
}

void TakePowerAway() noexcept {
  const CrashHandler::PowerOff* power_off = power_off_at_crash.load();
  if (power_off != nullptr) power_off->call(power_off->context);
}

void Handle(int signal, siginfo_t* info, void* /*context*/) noexcept {
  TakePowerAway();
  std::array<char, 16> thread{};
  prctl(PR_GET_NAME, thread.data());
  thread.back() = '\0';
  CrashLine line;
  line << "flexarmd: " << NameOf(signal) << " in thread '" << thread.data() << "'";
  if (info->si_code > 0 && signal != SIGSYS && signal != SIGABRT) {
    line << " at address ";
    line.Hex(reinterpret_cast<std::uintptr_t>(info->si_addr));
  }
  line << ": relay and charge pump are off, the daemon ends\n";
  line.WriteUnlessItWaits();
  // The safety thread may have been writing the lines during the first call: it has ended by now,
  // and every later write is off.
  poll(nullptr, 0, 1);
  TakePowerAway();
  const auto* at = std::find(kCrashSignals.begin(), kCrashSignals.end(), signal);
  sigaction(signal, &actions_before[static_cast<std::size_t>(at - kCrashSignals.begin())], nullptr);
  if (!ComesAgain(signal, *info)) raise(signal);
}

}  // namespace

CrashHandler::CrashHandler(const PowerOff& power_off) : power_off_(power_off) {
  power_off_at_crash.store(&power_off_);
  struct sigaction action{};
  action.sa_sigaction = Handle;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigfillset(&action.sa_mask);
  for (std::size_t i = 0; i < kCrashSignals.size(); ++i) {
    sigaction(kCrashSignals[i], &action, &actions_before[i]);
  }
}

CrashHandler::~CrashHandler() {
  for (std::size_t i = 0; i < kCrashSignals.size(); ++i) {
    sigaction(kCrashSignals[i], &actions_before[i], nullptr);
  }
  power_off_at_crash.store(nullptr);
}

}  // namespace flexarm
