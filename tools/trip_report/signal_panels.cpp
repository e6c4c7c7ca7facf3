#include "tools/trip_report/signal_panels.h"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <variant>

#include "controller/runlog/csv.h"
#include "controller/runlog/decoded_columns.h"
#include "hal/line_names.h"
#include "model/units.h"

namespace flexarm {
namespace {

constexpr double kMicro = 1e6, kMilli = 1e3;

double NumberOf(const ColumnValue& value) {
  if (const auto* real = std::get_if<double>(&value)) return *real;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  return std::numeric_limits<double>::quiet_NaN();
}

/// Finds the columns of an exported file, which say what each signal is.
class ColumnsOfRun {
 public:
  ColumnsOfRun(const RunInfo& info, const RigConfig& config)
      : columns_(DecodedColumns({.sensors = config.sensors,
                                 .tip = TipGeometryOf(config),
                                 .start_ns = info.start_ns,
                                 .simulated = false,
                                 .timed = false,
                                 .with_raw = false})) {}

  PanelSignal Signal(std::string label, const std::string& column, double factor = 1.0) const {
    const auto found = std::ranges::find(columns_, column, &DecodedColumn::name);
    if (found == columns_.end()) throw std::logic_error("no column is called " + column);
    return {.label = std::move(label),
            .value = [value = found->value, factor](const TickRecord& record) {
              return factor * NumberOf(value({.tick = record, .timing = nullptr}));
            }};
  }
  /// A reference, which has a meaning in Running only.
  PanelSignal Reference(const std::string& column) const {
    PanelSignal signal = Signal("reference", column);
    signal.is_reference = true;
    signal.value = [value = std::move(signal.value)](const TickRecord& record) {
      return record.input.safety_state == SafetyState::kRunning
                 ? value(record)
                 : std::numeric_limits<double>::quiet_NaN();
    };
    return signal;
  }

 private:
  std::vector<DecodedColumn> columns_;
};

std::vector<double> Both(double limit) { return {-limit, limit}; }

SignalPanel Gauges(const ColumnsOfRun& columns, const RigConfig& config, std::size_t joint) {
  const std::string n = std::to_string(joint + 1);
  SignalPanel panel{.title = "Link " + n + ": strain of each gauge",
                    .unit = "microstrain",
                    .signal = {},
                    .limit = Both(kMicro * config.safety.strain_limit[joint]),
                    .row = {}};
  for (const std::string& name : StrainColumns(config.sensors)) {
    if (!name.starts_with("strain_" + n + "_")) continue;
    panel.signal.push_back(columns.Signal(name, name + "_microstrain"));
  }
  return panel;
}

void AddJoint(const ColumnsOfRun& columns, const RigConfig& config, std::size_t joint,
              std::vector<SignalPanel>* panels) {
  const std::string n = std::to_string(joint + 1);
  const SafetyConfig& safety = config.safety;
  panels->push_back({.title = "Hub " + n + ": angle",
                     .unit = "deg",
                     .signal = {columns.Signal("encoder", "hub_" + n + "_deg"),
                                columns.Signal("estimate", "estimated_hub_" + n + "_deg"),
                                columns.Reference("reference_" + n + "_deg")},
                     .limit = Both(safety.soft_angle_deg[joint]),
                     .row = {}});
  panels->push_back({.title = "Hub " + n + ": rate",
                     .unit = "deg/s",
                     .signal = {columns.Signal("estimate", "estimated_hub_rate_" + n + "_deg_s"),
                                columns.Reference("reference_rate_" + n + "_deg_s")},
                     .limit = Both(kDegPerRad * safety.hub_rate_rad_s[joint]),
                     .row = {}});
  panels->push_back({.title = "Link " + n + ": strain at the root",
                     .unit = "microstrain",
                     .signal = {columns.Signal("fitted", "root_strain_" + n + "_microstrain")},
                     .limit = Both(kMicro * safety.strain_limit[joint]),
                     .row = {}});
  panels->push_back(Gauges(columns, config, joint));
  panels->push_back({.title = "Joint " + n + ": torque",
                     .unit = "N m",
                     .signal = {columns.Signal("applied", "torque_applied_" + n + "_nm"),
                                columns.Signal("asked", "torque_asked_" + n + "_nm")},
                     .limit = Both(safety.torque_limit_nm[joint]),
                     .row = {}});
}

PanelSignal Innovation(std::size_t joint) {
  return {.label = "hub " + std::to_string(joint + 1), .value = [joint](const TickRecord& record) {
            return kMilli * record.output.innovation[joint];
          }};
}

void AddEstimate(const ColumnsOfRun& columns, const RigConfig& config,
                 std::vector<SignalPanel>* panels) {
  panels->push_back({.title = "Estimate: deflection of the links' tips",
                     .unit = "mm",
                     .signal = {columns.Signal("link 1", "estimated_deflection_1_m", kMilli),
                                columns.Signal("link 2", "estimated_deflection_2_m", kMilli)},
                     .limit = {},
                     .row = {}});
  panels->push_back({.title = "Residual: hub encoders against the estimator's prediction",
                     .unit = "mrad",
                     .signal = {Innovation(0), Innovation(1)},
                     .limit = Both(kMilli * config.estimator.innovation_limit_rad),
                     .row = {}});
  panels->push_back({.title = "Residual: gauges against the fitted modes, rms",
                     .unit = "microstrain",
                     .signal = {columns.Signal("link 1", "fit_residual_1_microstrain"),
                                columns.Signal("link 2", "fit_residual_2_microstrain")},
                     .limit = {},
                     .row = {}});
  panels->push_back({.title = "Payload estimate",
                     .unit = "kg",
                     .signal = {columns.Signal("payload", "payload_kg"),
                                columns.Signal("its standard deviation", "payload_sigma_kg")},
                     .limit = {},
                     .row = {}});
}

// A row each: closed, which is healthy for a switch, is higher.
SignalPanel Inputs() {
  SignalPanel panel{.title = "Switch inputs", .unit = "1", .signal = {}, .limit = {}, .row = {}};
  for (int i = 0; i < kLines; ++i) {
    const auto line = static_cast<Line>(i);
    panel.row.emplace_back(ToString(line));
    panel.signal.push_back({.label = ToString(line), .value = [line, i](const TickRecord& record) {
                              const bool closed = (record.input.frame.levels & LineBit(line)) != 0;
                              return i + (closed ? 0.8 : 0.1);
                            }});
  }
  return panel;
}

}  // namespace

std::vector<SignalPanel> SignalPanels(const RunInfo& info, const RigConfig& config) {
  const ColumnsOfRun columns(info, config);
  std::vector<SignalPanel> panels;
  for (std::size_t joint = 0; joint < 2; ++joint) AddJoint(columns, config, joint, &panels);
  AddEstimate(columns, config, &panels);
  panels.push_back(Inputs());
  return panels;
}

}  // namespace flexarm
