#include "tools/status/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <string_view>

namespace flexarm {
namespace {

constexpr ScreenSize kUsual{.columns = 80, .rows = 24};

std::string_view Environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

// The first that is set decides, as in setlocale(3). The locale itself need not be installed here:
// ssh passes the name of another computer's on.
bool Utf8Terminal() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const std::string_view locale = Environment(name);
    if (locale.empty()) continue;
    constexpr std::array<std::string_view, 4> kNames = {"UTF-8", "utf-8", "utf8", "UTF8"};
    return std::any_of(kNames.begin(), kNames.end(), [locale](std::string_view utf8) {
      return locale.find(utf8) != std::string_view::npos;
    });
  }
  return false;
}

void WriteAll(std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = write(STDOUT_FILENO, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return;  // the terminal has gone: a signal says so
    text.remove_prefix(static_cast<std::size_t>(count));
  }
}

}  // namespace

bool OutputIsScreen() {
  const std::string_view term = Environment("TERM");
  return isatty(STDOUT_FILENO) == 1 && !term.empty() && term != "dumb";
}

ScreenStyle StyleOfOutput() {
  return {.colour = OutputIsScreen() && Environment("NO_COLOR").empty(), .utf8 = Utf8Terminal()};
}

Terminal::Terminal() {
  termios found{};
  if (tcgetattr(STDIN_FILENO, &found) == 0) before_ = found;
  Enter();
}

Terminal::~Terminal() { Leave(); }

ScreenSize Terminal::Size() {
  winsize told{};
  const bool known =
      ioctl(STDOUT_FILENO, TIOCGWINSZ, &told) == 0 && told.ws_col > 0 && told.ws_row > 0;
  return known ? ScreenSize{.columns = told.ws_col, .rows = told.ws_row} : kUsual;
}

void Terminal::Enter() {
  if (before_) {
    termios raw = *before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // Ctrl-C and Ctrl-Z stay signals
    raw.c_cc[VMIN] = 0;
    raw.c_cc[VTIME] = 0;
    tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  }
  WriteAll("\033[?1049h\033[?25l");  // alternate screen; no cursor
}

void Terminal::Leave() {
  WriteAll("\033[?25h\033[?1049l");
  if (before_) tcsetattr(STDIN_FILENO, TCSANOW, &*before_);
}

// Each line is cleared before it is written: after a full one the cursor stands on its last sign.
void Terminal::Show(const std::vector<std::string>& lines) {
  std::string frame;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    frame += "\033[" + std::to_string(i + 1) + ";1H\033[K" + lines[i];
  }
  if (static_cast<int>(lines.size()) < Size().rows) {
    frame += "\033[" + std::to_string(lines.size() + 1) + ";1H\033[J";
  }
  WriteAll(frame);
}

bool Terminal::Pressed(char key) {
  bool found = false;
  std::array<char, 64> keys{};
  for (;;) {
    const ssize_t count = has_keys() ? read(STDIN_FILENO, keys.data(), keys.size()) : 0;
    if (count <= 0) return found;
    const std::string_view pressed(keys.data(), static_cast<std::size_t>(count));
    found = found || pressed.find(key) != std::string_view::npos;
  }
}

}  // namespace flexarm
