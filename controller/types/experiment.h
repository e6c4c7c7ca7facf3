#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "controller/types/law_table.h"
#include "controller/types/motion_profile.h"
#include "hal/sensor_frame.h"
#include "model/arm/straight_arm.h"
#include "model/problem.h"

namespace flexarm {

enum class DoubletShape : std::uint8_t { kSquare, kSine };

/// A torque doublet of zero area, [[doublet]]: displaces the joints and leaves them at rest.
struct Doublet {
  double start_s;
  double duration_s;               ///< T: +a for T/2, -a for T/2
  DoubletShape shape;              ///< "square" or "sine"
  std::array<double, 2> move_deg;  ///< of th1, th2 in the reference model
};

/// A smooth move of both joints to a target, [[move]]: at rest at its end, and at its start unless
/// it retargets the move before it (PlannedMove).
struct Move {
  double start_s;
  std::optional<double> duration_s{};  ///< none: the shortest within the limits, see PlanMoves
  bool shortest = false;   ///< duration = "shortest": docs/theory/fast-moves.md; then the longest
                           ///< that a payload needs is in duration_s, once the moves are planned
  bool same_load = false;  ///< the payload is that of the move before
  std::array<double, 2> to_deg{};                   ///< th1 and th2 at the end, absolute
  std::optional<std::array<double, 2>> to_tip_m{};  ///< x, y of the tip instead, base frame
  std::optional<ElbowSide> elbow{};                 ///< with to_tip_m, if both sides are possible
  MoveProfile profile = MoveProfile::kQuintic;
};

/// A sine sweep of the joints' angles, [[chirp]], tapered: from rest to rest at the same place.
struct Chirp {
  double start_s;
  double duration_s;
  double from_hz;
  double to_hz;
  std::array<double, 2> amplitude_deg;  ///< of th1, th2 in the reference model
};

/// A pseudo-random binary torque, [[prbs]]: from rest to rest at the same place.
struct Prbs {
  double start_s;
  double hold_s;                    ///< shortest time of constant sign of the torque
  int bits;                         ///< of the shift register: 2^bits - 1 pulses
  int seed;                         ///< its start, 1 .. 2^bits - 1
  std::array<double, 2> torque_nm;  ///< amplitudes

  int pulses() const { return (1 << std::clamp(bits, 0, 30)) - 1; }
  double duration_s() const { return 4.0 * hold_s * pulses(); }
};

/// One row of a CSV trajectory.
struct TrajectoryPoint {
  double time_s;
  std::array<double, 2> angle_rad;  ///< th1, th2
};

/// A trajectory of both joints from a CSV file, table [csv].
struct CsvTrajectory {
  double start_s;
  std::string file;                    ///< for messages
  std::vector<TrajectoryPoint> point;  ///< at least two, times ascending from 0

  double duration_s() const { return point.empty() ? 0.0 : point.back().time_s; }
};

/// The payload changes, [[load_change]]: announced by the gripper or the operator.
struct LoadChange {
  double at_s;  ///< after the start of the experiment
};

enum class FreezeTarget : std::uint8_t { kNone, kPlant, kControl };

/// An event on the simulated rig, [[sim_event]]. Real backends reject it.
struct SimEvent {
  double at_s;                         ///< after the start of the experiment
  std::optional<Line> line;            ///< with `level`
  int level;                           ///< 0 or 1, as in LineLevels
  FreezeTarget freeze;                 ///< that task stops running
  bool kill;                           ///< the process kills itself with SIGKILL
  std::optional<double> payload_kg{};  ///< payload of the plant from then on
};

/// Duration of a row: doublet, move, chirp, prbs or csv. A move that the next one retargets lasts
/// until that one begins.
struct Motion {
  std::string row;  ///< its name in messages: "move[2]"
  double start_s;
  double duration_s;  ///< 0 for a move whose duration is not chosen yet
};

/// The least speed of an experiment, as a share of the planned one.
inline constexpr double kLeastSpeed = 0.1;
/// The longest run.
inline constexpr double kLongestRun_s = 3600.0;
/// An experiment without duration_s ends so long after its last row: the arm comes to rest.
inline constexpr double kRestAfterRows_s = 1.0;

/// An experiment: what one run does, config/experiments/*.toml.
struct Experiment {
  std::string name;
  std::string text;              ///< the file as read, with appended text: for the log
  double duration_s;             ///< kLongestRun_s while ends_after_rows
  std::vector<Doublet> doublet;  ///< the rows of a kind in order of time; only moves overlap
  std::vector<SimEvent> sim_event;
  std::vector<Move> move{};
  std::vector<LoadChange> load_change{};
  std::vector<Chirp> chirp{};
  std::vector<Prbs> prbs{};
  std::optional<CsvTrajectory> csv{};
  std::vector<ControllerKind> laws{};                 ///< that may run it; empty: any
  std::optional<std::array<double, 2>> payload_kg{};  ///< least, greatest; empty: not predicted
  double speed = 1.0;                                 ///< share of the planned speed, above 0 to 1
  bool ends_after_rows = false;  ///< its end is not known until its moves are planned

  std::vector<Problem> Problems() const;
  std::vector<Motion> Motions() const;  ///< all rows but sim_event, in order of time
};

/// The experiment at another speed, in its text as well; at 1 as it is.
/// @throws RejectedError if it states a speed itself
Experiment AtSpeed(Experiment experiment, double speed);

}  // namespace flexarm
