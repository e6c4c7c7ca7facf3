#include "controller/operator/sensor_json.h"

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "controller/runlog/csv.h"
#include "estimator/strain_scale.h"
#include "model/units.h"

namespace flexarm {
namespace {

bool HasTick(const OperatorSnapshot& now) { return now.tick.input.now_ns != 0; }

// Of a reading: a bus that is lost leaves the last good one, with its instant.
double AgeMs(const OperatorSnapshot& now, std::int32_t offset_ns) {
  return static_cast<double>(now.now_ns - now.tick.input.frame.sampled_at_ns - offset_ns) * 1e-6;
}

bool HasBit(std::uint32_t bits, std::size_t i) { return (bits >> i & 1U) != 0; }

}  // namespace

nlohmann::json GaugesJson(const OperatorSnapshot& now, const SensorConfig& sensors) {
  nlohmann::json all = nlohmann::json::array();
  if (!HasTick(now)) return all;
  const StepInput& in = now.tick.input;
  const std::vector<std::string> names = StrainColumns(sensors);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const StrainScale scale = Calibrated(StrainScaleOf(sensors, i), in.calibration, i);
    all.push_back({{"name", names[i]},
                   {"link", sensors.strain[i].link},
                   {"counts", in.frame.strain[i]},
                   {"counts_limit", sensors.strain_input.highest_count()},
                   {"strain", StrainOf(scale, in.frame.strain[i])},
                   {"used", HasBit(now.tick.output.strain_used, i)},
                   {"age_ms", AgeMs(now, in.frame.strain_offset_ns[i])}});
  }
  return all;
}

nlohmann::json EncodersJson(const OperatorSnapshot& now, const SensorConfig& sensors) {
  nlohmann::json all = nlohmann::json::array();
  if (!HasTick(now)) return all;
  const StepInput& in = now.tick.input;
  const StepOutput& out = now.tick.output;
  for (std::size_t i = 0; i < std::size_t{kCounters}; ++i) {
    if (!HasBit(sensors.counters_present(), i)) continue;
    all.push_back({{"name", CounterName(static_cast<int>(i))},
                   {"counts", out.counts[i]},
                   {"angle_deg", out.angle_rad[i] * kDegPerRad},
                   {"used", HasBit(out.counters_used, i)},
                   {"age_ms", AgeMs(now, in.frame.counter_offset_ns[i])}});
  }
  return all;
}

nlohmann::json TickAgeJson(const OperatorSnapshot& now) {
  if (!HasTick(now)) return nullptr;
  return static_cast<double>(now.now_ns - now.tick.input.now_ns) * 1e-6;
}

nlohmann::json PermitAgeJson(const OperatorSnapshot& now) {
  if (now.permit.renewed_ns == INT64_MIN) return nullptr;
  return static_cast<double>(now.now_ns - now.permit.renewed_ns) * 1e-6;
}

}  // namespace flexarm
