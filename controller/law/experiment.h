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

enum class FreezeTarget : std::uint8_t { kNone, kPlant, kControl };

/// A thing that happens to the simulated rig, [[sim_event]]. Real backends refuse it.
struct SimEvent {
  double at_s;               ///< after the start of the experiment
  std::optional<Line> line;  ///< with `level`
  int level;                 ///< 0 or 1, as in LineLevels
  FreezeTarget freeze;       ///< that task stops running
  bool kill;                 ///< the process kills itself with SIGKILL
};

/// What one run does, config/experiments/*.toml.
struct Experiment {
  std::string name;
  std::string text;  ///< the file as it was read, for the log
  double duration_s;
  std::vector<Doublet> doublet;  ///< in order of time, not overlapping
  std::vector<SimEvent> sim_event;

  std::vector<Problem> Problems() const;
};

}  // namespace flexarm
