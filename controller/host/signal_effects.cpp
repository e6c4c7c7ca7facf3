#include "controller/host/signal_effects.h"

#include <pthread.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <ctime>

namespace flexarm {
namespace {

// SIGXCPU: the kernel warns a program that exceeds its processor time a second before it kills it.
constexpr std::array kEndSignals = {SIGTERM, SIGINT, SIGQUIT, SIGXCPU, SIGPWR};

// SIGPIPE, SIGXFSZ: the write fails, and is reported. SIGTSTP, SIGTTIN, SIGTTOU: a terminal would
// stop all threads of a daemon in mid-run.
constexpr std::array kIgnoredSignals = {SIGPIPE, SIGXFSZ, SIGUSR1,   SIGUSR2, SIGALRM, SIGVTALRM,
                                        SIGPROF, SIGIO,   SIGSTKFLT, SIGTSTP, SIGTTIN, SIGTTOU};

// 32 and 33 belong to the C library, whose sigaction refuses them, and which installs its own
// handlers if it needs them. Nothing here does; until then they would end the process.
void IgnoreSignalsOfTheLibrary() {
  struct KernelAction {  // the beginning is the same on every processor; 64 signals are 8 bytes
    void (*handler)(int);
    std::array<unsigned long, 4> rest;
  };
  const KernelAction ignore{.handler = SIG_IGN, .rest = {}};
  constexpr std::size_t kSetBytes = 8;
  for (const int signal : {32, 33}) {
    syscall(SYS_rt_sigaction, signal, &ignore, nullptr, kSetBytes);
  }
}

}  // namespace

void IgnoreOtherSignals() {
  for (const int signal : kIgnoredSignals) std::signal(signal, SIG_IGN);
  for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) std::signal(signal, SIG_IGN);
  IgnoreSignalsOfTheLibrary();
}

EndSignals::EndSignals() {
  sigemptyset(&signals_);
  for (const int signal : kEndSignals) sigaddset(&signals_, signal);
  struct sigaction hang_up{};
  const bool survives = sigaction(SIGHUP, nullptr, &hang_up) == 0 && hang_up.sa_handler == SIG_IGN;
  if (!survives) sigaddset(&signals_, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);  // inherited by every thread started later
}

bool EndSignals::Await(std::int64_t wait_ns) const {
  const timespec wait{.tv_sec = wait_ns / 1'000'000'000, .tv_nsec = wait_ns % 1'000'000'000};
  return sigtimedwait(&signals_, nullptr, &wait) > 0;
}

}  // namespace flexarm
