#include "tools/bench_host/child_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "controller/files/external_text.h"

namespace flexarm {
namespace {

std::string TextOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// The three standard streams of a child and its folder. Files and no pipes: neither side can wait
// for the other.
class Redirection {
 public:
  Redirection(const std::filesystem::path& folder, const std::filesystem::path& output,
              const std::filesystem::path& errors) {
    constexpr mode_t kMode = 0600;
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, output.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, kMode);
    posix_spawn_file_actions_addopen(&actions_, STDERR_FILENO, errors.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, kMode);
    posix_spawn_file_actions_addchdir_np(&actions_, folder.c_str());
  }
  ~Redirection() { posix_spawn_file_actions_destroy(&actions_); }
  Redirection(const Redirection&) = delete;
  Redirection& operator=(const Redirection&) = delete;
  const posix_spawn_file_actions_t* actions() const noexcept { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

std::filesystem::path OutputIn(const std::filesystem::path& folder) {
  return folder / "output.txt";
}
std::filesystem::path ErrorsIn(const std::filesystem::path& folder) {
  return folder / "errors.txt";
}

pid_t Spawn(const std::vector<std::string>& words, const std::filesystem::path& folder) {
  const Redirection redirection(folder, OutputIn(folder), ErrorsIn(folder));
  std::vector<std::string> copies = words;
  std::vector<char*> arguments;
  for (std::string& word : copies) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, words.front().c_str(), redirection.actions(), nullptr,
                                   arguments.data(), environ);
  if (error != 0) {
    throw std::runtime_error(words.front() + " cannot be started: " + std::strerror(error));
  }
  return child;
}

// @param status  from waitpid
ProgramResult ResultOf(int status, const std::filesystem::path& folder) {
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {
      .exit_code = code, .output = TextOf(OutputIn(folder)), .errors = TextOf(ErrorsIn(folder))};
}

}  // namespace

bool IsInPath(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (::access((std::filesystem::path(folder) / name).c_str(), X_OK) == 0) return true;
  }
  return false;
}

ProgramResult RunChild(const std::vector<std::string>& words, const std::filesystem::path& folder) {
  const pid_t child = Spawn(words, folder);
  int status = 0;
  while (::waitpid(child, &status, 0) != child) {
    if (errno != EINTR) throw std::runtime_error(words.front() + " is gone");
  }
  return ResultOf(status, folder);
}

BackgroundChild::BackgroundChild(const std::vector<std::string>& words,
                                 const std::filesystem::path& folder)
    : name_(words.front()), folder_(folder) {
  if (words.front().find('/') == std::string::npos && !IsInPath(words.front())) {
    throw std::runtime_error(words.front() + " cannot be started: " + std::strerror(ENOENT));
  }
  std::vector<std::string> tied = {"setpriv", "--pdeathsig", "TERM", "--"};
  tied.insert(tied.end(), words.begin(), words.end());
  child_ = Spawn(tied, folder);
}

BackgroundChild::~BackgroundChild() {
  constexpr int kTries = 500;
  if (!HasEnded()) ::kill(child_, SIGTERM);
  for (int i = 0; i < kTries && !HasEnded(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  if (ended_) return;
  ::kill(child_, SIGKILL);
  while (::waitpid(child_, &status_, 0) < 0 && errno == EINTR) {
  }
}

bool BackgroundChild::HasEnded() {
  ended_ = ended_ || ::waitpid(child_, &status_, WNOHANG) == child_;
  return ended_;
}

void BackgroundChild::RequireRunning() {
  if (HasEnded()) {
    throw std::runtime_error(name_ + " has ended: " + ReasonOf(ResultOf(status_, folder_)));
  }
}

std::string ReasonOf(const ProgramResult& result) {
  std::istringstream lines(result.errors);
  std::string last;
  for (std::string line; std::getline(lines, line);) {
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  }
  return last.empty() ? "exit code " + std::to_string(result.exit_code)
                      : Shown(last, kMessageBytes);
}

}  // namespace flexarm
