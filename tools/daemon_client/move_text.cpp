#include "tools/daemon_client/move_text.h"

#include <nlohmann/json.hpp>

#include "model/problem_list.h"

namespace flexarm {
namespace {

std::string PairText(const char* key, const std::array<double, 2>& pair) {
  return std::string(key) + " = [" + NumberText(pair[0]) + ", " + NumberText(pair[1]) + "]\n";
}

}  // namespace

std::string MoveText(const MoveWish& wish) {
  std::string text = "name = \"move\"\n[[move]]\nstart_s = 0.0\n";
  if (wish.to_deg) text += PairText("to_deg", *wish.to_deg);
  if (wish.to_tip_m) text += PairText("to_tip_m", *wish.to_tip_m);
  if (!wish.elbow.empty()) text += "elbow = \"" + wish.elbow + "\"\n";
  if (wish.duration_s > 0.0) text += "duration_s = " + NumberText(wish.duration_s) + "\n";
  return text;
}

nlohmann::ordered_json RetargetCommand(const MoveWish& wish) {
  nlohmann::ordered_json command{{"command", "retarget"}};
  if (wish.to_deg) command["to_deg"] = *wish.to_deg;
  if (wish.to_tip_m) command["to_tip_m"] = *wish.to_tip_m;
  if (!wish.elbow.empty()) command["elbow"] = wish.elbow;
  if (wish.duration_s > 0.0) command["duration_s"] = wish.duration_s;
  return command;
}

}  // namespace flexarm
