#include <sys/socket.h>

#include <filesystem>
#include <stdexcept>
#include <string>

#include "controller/operator/operator_client.h"
#include "controller/operator/unix_address.h"
#include "controller/runlog/file_descriptor.h"
#include "controller/types/rejected_error.h"
#include "tests/controller/operator/socket_peer.h"
#include "tests/fuzz/fuzz_reader.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tools/status/display_text.h"
#include "tools/status/status_text.h"
#include "tools/status/watch_screen.h"

namespace flexarm {
namespace {

constexpr double kWithin_s = 1.0;  // never waited for: all is sent before it is asked for

// What answers in the place of a daemon, for all inputs.
class Server {
 public:
  Server() : socket_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const UnixAddress address(path_);
    if (bind(socket_.get(), address.get(), address.size()) != 0 || listen(socket_.get(), 1) != 0) {
      throw std::runtime_error("no socket");
    }
  }
  ~Server() {
    std::error_code ignored;
    std::filesystem::remove_all(std::filesystem::path(path_).parent_path(), ignored);
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  const std::string& path() const { return path_; }

  // Takes the connection that waits, answers all that it will ask, and closes it.
  void Send(FuzzBytes bytes) const {
    const FileDescriptor peer(
        accept4(socket_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    while (!bytes.empty()) {
      const ssize_t sent = send(peer.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return;  // more than the socket takes
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    }
  }

 private:
  FileDescriptor socket_;
  const std::string path_ = SocketPath();
};

bool HasControlCharacter(const std::string& text) {
  for (const char sign : text) {
    const auto byte = static_cast<unsigned char>(sign);
    if ((byte < 0x20 && sign != '\n') || byte == 0x7F) return true;
  }
  return false;
}

struct Shape {
  ScreenSize size;
  ScreenStyle style;
};

// As `flexarm status`, `status --watch` and `run --wait` do.
void Show(const Reply& status, const Shape& shape) {
  Expect(!HasControlCharacter(StatusText(status)), "a control character in a status");
  Expect(!HasControlCharacter(ProgressText(In(status, "run"))), "one in the progress of a run");
  const auto lines =
      WatchScreen({.status = status, .age_s = 0.1, .no_answer = ""}, shape.size, shape.style);
  Expect(std::ssize(lines) <= shape.size.rows, "a screen that is too high");
  if (shape.style.colour) return;  // colours are control characters
  for (const std::string& line : lines) {
    Expect(!HasControlCharacter(line), "a control character on a screen");
    Expect(DisplayWidth(line) <= shape.size.columns, "a line that is too wide");
  }
}

}  // namespace

// What a client receives from something that may be no daemon.
void FuzzClient(FuzzBytes input) {
  static const Server server;
  FuzzReader from(input);
  const int columns = 1 + from.Byte(), rows = 1 + from.Byte() % 64, style = from.Byte();
  const Shape shape{.size = {.columns = columns, .rows = rows},
                    .style = {.colour = (style & 1) != 0, .utf8 = (style & 2) != 0}};
  DaemonConnection connection(server.path(), kWithin_s);
  server.Send(from.Take(input.size()));
  try {
    for (;;) {
      const std::string answer = connection.Ask(R"({"command": "status"})", kWithin_s);
      const Reply reply = Reply::parse(answer, nullptr, false);
      if (reply.is_object()) Show(reply, shape);
    }
  } catch (const RejectedError&) {  // the connection is closed
  }
}

}  // namespace flexarm
