#pragma once

#include <optional>
#include <string>

namespace flexarm {

/// A client of the operator socket that never blocks, so that one thread can be both its ends.
class LineClient {
 public:
  /// @throws RejectedError if nothing listens at `path`
  explicit LineClient(const std::string& path);
  ~LineClient();
  LineClient(const LineClient&) = delete;
  LineClient& operator=(const LineClient&) = delete;

  /// Sends a line, without its newline. @returns false: the socket did not take it
  bool Send(const std::string& line) const;

  /// The next line that has come, without its newline.
  std::optional<std::string> Line();

 private:
  int fd_;
  std::string received_;
};

}  // namespace flexarm
