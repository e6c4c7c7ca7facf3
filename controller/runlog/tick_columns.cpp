#include "controller/runlog/tick_columns.h"

#include <array>
#include <limits>

#include "model/units.h"

namespace flexarm {
namespace {

double Known(const TickRecord& r, double value) {
  return r.truth.known ? value : std::numeric_limits<double>::quiet_NaN();
}

// gate: GateBits of controller/safety/torque_gate.h, of the torque that was applied.
constexpr auto kColumns = std::to_array<TickColumn>({
    {"state", "TEXT", "text",
     [](const TickRecord& r) -> ColumnValue {
       return std::string_view(ToString(r.input.safety_state));
     }},
    {"hub_1_deg", "REAL", "deg",
     [](const TickRecord& r) -> ColumnValue { return r.output.angle_rad[0] * kDegPerRad; }},
    {"hub_2_deg", "REAL", "deg",
     [](const TickRecord& r) -> ColumnValue { return r.output.angle_rad[1] * kDegPerRad; }},
    {"rotor_1_deg", "REAL", "deg",
     [](const TickRecord& r) -> ColumnValue { return r.output.angle_rad[2] * kDegPerRad; }},
    {"rotor_2_deg", "REAL", "deg",
     [](const TickRecord& r) -> ColumnValue { return r.output.angle_rad[3] * kDegPerRad; }},
    {"reference_1_deg", "REAL", "deg",
     [](const TickRecord& r) -> ColumnValue { return r.input.reference_now.x_m[0] * kDegPerRad; }},
    {"reference_2_deg", "REAL", "deg",
     [](const TickRecord& r) -> ColumnValue { return r.input.reference_now.x_m[1] * kDegPerRad; }},
    {"torque_asked_1_nm", "REAL", "N m",
     [](const TickRecord& r) -> ColumnValue { return r.output.torque_nm[0]; }},
    {"torque_asked_2_nm", "REAL", "N m",
     [](const TickRecord& r) -> ColumnValue { return r.output.torque_nm[1]; }},
    {"torque_applied_1_nm", "REAL", "N m",
     [](const TickRecord& r) -> ColumnValue { return r.input.applied_torque_nm[0]; }},
    {"torque_applied_2_nm", "REAL", "N m",
     [](const TickRecord& r) -> ColumnValue { return r.input.applied_torque_nm[1]; }},
    {"modal_11_m", "REAL", "m",
     [](const TickRecord& r) -> ColumnValue { return r.output.modal_m[0]; }},
    {"modal_12_m", "REAL", "m",
     [](const TickRecord& r) -> ColumnValue { return r.output.modal_m[1]; }},
    {"modal_21_m", "REAL", "m",
     [](const TickRecord& r) -> ColumnValue { return r.output.modal_m[2]; }},
    {"modal_22_m", "REAL", "m",
     [](const TickRecord& r) -> ColumnValue { return r.output.modal_m[3]; }},
    {"adaptive_gain_change", "REAL", "mixed",
     [](const TickRecord& r) -> ColumnValue { return r.output.adaptive_gain_change; }},
    {"lyapunov_nm2", "REAL", "(N m)^2",
     [](const TickRecord& r) -> ColumnValue { return r.output.lyapunov_nm2; }},
    {"saturated_1_s", "REAL", "s",
     [](const TickRecord& r) -> ColumnValue { return r.output.saturated_s[0]; }},
    {"saturated_2_s", "REAL", "s",
     [](const TickRecord& r) -> ColumnValue { return r.output.saturated_s[1]; }},
    {"payload_kg", "REAL", "kg",
     [](const TickRecord& r) -> ColumnValue { return r.output.payload_kg; }},
    {"payload_sigma_kg", "REAL", "kg",
     [](const TickRecord& r) -> ColumnValue { return r.output.payload_sigma_kg; }},
    {"friction_1_nm", "REAL", "N m",
     [](const TickRecord& r) -> ColumnValue { return r.output.friction_nm[0]; }},
    {"friction_2_nm", "REAL", "N m",
     [](const TickRecord& r) -> ColumnValue { return r.output.friction_nm[1]; }},
    {"mean_nis", "REAL", "1", [](const TickRecord& r) -> ColumnValue { return r.output.mean_nis; }},
    {"delay_found", "INTEGER", "samples",
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.output.delay_found}; }},
    {"planned", "INTEGER", "0 or 1",
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.input.planned}; }},
    {"counter_1", "INTEGER", "count",
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.input.frame.counter[0]}; }},
    {"counter_2", "INTEGER", "count",
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.input.frame.counter[1]}; }},
    {"counter_3", "INTEGER", "count",
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.input.frame.counter[2]}; }},
    {"counter_4", "INTEGER", "count",
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.input.frame.counter[3]}; }},
    {"faults", "INTEGER", "bits",
     [](const TickRecord& r) -> ColumnValue { return static_cast<std::int64_t>(r.output.faults); }},
    {"limits", "INTEGER", "bits",
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.output.limits}; }},
    {"gate", "INTEGER", "bits",
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.gate_reasons}; }},
    {"truth_known", "INTEGER", "0 or 1",
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.truth.known ? 1 : 0}; }},
    {"truth_hub_1_rad", "REAL", "rad",
     [](const TickRecord& r) -> ColumnValue { return Known(r, r.truth.hub_angle_rad[0]); }},
    {"truth_hub_2_rad", "REAL", "rad",
     [](const TickRecord& r) -> ColumnValue { return Known(r, r.truth.hub_angle_rad[1]); }},
    {"truth_tip_x_m", "REAL", "m",
     [](const TickRecord& r) -> ColumnValue { return Known(r, r.truth.tip_m[0]); }},
    {"truth_tip_y_m", "REAL", "m",
     [](const TickRecord& r) -> ColumnValue { return Known(r, r.truth.tip_m[1]); }},
    {"truth_deflection_1_m", "REAL", "m",
     [](const TickRecord& r) -> ColumnValue { return Known(r, r.truth.tip_deflection_m[0]); }},
    {"truth_deflection_2_m", "REAL", "m",
     [](const TickRecord& r) -> ColumnValue { return Known(r, r.truth.tip_deflection_m[1]); }},
});

}  // namespace

std::span<const TickColumn> TickColumns() { return kColumns; }

std::string CreateTickTable() {
  std::string sql = "CREATE TABLE tick (tick INTEGER PRIMARY KEY, time_s REAL";
  for (const TickColumn& column : kColumns) {
    sql.append(", ").append(column.name).append(" ").append(column.type);
  }
  return sql + ", input BLOB NOT NULL, output BLOB NOT NULL);";
}

std::string InsertTick() {
  std::string sql = "INSERT INTO tick VALUES (?,?";
  for (std::size_t i = 0; i < kColumns.size(); ++i) sql += ",?";
  return sql + ",?,?)";
}

}  // namespace flexarm
