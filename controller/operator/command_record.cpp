#include "controller/operator/command_record.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "controller/files/external_text.h"
#include "controller/operator/operator_roles.h"

namespace flexarm {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;

}  // namespace

void CommandRecord::Asked(int client, const Peer& by, const std::string& command) {
  open_.push_back({.client = client,
                   .by = by,
                   .command = command,
                   .waited_looks = waited_looks_,
                   .busy_us = busy_us_});
}

std::vector<CommandRecord::Open>::const_iterator CommandRecord::Find(
    int client, const std::string& command) const {
  return std::find_if(open_.begin(), open_.end(), [&](const Open& open) {
    return open.client == client && (command.empty() || open.command == command);
  });
}

std::optional<Peer> CommandRecord::Giver(int client, const std::string& command) const {
  const auto found = Find(client, command);
  return found == open_.end() ? std::nullopt : std::optional(found->by);
}

void CommandRecord::Answered(std::int64_t now_ns, int client, nlohmann::json* answer) {
  const auto found = Find(client, answer->value("command", ""));
  if (found == open_.end()) return;
  Open open = *found;
  open_.erase(found);
  (*answer)["by"] = PeerJson(open.by);
  if (open.command == "stop") {
    (*answer)["heard"] = {{"waited_looks", open.waited_looks}, {"busy_us", open.busy_us}};
  }
  if (!open.command.empty() && open.command != "status") {
    Keep(now_ns, open.by, open.command, *answer);
  }
}

void CommandRecord::Keep(std::int64_t now_ns, const Peer& by, const std::string& command,
                         const nlohmann::json& answer) {
  if (kept_ == kMostPerSecond) {
    ++left_out_;
    return;
  }
  ++kept_;
  const bool ok = answer.value("ok", false);
  const std::string name = Shown(command);  // a client may call it anything
  const std::string text = name + " by " + PeerText(by) + ": " +
                           (ok ? "accepted" : "refused: " + answer.value("error", ""));
  report_(!ok, text);
  events_->Push({.time_ns = now_ns,
                 .kind = "operator",
                 .name = name,
                 .text = text,
                 .value_json =
                     nlohmann::json{
                         {"ok", ok}, {"refusal", answer.value("refusal", "")}, {"by", PeerJson(by)}}
                         .dump()});
}

void CommandRecord::TurnedAway(std::int64_t now_ns, const Peer& peer) {
  if (++turned_away_ == 1) Keep(now_ns, peer, "connection", NotPermittedJson(peer, ""));
}

void CommandRecord::Follow(std::int64_t now_ns) {
  if (second_ns_ != INT64_MIN && now_ns - second_ns_ < kSecondNs) return;
  second_ns_ = now_ns;
  kept_ = 0;
  turned_away_ = 0;
  if (const std::uint64_t count = std::exchange(left_out_, 0); count != 0) {
    report_(true, std::to_string(count) +
                      " more commands were answered within a second: a program sends too many");
  }
}

}  // namespace flexarm
