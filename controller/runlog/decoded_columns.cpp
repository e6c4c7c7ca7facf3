#include "controller/runlog/decoded_columns.h"

#include <limits>
#include <string_view>

#include "controller/runlog/csv.h"
#include "estimator/strain_scale.h"
#include "model/units.h"

namespace flexarm {
namespace {

constexpr double kMicrostrain = 1e6;  // in one unit of strain
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

using Columns = std::vector<DecodedColumn>;

// Adds a column whose value is a number computed by `value` from a sample.
template <typename Value>
void Add(Columns* columns, std::string name, std::string unit, Value value) {
  columns->push_back(
      {std::move(name), std::move(unit),
       [value](const DecodedSample& sample) -> ColumnValue { return value(sample); }});
}

void AddTickTable(const DecodedRun& run, Columns* columns) {
  Add(columns, "tick", "samples",
      [](const DecodedSample& sample) { return sample.tick.input.tick; });
  Add(columns, "time_s", "s", [start_ns = run.start_ns](const DecodedSample& sample) {
    return static_cast<double>(sample.tick.input.sampling_instant_ns - start_ns) * 1e-9;
  });
  for (const TickColumn& column : TickColumns()) {
    const std::string_view name = column.name;
    if (name.starts_with("counter_") && !run.with_raw) continue;
    if (name.starts_with("truth_") && !run.simulated) continue;
    Add(columns, column.name, column.unit,
        [value = column.value](const DecodedSample& sample) { return value(sample.tick); });
  }
}

void AddSensors(const DecodedRun& run, Columns* columns) {
  const std::vector<std::string> names = StrainColumns(run.sensors);
  for (std::size_t i = 0; i < names.size(); ++i) {
    Add(columns, names[i] + "_microstrain", "microstrain",
        [i, scale = StrainScaleOf(run.sensors, i)](const DecodedSample& sample) {
          const StepInput& input = sample.tick.input;
          return kMicrostrain *
                 StrainOf(Calibrated(scale, input.calibration, i), input.frame.strain[i]);
        });
  }
  if (!run.sensors.tip_accelerometer) return;
  Add(columns, "tip_acceleration_m_s2", "m/s^2",
      [unit = run.sensors.tip_accelerometer->m_s2_per_count()](const DecodedSample& sample) {
        return unit * sample.tick.input.frame.accelerometer[0];
      });
}

void AddFit(Columns* columns) {
  for (std::size_t link = 0; link < 2; ++link) {
    const std::string end = std::to_string(link + 1) + "_microstrain";
    Add(columns, "root_strain_" + end, "microstrain", [link](const DecodedSample& sample) {
      return kMicrostrain * sample.tick.output.root_strain[link];
    });
    Add(columns, "fit_residual_" + end, "microstrain", [link](const DecodedSample& sample) {
      return kMicrostrain * sample.tick.output.fit_residual[link];
    });
  }
  Add(columns, "strain_used", "bits",
      [](const DecodedSample& sample) { return std::int64_t{sample.tick.output.strain_used}; });
  Add(columns, "counters_used", "bits",
      [](const DecodedSample& sample) { return std::int64_t{sample.tick.output.counters_used}; });
}

void AddReferenceAndEstimate(const StateLayout& layout, Columns* columns) {
  for (int joint = 0; joint < 2; ++joint) {
    const std::string number = std::to_string(joint + 1);
    const auto angle = static_cast<std::size_t>(layout.hub(joint));
    const auto rate = static_cast<std::size_t>(layout.rate(layout.hub(joint)));
    Add(columns, "reference_rate_" + number + "_deg_s", "deg/s",
        [rate](const DecodedSample& sample) {
          return sample.tick.input.reference_now.x_m[rate] * kDegPerRad;
        });
    Add(columns, "estimated_hub_" + number + "_deg", "deg", [angle](const DecodedSample& sample) {
      return sample.tick.output.x_hat[angle] * kDegPerRad;
    });
    Add(columns, "estimated_hub_rate_" + number + "_deg_s", "deg/s",
        [rate](const DecodedSample& sample) {
          return sample.tick.output.x_hat[rate] * kDegPerRad;
        });
    for (int mode = 0; mode < layout.modes_per_link; ++mode) {
      const auto coordinate = static_cast<std::size_t>(layout.mode(joint, mode));
      Add(columns, "estimated_modal_" + number + std::to_string(mode + 1) + "_m", "m",
          [coordinate](const DecodedSample& sample) {
            return sample.tick.output.x_hat[coordinate];
          });
    }
  }
}

void AddEstimatedTip(const TipGeometry& tip, Columns* columns) {
  for (std::size_t link = 0; link < 2; ++link) {
    Add(columns, "estimated_deflection_" + std::to_string(link + 1) + "_m", "m",
        [link, layout = tip.layout](const DecodedSample& sample) {
          return EstimatedDeflection_m(layout, sample.tick.output.x_hat)[link];
        });
  }
  for (std::size_t axis = 0; axis < 2; ++axis) {
    Add(columns, axis == 0 ? "estimated_tip_x_m" : "estimated_tip_y_m", "m",
        [axis, tip](const DecodedSample& sample) {
          return EstimatedTip(tip, sample.tick.output.x_hat)[axis];
        });
  }
}

void AddTiming(const DecodedRun& run, Columns* columns) {
  Add(columns, "torque_acts_late_ms", "ms", [](const DecodedSample& sample) {
    return static_cast<double>(sample.tick.input.acts_late_ns) * 1e-6;
  });
  if (!run.timed) return;
  Add(columns, "late_us", "us", [](const DecodedSample& sample) {
    const TimingRecord* timing = sample.timing;
    return timing == nullptr ? kUnknown
                             : static_cast<double>(timing->woke_ns - timing->due_ns) * 1e-3;
  });
  Add(columns, "took_us", "us", [](const DecodedSample& sample) {
    const TimingRecord* timing = sample.timing;
    return timing == nullptr ? kUnknown
                             : static_cast<double>(timing->finished_ns - timing->woke_ns) * 1e-3;
  });
}

// The counters are in table `tick`.
void AddRaw(const SensorConfig& sensors, Columns* columns) {
  const std::vector<std::string> names = StrainColumns(sensors);
  for (std::size_t i = 0; i < names.size(); ++i) {
    Add(columns, names[i], "count", [i](const DecodedSample& sample) {
      return std::int64_t{sample.tick.input.frame.strain[i]};
    });
  }
  if (sensors.tip_accelerometer) {
    Add(columns, "tip_acceleration", "count", [](const DecodedSample& sample) {
      return std::int64_t{sample.tick.input.frame.accelerometer[0]};
    });
  }
  Add(columns, "counter_valid", "bits", [](const DecodedSample& sample) {
    return std::int64_t{sample.tick.input.frame.counter_valid};
  });
  Add(columns, "strain_valid", "bits", [](const DecodedSample& sample) {
    return std::int64_t{sample.tick.input.frame.strain_valid};
  });
}

}  // namespace

std::vector<DecodedColumn> DecodedColumns(const DecodedRun& run) {
  Columns columns;
  AddTickTable(run, &columns);
  AddSensors(run, &columns);
  AddFit(&columns);
  AddReferenceAndEstimate(run.tip.layout, &columns);
  AddEstimatedTip(run.tip, &columns);
  AddTiming(run, &columns);
  if (run.with_raw) AddRaw(run.sensors, &columns);
  return columns;
}

}  // namespace flexarm
