// A library for LD_PRELOAD that watches the real-time threads of a program from their first sleep
// on: threads with SCHED_FIFO, and every thread whose name is in RTGUARD_THREADS (separated by
// commas). The first of these ends the process with a message and a stack trace:
//   - a call of the heap,
//   - a system call outside the thread's list (a seccomp filter of the thread, so that system calls
//     that no library makes are seen as well),
//   - a page fault,
//   - a wait between two sleeps: a voluntary context switch that is no sleep of the thread's own,
//   - an involuntary context switch of the thread `safety`, above which nothing has priority,
//   - a crash of any thread: the program's handler would make calls that the filter stops.
// The safety thread may set GPIO lines. Threads of buses may read, write and wait for their
// devices. At the end the library writes one line a thread: "rtguard: NAME: N activations".
// RTGUARD_SHARED_LINES=1: another process uses the same GPIO chip, as an emulated rig does with a
// simulated one; a wait in an ioctl, for the kernel's lock of that chip, is no violation then.
// RTGUARD_REPORT names a file for all it writes, otherwise stderr has it.

#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/futex.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <vector>

namespace {

constexpr int kMostThreads = 32;
constexpr std::array<const char*, 4> kNoDevices = {"safety", "control", "plant", "planner"};

struct Watched {
  std::array<char, 16> name{};
  std::atomic<long> activations{0};
};

std::array<Watched, kMostThreads> watched;
std::atomic<int> watched_count{0};
int report_fd = STDERR_FILENO;
bool shares_lines = false;

// constinit: reading them must not run an initialiser.
constinit thread_local bool is_armed = false;
constinit thread_local bool is_judged = false;  // it is known whether the thread is real-time
constinit thread_local Watched* mine = nullptr;
constinit thread_local bool has_devices = false;
constinit thread_local rusage woken{};

void Say(const char* text) {
  [[maybe_unused]] const ssize_t written = write(report_fd, text, std::strlen(text));
}

// Neither allocates nor returns.
[[noreturn]] void Violation(const char* what, long number) {
  is_armed = false;
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), "rtguard: %s: %s %ld\n",
                mine != nullptr ? mine->name.data() : "?", what, number);
  Say(text.data());
  std::array<void*, 40> frames{};
  backtrace_symbols_fd(frames.data(), backtrace(frames.data(), static_cast<int>(frames.size())),
                       report_fd);
  std::signal(SIGABRT, SIG_DFL);
  std::abort();
}

void SystemCall(int, siginfo_t* info, void*) { Violation("system call", info->si_syscall); }

constexpr std::array kCrashes = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

void Crash(int signal, siginfo_t*, void*) { Violation("signal", signal); }

bool IsOurs(int signal) {
  return signal == SIGSYS || std::find(kCrashes.begin(), kCrashes.end(), signal) != kCrashes.end();
}

// What every thread may do: sleep, ask for the time and for its own figures, wake another thread,
// and end.
constexpr std::array kAlways = {SYS_clock_nanosleep, SYS_clock_gettime,  SYS_getrusage,
                                SYS_restart_syscall, SYS_rt_sigreturn,   SYS_exit,
                                SYS_exit_group,      SYS_rt_sigprocmask, SYS_sigaltstack,
                                SYS_munmap,          SYS_madvise,        SYS_tgkill,
                                SYS_gettid,          SYS_getpid,         SYS_rt_sigaction};
constexpr std::array kDevices = {
    SYS_read,       SYS_write,      SYS_readv,    SYS_writev, SYS_ioctl,    SYS_poll,
    SYS_ppoll,      SYS_select,     SYS_pselect6, SYS_sendto, SYS_recvfrom, SYS_sendmsg,
    SYS_recvmsg,    SYS_recvmmsg,   SYS_sendmmsg, SYS_socket, SYS_connect,  SYS_close,
    SYS_setsockopt, SYS_getsockopt, SYS_bind,     SYS_fcntl,  SYS_openat,   SYS_getsockname,
    SYS_shutdown,   SYS_fstat};

// A futex is a lock, except a wake that waits for nothing and the sleep of a thread that is woken.
void Filter(bool devices) {
  std::vector<sock_filter> filter;
  const auto add = [&filter](const sock_filter& line) { filter.push_back(line); };
  add(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)));
  const auto allow = [&](long number) {
    add(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(number), 0, 1));
    add(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  };
  for (const long number : kAlways) allow(number);
  if (devices) {
    for (const long number : kDevices) allow(number);
    // fstat of the C library: the properties of an open descriptor, without a search of folders.
    add(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_newfstatat, 0, 4));
    add(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args) + 24));
    add(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AT_EMPTY_PATH, 0, 1));
    add(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
    add(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP));
  } else if (std::strcmp(mine->name.data(), "safety") == 0) {
    allow(SYS_ioctl);  // GPIO lines
  }
  allow(SYS_writev);  // of the stack trace
  // The report, and no other file.
  add(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_write, 0, 4));
  add(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args)));
  add(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(report_fd), 0, 1));
  add(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  add(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP));
  add(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_futex, 1, 0));
  add(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP));
  add(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args) + 8));
  add(BPF_STMT(BPF_ALU | BPF_AND | BPF_K, static_cast<std::uint32_t>(FUTEX_CMD_MASK)));
  allow(FUTEX_WAKE);
  if (devices) allow(FUTEX_WAIT_BITSET);
  add(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP));
  const sock_fprog program{.len = static_cast<unsigned short>(filter.size()),
                           .filter = filter.data()};
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0) {
    Say("rtguard: the kernel refuses the filter of system calls\n");
    std::abort();
  }
}

bool IsNamed(const char* name) {
  const char* names = std::getenv("RTGUARD_THREADS");
  if (names == nullptr) return false;
  const char* found = std::strstr(names, name);
  const std::size_t length = std::strlen(name);
  return found != nullptr && length > 0 && (found[length] == '\0' || found[length] == ',');
}

// Before the first sleep of a thread: allocates.
void Judge() {
  is_judged = true;
  std::array<char, 16> name{};
  pthread_getname_np(pthread_self(), name.data(), name.size());
  int policy = 0;
  sched_param parameters{};
  pthread_getschedparam(pthread_self(), &policy, &parameters);
  if (policy != SCHED_FIFO && !IsNamed(name.data())) return;
  has_devices = true;
  for (const char* without : kNoDevices) {
    if (std::strcmp(name.data(), without) == 0) has_devices = false;
  }
  const int number = watched_count.fetch_add(1);
  if (number >= kMostThreads) std::abort();
  mine = &watched[static_cast<std::size_t>(number)];
  mine->name = name;
  sigset_t trap{};
  sigemptyset(&trap);
  sigaddset(&trap, SIGSYS);
  pthread_sigmask(SIG_UNBLOCK, &trap, nullptr);  // blocked, it would end the process without a word
  std::array<void*, 2> first{};
  backtrace(first.data(), 2);  // its first call allocates
  Filter(has_devices);
  is_armed = true;
}

void BeforeSleep() {
  if (!is_judged) {
    Judge();
    return;
  }
  if (!is_armed) return;
  rusage now{};
  getrusage(RUSAGE_THREAD, &now);
  mine->activations.fetch_add(1, std::memory_order_relaxed);
  const long faults = now.ru_minflt + now.ru_majflt - woken.ru_minflt - woken.ru_majflt;
  if (faults != 0) Violation("page faults:", faults);
  const long waits = now.ru_nvcsw - woken.ru_nvcsw;
  if (!has_devices && waits != 0) Violation("waits between two sleeps:", waits);
  const long forced = now.ru_nivcsw - woken.ru_nivcsw;
  if (forced != 0 && std::strcmp(mine->name.data(), "safety") == 0) {
    Violation("involuntary switches of the highest priority:", forced);
  }
}

void AfterSleep() {
  if (is_armed) getrusage(RUSAGE_THREAD, &woken);
}

void CheckHeap(const char* function, std::size_t size) {
  if (is_armed) [[unlikely]] {
    Violation(function, static_cast<long>(size));
  }
}

[[gnu::constructor]] void Begin() {
  shares_lines = std::getenv("RTGUARD_SHARED_LINES") != nullptr;
  if (const char* file = std::getenv("RTGUARD_REPORT")) {
    report_fd = open(file, O_CREAT | O_WRONLY | O_APPEND | O_CLOEXEC, 0644);
  }
  struct sigaction action{};
  action.sa_sigaction = SystemCall;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  using Sigaction = int (*)(int, const struct sigaction*, struct sigaction*);
  const auto real = reinterpret_cast<Sigaction>(dlsym(RTLD_NEXT, "sigaction"));
  real(SIGSYS, &action, nullptr);
  action.sa_sigaction = Crash;
  for (const int signal : kCrashes) real(signal, &action, nullptr);
}

[[gnu::destructor]] void End() {
  for (int i = 0; i < watched_count.load() && i < kMostThreads; ++i) {
    const Watched& one = watched[static_cast<std::size_t>(i)];
    std::array<char, 100> text{};
    std::snprintf(text.data(), text.size(), "rtguard: %s: %ld activations\n", one.name.data(),
                  one.activations.load());
    Say(text.data());
  }
}

}  // namespace

// NOLINTBEGIN(bugprone-reserved-identifier, readability-inconsistent-declaration-parameter-name,
// cert-dcl50-cpp): the names are glibc's.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) {
  CheckHeap("malloc of bytes:", size);
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  CheckHeap("calloc of bytes:", count * size);
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  CheckHeap("realloc of bytes:", size);
  return __libc_realloc(block, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  CheckHeap("memalign of bytes:", size);
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  CheckHeap("aligned_alloc of bytes:", size);
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  CheckHeap("posix_memalign of bytes:", size);
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}
void free(void* block) {
  if (block != nullptr) CheckHeap("free", 0);
  __libc_free(block);
}

int clock_nanosleep(clockid_t clock, int flags, const timespec* until, timespec* left) {
  BeforeSleep();
  const long result = ::syscall(SYS_clock_nanosleep, clock, flags, until, left);
  const int error = result < 0 ? errno : 0;
  AfterSleep();
  return error;
}

// The sleep of a thread that others may wake is a futex through this function.
long syscall(long number, ...) {
  va_list list;
  va_start(list, number);
  std::array<long, 6> a{};
  for (long& one : a) one = va_arg(list, long);
  va_end(list);
  const bool sleeps = number == SYS_futex && (a[1] & FUTEX_CMD_MASK) == FUTEX_WAIT_BITSET;
  if (sleeps) BeforeSleep();
  using Syscall = long (*)(long, ...);
  static const auto real = reinterpret_cast<Syscall>(dlsym(RTLD_NEXT, "syscall"));
  const long result = real(number, a[0], a[1], a[2], a[3], a[4], a[5]);
  const int error = errno;
  if (sleeps) AfterSleep();
  errno = error;
  return result;
}

int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list list;
  va_start(list, request);
  void* const argument = va_arg(list, void*);
  va_end(list);
  using Ioctl = int (*)(int, unsigned long, ...);
  static const auto real = reinterpret_cast<Ioctl>(dlsym(RTLD_NEXT, "ioctl"));
  if (!is_armed || !shares_lines) return real(fd, request, argument);
  rusage before{};
  rusage after{};
  getrusage(RUSAGE_THREAD, &before);
  const int result = real(fd, request, argument);
  const int error = errno;
  getrusage(RUSAGE_THREAD, &after);
  woken.ru_nvcsw += after.ru_nvcsw - before.ru_nvcsw;
  errno = error;
  return result;
}

// A thread that gives up its signal stack has left its loop.
int sigaltstack(const stack_t* stack, stack_t* before) noexcept {
  is_armed = false;
  using Sigaltstack = int (*)(const stack_t*, stack_t*);
  static const auto real = reinterpret_cast<Sigaltstack>(dlsym(RTLD_NEXT, "sigaltstack"));
  return real(stack, before);
}

// The program may not take the signals of the filter and of a crash.
int sigaction(int signal, const struct sigaction* action, struct sigaction* before) noexcept {
  using Sigaction = int (*)(int, const struct sigaction*, struct sigaction*);
  static const auto real = reinterpret_cast<Sigaction>(dlsym(RTLD_NEXT, "sigaction"));
  return real(signal, IsOurs(signal) ? nullptr : action, before);
}
}
// NOLINTEND(bugprone-reserved-identifier, readability-inconsistent-declaration-parameter-name,
// cert-dcl50-cpp)
