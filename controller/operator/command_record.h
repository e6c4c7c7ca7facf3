#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "controller/operator/journal_report.h"
#include "controller/operator/peer.h"
#include "controller/runlog/event_queue.h"

namespace flexarm {

/// Who gave which command, and what became of it: key "by" of the answer, a line of the journal and
/// an event "operator" of the log. The line and the event are for every command that is accepted or
/// refused, but not for `status`.
///
/// The answer to `stop` also says how it was heard: "heard": {"waited_looks", "busy_us"}.
///
/// At most kMostPerSecond a second, so that a flood of commands does not fill journal and log;
/// one more line then gives the number of the others. Not real-time safe. Thread: operator.
class CommandRecord {
 public:
  static constexpr int kMostPerSecond = 50;

  /// @param events  to the recorder; outlives this
  CommandRecord(EventQueue* events, JournalReport report)
      : events_(events), report_(std::move(report)) {}

  /// How the next command was heard.
  /// @param waited_looks  looks into the socket in which it may have waited already
  /// @param busy_us       processor time of this look until then
  void Heard(int waited_looks, double busy_us) {
    waited_looks_ = waited_looks;
    busy_us_ = busy_us;
  }

  /// A client has given a command.
  void Asked(int client, const Peer& by, const std::string& command);

  /// Before an answer is sent: adds "by", and keeps it. The answer to the oldest command of this
  /// client with the answer's "command"; one without that key: to its oldest.
  void Answered(std::int64_t now_ns, int client, nlohmann::json* answer);

  /// Who gave the oldest command of this name that a client has no answer to.
  std::optional<Peer> Giver(int client, const std::string& command) const;

  /// A user without a role has connected and was closed. One line of the journal a second at most.
  void TurnedAway(std::int64_t now_ns, const Peer& peer);

  /// Once a period: gives the number of the commands that a second had too many.
  void Follow(std::int64_t now_ns);

 private:
  struct Open {
    int client;
    Peer by;
    std::string command;
    int waited_looks;
    double busy_us;
  };

  std::vector<Open>::const_iterator Find(int client, const std::string& command) const;
  void Keep(std::int64_t now_ns, const Peer& by, const std::string& command,
            const nlohmann::json& answer);

  EventQueue* events_;
  JournalReport report_;
  std::vector<Open> open_;              // in order
  std::int64_t second_ns_ = INT64_MIN;  // when the present second began
  int kept_ = 0;                        // in it
  std::uint64_t left_out_ = 0;          // the same
  int waited_looks_ = 0;                // of the next command
  double busy_us_ = 0.0;                // the same
  std::uint64_t turned_away_ = 0;       // the same
};

}  // namespace flexarm
