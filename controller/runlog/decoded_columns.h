#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "controller/realtime/timing_record.h"
#include "controller/runlog/metrics.h"
#include "controller/runlog/tick_columns.h"
#include "hal/sensor_config.h"

namespace flexarm {

/// What decides which decoded columns a run has, and what they need beside its samples.
struct DecodedRun {
  SensorConfig sensors;
  TipGeometry tip;        ///< of the estimated state
  std::int64_t start_ns;  ///< time_s = 0, in the clock of the loop
  bool simulated;         ///< the log has the true motion
  bool timed;             ///< the log has the wall-clock times of the control task
  bool with_raw;          ///< also the counts that the values are decoded from
};

/// A sample and the activation of the control task that computed it; null if it was not recorded.
struct DecodedSample {
  const TickRecord& tick;
  const TimingRecord* timing;
};

/// A column of people's values: the name carries its unit, and `unit` is it in words.
struct DecodedColumn {
  std::string name;
  std::string unit;
  std::function<ColumnValue(const DecodedSample& sample)> value;
};

/// All decoded columns of a run: those of table `tick`, then what a reader would have to compute
/// from the BLOBs and the config. docs/run-logs.md lists them; a test compares.
std::vector<DecodedColumn> DecodedColumns(const DecodedRun& run);

}  // namespace flexarm
