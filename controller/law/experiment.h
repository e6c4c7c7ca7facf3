#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/sensor_frame.h"
#include "model/problem.h"

namespace flexarm {

enum class DoubletShape : std::uint8_t { kSquare, kSine };

/// One torque doublet of zero area, [[doublet]]: it moves the joints and leaves them at rest.
struct Doublet {
  double start_s;
  double duration_s;               ///< T: +a for T/2, -a for T/2
  DoubletShape shape;              ///< "square" or "sine"
  std::array<double, 2> move_deg;  ///< of th1, th2 in the reference model
};

/// A smooth move of both joints to a set-point, [[move]]: from rest to rest, all the way.
struct Move {
  double start_s;
  double duration_s;
  std::array<double, 2> to_deg;  ///< th1 and th2 at the end, whatever they were before
};

enum class FreezeTarget : std::uint8_t { kNone, kPlant, kControl };

/// A thing that happens to the simulated rig, [[sim_event]]. Real backends refuse it.
struct SimEvent {
  double at_s;               ///< after the start of the experiment
  std::optional<Line> line;  ///< with `level`
  int level;                 ///< 0 or 1, as in LineLevels
  FreezeTarget freeze;       ///< that task stops running
  bool kill;                 ///< the process kills itself with SIGKILL
};

/// When a doublet or a move acts.
struct Motion {
  double start_s;
  double duration_s;
};

/// What one run does, config/experiments/*.toml.
struct Experiment {
  std::string name;
  std::string text;  ///< the file as it was read, for the log
  double duration_s;
  std::vector<Doublet> doublet;  ///< in order of time, not overlapping
  std::vector<SimEvent> sim_event;
  std::vector<Move> move{};  ///< in order of time, not overlapping each other or a doublet

  std::vector<Problem> Problems() const;
  std::vector<Motion> Motions() const;  ///< doublets and moves, in order of time
};

}  // namespace flexarm
