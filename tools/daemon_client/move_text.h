#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace flexarm {

/// One move of the arm from where it stands, as an operator asks for it.
struct MoveWish {
  std::optional<std::array<double, 2>> to_deg{};    ///< angles of the joints; or
  std::optional<std::array<double, 2>> to_tip_m{};  ///< place of the tip, x and y
  std::string elbow{};      ///< "left" or "right" of the line to the tip; empty: not said
  double duration_s = 0.0;  ///< 0: the shortest within plan_fraction of every limit
};

/// The experiment of that one move, a TOML text for the command `run`. Each row of it is what was
/// asked for, so the daemon's messages name that.
std::string MoveText(const MoveWish& wish);

/// The command `retarget` to the same place.
nlohmann::ordered_json RetargetCommand(const MoveWish& wish);

}  // namespace flexarm
