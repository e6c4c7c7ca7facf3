#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "controller/types/step_types.h"
#include "hal/sim/plant_truth.h"

namespace flexarm {

/// What the simulated arm did, by the step that took it as a frame.
struct TruthRecord {
  std::int64_t tick;
  PlantTruth truth;
};

/// Record of one sample, from the control task to the recorder.
struct TickRecord {
  StepInput input;
  StepOutput output;
  /// GateBits (torque_gate.h) of the torque that acted in the period before the sample.
  std::uint32_t gate_reasons;
  std::uint32_t run_number;         ///< of the present run, or of the last (Permit); 0: none yet
  std::uint32_t change_number = 0;  ///< of the change that it follows (RunChange); 0: none
  std::int32_t sample = -1;         ///< of its experiment; it stays while the run is paused
  PlantTruth truth;                 ///< of the simulated stack: the recorder adds it
  /// Of a record that was read from a log, which has not all of the output (record_blocks.h): of
  /// all its bytes. 0: the output is whole.
  std::uint64_t output_checksum;
};

/// Event: a trip, a refusal, a command of the operator, a gap in the log.
struct RunEvent {
  std::int64_t time_ns = 0;  ///< in the clock of the loop
  std::string kind;          ///< "command", "refusal", "trip", "gap", "experiment", ...
  std::string name;          ///< short machine name within the kind
  std::string text;          ///< for the operator
  std::string value_json;    ///< one JSON object, or empty
};

/// How users call a run. Its limits: run_label.h of controller/runlog.
struct RunLabel {
  std::string name, note;  ///< empty: none
  std::vector<std::string> tags;

  friend bool operator==(const RunLabel&, const RunLabel&) = default;
};

/// Metadata of a run: everything that replay needs besides the records.
struct RunInfo {
  std::string start_utc;      ///< ISO 8601, set by the writer if empty
  std::int64_t start_ns = 0;  ///< time 0 of the log, in the clock of the loop
  std::string version;        ///< version of the program
  std::string build_id;       ///< build of the program; set by the writer if empty
  std::string rig_name;
  std::string clock;  ///< "monotonic" or "simulated"
  std::string backend;
  std::uint64_t seed = 0;
  std::string config_text;      ///< complete
  std::string experiment_name;  ///< empty: no experiment was run
  std::string experiment_text;
  std::string gains_json;  ///< full precision
  std::string law;         ///< controller.name
  std::optional<double>
      payload_kg;  ///< of the simulated arm; empty: a rig, whose payload is unknown
  RunLabel label;
  std::string result_json;  ///< empty until the run is closed
};

}  // namespace flexarm
