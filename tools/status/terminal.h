#pragma once

#include <termios.h>

#include <optional>
#include <string>
#include <vector>

#include "tools/status/watch_screen.h"

namespace flexarm {

/// What standard output can show, by $NO_COLOR, $TERM, $LC_ALL, $LC_CTYPE and $LANG. Colours on a
/// terminal only.
ScreenStyle StyleOfOutput();

/// Standard output is a terminal that obeys more than newlines: $TERM is there, and not "dumb".
bool OutputIsScreen();

/// The terminal of the program as one screen: the alternate one, without cursor, with keys that are
/// read at once and not shown. Its end leaves the terminal as it found it. One object at a time.
class Terminal {
 public:
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// What the terminal tells; 80 x 24 if it does not know.
  static ScreenSize Size();

  /// Shows these lines and nothing else, in one write.
  void Show(const std::vector<std::string>& lines);

  /// Whether standard input is a terminal: else there are no keys.
  bool has_keys() const { return before_.has_value(); }
  /// Whether `key` is among the keys that were pressed. Never waits.
  bool Pressed(char key);

  /// As it was found, while the program is stopped, and again as it is here.
  void Leave();
  void Enter();

 private:
  std::optional<termios> before_;
};

}  // namespace flexarm
