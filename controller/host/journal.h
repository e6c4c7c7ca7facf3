#pragma once

#include <string>

namespace flexarm {

/// The daemon's text log: to the journal when stderr is connected to it, else to stderr. Only for
/// the recorder and operator threads and start-up: a line takes a lock and may block.
class Journal {
 public:
  Journal();

  void Info(const std::string& text);
  void Error(const std::string& text);
  void Report(bool is_error, const std::string& text) { is_error ? Error(text) : Info(text); }
};

}  // namespace flexarm
