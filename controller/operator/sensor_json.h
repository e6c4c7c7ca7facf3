#pragma once

#include <nlohmann/json_fwd.hpp>

#include "controller/operator/operator_snapshot.h"
#include "hal/sensor_config.h"

namespace flexarm {

/// Part "gauges" of the status: a list of the strain channels in the order of the config, each
/// {name, link, counts, counts_limit, strain, used, age_ms}. Before the first sample: empty.
/// Pure function. Not real-time safe.
nlohmann::json GaugesJson(const OperatorSnapshot& now, const SensorConfig& sensors);

/// Part "encoders": a list of the counters that the rig has, each {name, counts, angle_deg, used,
/// age_ms}. The angle is that of the counter, relative to its zero, also while the angle of the
/// joint is unknown. Before the first sample: empty. Pure function. Not real-time safe.
nlohmann::json EncodersJson(const OperatorSnapshot& now, const SensorConfig& sensors);

/// Age of the newest sample when the operator task looked, ms; null: there is none yet.
nlohmann::json TickAgeJson(const OperatorSnapshot& now);

/// Age of the permit, ms: how long ago the safety task ran; null: it has not run yet.
nlohmann::json PermitAgeJson(const OperatorSnapshot& now);

}  // namespace flexarm
