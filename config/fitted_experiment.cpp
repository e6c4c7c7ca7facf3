#include "config/fitted_experiment.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "config/document.h"
#include "config/toml_text.h"
#include "config/tuning_basis.h"
#include "controller/types/rounded_text.h"
#include "model/units.h"

namespace flexarm {
namespace {

constexpr double kShareOfAngle = 2.0 / 3.0, kShareOfEffort = 0.7;
constexpr double kRest_s = 2.0;
constexpr double kOnSample = 1e-6;  // of a period

/// How large acceleration and rate of a motion by 1 rad in 1 s become.
struct Shape {
  double acceleration, rate;
};
constexpr Shape kSquare = {4.0, 2.0}, kSine = {kTwoPi, 2.0}, kQuintic = {5.774, 1.875},
                kSeptic = {7.514, 2.188};

/// A motion of both joints. Source of the profiles' shapes: motion_profile.h.
struct Turn {
  Shape shape;
  std::array<double, 2> by_rad;
  std::optional<double> duration_s;
  double room_s;  ///< until the next motion begins
};

/// What a rig can do.
struct Ability {
  std::array<double, 2> acceleration_rad_s2, rate_rad_s;
};

Ability AbilityOf(const RigConfig& config) {
  const ArmScales scales = ScalesOf(TuningBasisOf(config));
  Ability ability{};
  for (std::size_t i = 0; i < 2; ++i) {
    ability.acceleration_rad_s2[i] = kShareOfEffort * scales.torque_nm[i] / scales.inertia_kgm2[i];
    ability.rate_rad_s[i] = kShareOfEffort * config.safety.hub_rate_rad_s[i];
  }
  return ability;
}

// The shortest duration of a motion.
double Shortest_s(const Turn& turn, const Ability& ability, double share) {
  double duration_s = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    const double by_rad = share * std::abs(turn.by_rad[i]);
    duration_s = std::max(
        {duration_s, std::sqrt(turn.shape.acceleration * by_rad / ability.acceleration_rad_s2[i]),
         turn.shape.rate * by_rad / ability.rate_rad_s[i]});
  }
  return duration_s;
}

std::vector<Turn> TurnsOf(const Experiment& experiment) {
  std::vector<Turn> turns;
  for (const Doublet& d : experiment.doublet) {
    turns.push_back({.shape = d.shape == DoubletShape::kSine ? kSine : kSquare,
                     .by_rad = {kRadPerDeg * d.move_deg[0], kRadPerDeg * d.move_deg[1]},
                     .duration_s = d.duration_s,
                     .room_s = d.duration_s});
  }
  std::array<double, 2> from_deg{};
  for (std::size_t i = 0; i < experiment.move.size(); ++i) {
    const Move& move = experiment.move[i];
    const bool last = i + 1 == experiment.move.size();
    const double next_s = last ? experiment.duration_s : experiment.move[i + 1].start_s;
    turns.push_back({.shape = move.profile == MoveProfile::kSeptic ? kSeptic : kQuintic,
                     .by_rad = {kRadPerDeg * (move.to_deg[0] - from_deg[0]),
                                kRadPerDeg * (move.to_deg[1] - from_deg[1])},
                     .duration_s = move.duration_s,
                     .room_s = next_s - move.start_s});
    from_deg = move.to_deg;
  }
  return turns;
}

// How far the joints leave zero.
std::array<double, 2> Extent_deg(const Experiment& experiment) {
  std::array<double, 2> extent{}, at{};
  const auto reach = [&](const std::array<double, 2>& to_deg) {
    at = to_deg;
    for (std::size_t i = 0; i < 2; ++i) extent[i] = std::max(extent[i], std::abs(at[i]));
  };
  for (const Doublet& d : experiment.doublet) reach({at[0] + d.move_deg[0], at[1] + d.move_deg[1]});
  for (const Move& move : experiment.move) reach(move.to_deg);
  return extent;
}

double AngleShare(const Experiment& experiment, const SafetyConfig& safety) {
  const std::array<double, 2> extent_deg = Extent_deg(experiment);
  double share = 1.0;
  for (std::size_t i = 0; i < 2; ++i) {
    if (extent_deg[i] <= 0.0) continue;
    share = std::min(share, kShareOfAngle * safety.soft_angle_deg[i] / extent_deg[i]);
  }
  return share;
}

double Stretch(const Experiment& experiment, const RigConfig& config, double share) {
  const Ability ability = AbilityOf(config);
  double stretch = 1.0;
  for (const Turn& turn : TurnsOf(experiment)) {
    const double shortest_s = Shortest_s(turn, ability, share);
    stretch = std::max(stretch, turn.duration_s ? shortest_s / *turn.duration_s
                                                : (shortest_s + kRest_s) / turn.room_s);
  }
  return stretch;
}

double OnGrid(double time_s, double grid_s) {
  const double steps = time_s / grid_s;
  if (std::abs(steps - std::round(steps)) < kOnSample) return time_s;
  return std::ceil(steps) * grid_s;
}

bool CanBeFitted(const Experiment& experiment) {
  return experiment.chirp.empty() && experiment.prbs.empty() && !experiment.csv &&
         experiment.sim_event.empty() &&
         std::none_of(experiment.move.begin(), experiment.move.end(),
                      [](const Move& move) { return move.to_tip_m.has_value(); });
}

/// Writes the fitted values into the document of an experiment.
class Fitting {
 public:
  Fitting(double share, double stretch, double period_s)
      : share_(share), stretch_(stretch), period_s_(period_s) {}

  void Apply(toml::table* document) {
    Time(document, "duration_s", 1.0);
    for (const char* kind : {"doublet", "move"}) {
      toml::array* rows = document->get_as<toml::array>(kind);
      if (rows == nullptr) continue;
      for (toml::node& row : *rows) ApplyToRow(row.as_table(), kind == std::string("doublet"));
    }
  }

  bool is_off_samples() const { return off_samples_; }

 private:
  void ApplyToRow(toml::table* row, bool halves) {
    Time(row, "start_s", 1.0);
    Time(row, "duration_s", halves ? 2.0 : 1.0);  // each half of a doublet on samples
    if (share_ == 1.0) return;
    for (const char* key : {"move_deg", "to_deg"}) {
      toml::array* angles = row->get_as<toml::array>(key);
      for (std::size_t i = 0; angles != nullptr && i < 2; ++i) {
        angles->replace(angles->begin() + static_cast<std::ptrdiff_t>(i),
                        share_ * *angles->at(i).value<double>());
      }
    }
  }

  void Time(toml::table* table, const char* key, double periods) {
    const std::optional<double> was_s = table->at_path(key).value<double>();
    if (!was_s) return;
    const double stretched_s = stretch_ * *was_s;
    const double is_s = OnGrid(stretched_s, periods * period_s_);
    off_samples_ = off_samples_ || is_s != stretched_s;
    if (is_s != *was_s) table->insert_or_assign(key, is_s);
  }

  double share_, stretch_, period_s_;
  bool off_samples_ = false;
};

void Say(const std::string& text, std::string* how) { *how += (how->empty() ? "" : ", ") + text; }

// The rig's payloads, where the command is not for all of them.
bool FitPayloads(const Experiment& experiment, const RigConfig& config, toml::table* document) {
  const auto [least, most] = config.controller.payload_range_kg;
  if (!experiment.payload_kg) return false;
  if ((*experiment.payload_kg)[0] <= least && (*experiment.payload_kg)[1] >= most) return false;
  document->insert_or_assign("payload_kg", toml::array{least, most});
  return true;
}

}  // namespace

FittedExperiment FitExperiment(const Experiment& experiment, const RigConfig& config) {
  if (!CanBeFitted(experiment)) return {.experiment = experiment, .how = {}};
  const double share = AngleShare(experiment, config.safety);
  const double stretch = Stretch(experiment, config, share);
  toml::table document = ParseToml(experiment.text, experiment.name);
  Fitting fitting(share, stretch, config.loop.period_s());
  fitting.Apply(&document);
  std::string how;
  if (share < 1.0) Say(RoundedText(share, 2) + " times as far", &how);
  if (stretch > 1.0) Say(RoundedText(stretch, 2) + " times as long", &how);
  if (fitting.is_off_samples()) {
    Say("on samples of " + RoundedText(config.loop.period_ms, 3) + " ms", &how);
  }
  if (FitPayloads(experiment, config, &document)) Say("for the payloads of this rig", &how);
  if (how.empty()) return {.experiment = experiment, .how = {}};
  return {.experiment = ParseExperiment(DocumentText(document), experiment.name), .how = how};
}

}  // namespace flexarm
