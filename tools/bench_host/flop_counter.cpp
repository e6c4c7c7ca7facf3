#include "tools/bench_host/flop_counter.h"

#ifdef __x86_64__
#include <sys/ptrace.h>
#include <sys/types.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <unordered_map>

#include "tools/bench_host/flop_decoder.h"
#endif

namespace flexarm {

#ifdef __x86_64__
namespace {

// The marks of begin and end. Each writes a variable of its own, so that they stay two functions.
volatile int begun = 0, ended = 0;
[[gnu::noinline]] void MarkBegin() { begun = 1; }
[[gnu::noinline]] void MarkEnd() { ended = 1; }

using Address = std::uint64_t;
Address AddressOf(void (*function)()) { return reinterpret_cast<Address>(function); }

[[noreturn]] void RunTraced(const std::function<void()>& work) {
  if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(errno);
  work();
  raise(SIGSTOP);
  MarkBegin();
  work();
  MarkEnd();
  _exit(0);
}

// A child that is stopped. Ends with this object, or with this process.
class Child {
 public:
  explicit Child(const std::function<void()>& work) : pid_(fork()) {
    if (pid_ == 0) RunTraced(work);
    if (pid_ < 0) {
      problem_ = std::string("no process can be made: ") + std::strerror(errno);
    } else {
      if (Wait(SIGSTOP)) ptrace(PTRACE_SETOPTIONS, pid_, nullptr, PTRACE_O_EXITKILL);
    }
  }
  ~Child() {
    if (pid_ <= 0 || gone_) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  const std::string& problem() const noexcept { return problem_; }

  bool Step() {
    if (ptrace(PTRACE_SINGLESTEP, pid_, nullptr, nullptr) != 0) {
      problem_ = std::string("stepping was refused: ") + std::strerror(errno);
      return false;
    }
    return Wait(SIGTRAP);
  }
  Address At() const {
    return static_cast<Address>(
        ptrace(PTRACE_PEEKUSER, pid_, offsetof(user_regs_struct, rip), nullptr));
  }
  int FlopsAt(Address address) {
    const auto found = flops_.find(address);
    if (found != flops_.end()) return found->second;
    std::array<std::uint8_t, 2 * sizeof(long)> code{};  // an instruction and what follows it
    static_assert(code.size() >= kLongestInstruction);
    for (std::size_t at = 0; at < code.size(); at += sizeof(long)) {
      const long word = ptrace(PTRACE_PEEKTEXT, pid_, address + at, nullptr);
      std::memcpy(code.data() + at, &word, sizeof word);
    }
    return flops_[address] = FlopsOf(code);
  }

 private:
  bool Wait(int signal) {
    int status = 0;
    while (waitpid(pid_, &status, 0) != pid_) {
      if (errno == EINTR) continue;
      problem_ = std::string("the counted process is gone: ") + std::strerror(errno);
      return false;
    }
    if (WIFSTOPPED(status) && WSTOPSIG(status) == signal) return true;
    gone_ = !WIFSTOPPED(status);
    if (WIFEXITED(status)) {
      problem_ = std::string("a child may not be traced here (ptrace): ") +
                 std::strerror(WEXITSTATUS(status));
    } else {
      const int number = WIFSTOPPED(status) ? WSTOPSIG(status) : WTERMSIG(status);
      problem_ = std::string("the counted process got a signal: ") + strsignal(number);
    }
    return false;
  }

  pid_t pid_;
  bool gone_ = false;
  std::string problem_;
  std::unordered_map<Address, int> flops_;
};

}  // namespace

CountResult CountWork(const std::function<void()>& work, std::int64_t most_instructions) {
  Child child(work);
  if (!child.problem().empty()) return {.problem = child.problem()};
  const Address begin = AddressOf(MarkBegin), end = AddressOf(MarkEnd);
  WorkCount count{};
  bool counts = false;
  while (child.Step()) {
    const Address at = child.At();
    if (at == end) return {.count = count, .problem = ""};
    counts = counts || at == begin;
    if (!counts) continue;
    count.flops += child.FlopsAt(at);
    if (++count.instructions > most_instructions) {
      return {.problem = "more than " + std::to_string(most_instructions) +
                         " instructions, which would take too long to count"};
    }
  }
  return {.problem = child.problem()};
}
#else
CountResult CountWork(const std::function<void()>& /*work*/, std::int64_t /*most_instructions*/) {
  return {.problem = "instructions are counted on x86-64 only"};
}
#endif

}  // namespace flexarm
