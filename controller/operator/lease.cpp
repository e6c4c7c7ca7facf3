#include "controller/operator/lease.h"

#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

// What every user with the role may ask: to look, to stop, and to press a simulated switch.
bool NeedsLease(std::string_view command) {
  return command != "status" && command != "stop" && command != "sim";
}

bool TakesOver(const nlohmann::json& command) {
  const auto found = command.find("take_over");
  if (found == command.end()) return false;
  if (!found->is_boolean()) throw RejectedError("expected true or false in 'take_over'");
  return found->get<bool>();
}

nlohmann::json HeldBy(const Peer& holder, const std::string& why, const std::string& remedy) {
  return {{"ok", false},
          {"refusal", "held-by"},
          {"held_by", PeerJson(holder)},
          {"error", "held-by " + holder.name + ": " + why},
          {"remedy", remedy}};
}

}  // namespace

nlohmann::json Lease::Judge(std::int64_t now_ns, const Peer& by, const nlohmann::json& command,
                            SafetyState state) {
  const bool takes_over = TakesOver(command);
  const std::string name = command["command"];
  if (!holder_ || holder_->uid == by.uid || !NeedsLease(name)) return nullptr;
  if (!takes_over) {
    return HeldBy(*holder_, "another user commands the arm",
                  "ask " + holder_->name + " to disarm it, or use --take-over");
  }
  if (TorqueAllowed(state)) {
    return HeldBy(*holder_, "the arm moves, so it cannot be taken over",
                  "wait, or run `flexarm stop`, which every operator may; then repeat the command");
  }
  Give(now_ns, by, "taken over from " + PeerText(*holder_) + " by " + PeerText(by));
  return nullptr;
}

void Lease::Give(std::int64_t now_ns, const Peer& to, const std::string& how) {
  const bool is_taken = holder_.has_value();
  nlohmann::json value{{"by", PeerJson(to)}};
  if (is_taken) value["from"] = PeerJson(*holder_);
  holder_ = to;
  report_(is_taken, "lease: " + how);
  events_->Push({.time_ns = now_ns,
                 .kind = "lease",
                 .name = is_taken ? "taken-over" : "begun",
                 .text = how,
                 .value_json = value.dump()});
}

void Lease::Armed(std::int64_t now_ns, const Peer& by) {
  end_ns_ = INT64_MAX;
  if (!holder_ || holder_->uid != by.uid) Give(now_ns, by, "begun by " + PeerText(by));
}

void Lease::Follow(std::int64_t now_ns, SafetyState state) {
  if (!holder_) return;
  const bool closed = RelayClosed(state) || TestsPower(state);
  if (closed) end_ns_ = INT64_MAX;
  if (!closed && end_ns_ == INT64_MAX) end_ns_ = now_ns + kKeepNs;
  if (now_ns < end_ns_) return;
  report_(false, "lease: of " + holder_->name + " ended");
  holder_.reset();
}

std::optional<uid_t> Lease::holder() const {
  return holder_ ? std::optional(holder_->uid) : std::nullopt;
}

nlohmann::json Lease::Json(std::int64_t now_ns) const {
  if (!holder_) return nullptr;
  nlohmann::json json{{"name", holder_->name}, {"uid", holder_->uid}, {"seconds_left", nullptr}};
  if (end_ns_ != INT64_MAX) json["seconds_left"] = static_cast<double>(end_ns_ - now_ns) / 1e9;
  return json;
}

}  // namespace flexarm
