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
    {"state", "text", 0,
     [](const TickRecord& r) -> ColumnValue {
       return std::string_view(ToString(r.input.safety_state));
     }},
    {"hub_1_deg", "deg", 1e4,
     [](const TickRecord& r) -> ColumnValue { return r.output.angle_rad[0] * kDegPerRad; }},
    {"hub_2_deg", "deg", 1e4,
     [](const TickRecord& r) -> ColumnValue { return r.output.angle_rad[1] * kDegPerRad; }},
    {"rotor_1_deg", "deg", 1e4,
     [](const TickRecord& r) -> ColumnValue { return r.output.angle_rad[2] * kDegPerRad; }},
    {"rotor_2_deg", "deg", 1e4,
     [](const TickRecord& r) -> ColumnValue { return r.output.angle_rad[3] * kDegPerRad; }},
    {"reference_1_deg", "deg", 1e4,
     [](const TickRecord& r) -> ColumnValue { return r.input.reference_now.x_m[0] * kDegPerRad; }},
    {"reference_2_deg", "deg", 1e4,
     [](const TickRecord& r) -> ColumnValue { return r.input.reference_now.x_m[1] * kDegPerRad; }},
    {"torque_asked_1_nm", "N m", 1e4,
     [](const TickRecord& r) -> ColumnValue { return r.output.torque_nm[0]; }},
    {"torque_asked_2_nm", "N m", 1e4,
     [](const TickRecord& r) -> ColumnValue { return r.output.torque_nm[1]; }},
    {"torque_applied_1_nm", "N m", 1e4,
     [](const TickRecord& r) -> ColumnValue { return r.input.applied_torque_nm[0]; }},
    {"torque_applied_2_nm", "N m", 1e4,
     [](const TickRecord& r) -> ColumnValue { return r.input.applied_torque_nm[1]; }},
    {"modal_11_m", "m", 1e6,
     [](const TickRecord& r) -> ColumnValue { return r.output.modal_m[0]; }},
    {"modal_12_m", "m", 1e6,
     [](const TickRecord& r) -> ColumnValue { return r.output.modal_m[1]; }},
    {"modal_21_m", "m", 1e6,
     [](const TickRecord& r) -> ColumnValue { return r.output.modal_m[2]; }},
    {"modal_22_m", "m", 1e6,
     [](const TickRecord& r) -> ColumnValue { return r.output.modal_m[3]; }},
    {"adaptive_gain_change", "mixed", 0,
     [](const TickRecord& r) -> ColumnValue { return r.output.adaptive_gain_change; }},
    {"lyapunov_nm2", "(N m)^2", 0,
     [](const TickRecord& r) -> ColumnValue { return r.output.lyapunov_nm2; }},
    {"saturated_1_s", "s", 0,
     [](const TickRecord& r) -> ColumnValue { return r.output.saturated_s[0]; }},
    {"saturated_2_s", "s", 0,
     [](const TickRecord& r) -> ColumnValue { return r.output.saturated_s[1]; }},
    {"payload_kg", "kg", 1e4,
     [](const TickRecord& r) -> ColumnValue { return r.output.payload_kg; }},
    {"payload_sigma_kg", "kg", 1e4,
     [](const TickRecord& r) -> ColumnValue { return r.output.payload_sigma_kg; }},
    {"friction_1_nm", "N m", 0,
     [](const TickRecord& r) -> ColumnValue { return r.output.friction_nm[0]; }},
    {"friction_2_nm", "N m", 0,
     [](const TickRecord& r) -> ColumnValue { return r.output.friction_nm[1]; }},
    {"mean_nis", "1", 0, [](const TickRecord& r) -> ColumnValue { return r.output.mean_nis; }},
    {"delay_found", "samples", 0,
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.output.delay_found}; }},
    {"planned", "0 or 1", 1,
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.input.planned}; }},
    {"counter_1", "count", 0,
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.input.frame.counter[0]}; }},
    {"counter_2", "count", 0,
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.input.frame.counter[1]}; }},
    {"counter_3", "count", 0,
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.input.frame.counter[2]}; }},
    {"counter_4", "count", 0,
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.input.frame.counter[3]}; }},
    {"faults", "bits", 1,
     [](const TickRecord& r) -> ColumnValue { return static_cast<std::int64_t>(r.output.faults); }},
    {"limits", "bits", 1,
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.output.limits}; }},
    {"gate", "bits", 1,
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.gate_reasons}; }},
    {"truth_known", "0 or 1", 0,
     [](const TickRecord& r) -> ColumnValue { return std::int64_t{r.truth.known ? 1 : 0}; }},
    {"truth_hub_1_rad", "rad", 0,
     [](const TickRecord& r) -> ColumnValue { return Known(r, r.truth.hub_angle_rad[0]); }},
    {"truth_hub_2_rad", "rad", 0,
     [](const TickRecord& r) -> ColumnValue { return Known(r, r.truth.hub_angle_rad[1]); }},
    {"truth_tip_x_m", "m", 1e6,
     [](const TickRecord& r) -> ColumnValue { return Known(r, r.truth.tip_m[0]); }},
    {"truth_tip_y_m", "m", 1e6,
     [](const TickRecord& r) -> ColumnValue { return Known(r, r.truth.tip_m[1]); }},
    {"truth_deflection_1_m", "m", 0,
     [](const TickRecord& r) -> ColumnValue { return Known(r, r.truth.tip_deflection_m[0]); }},
    {"truth_deflection_2_m", "m", 0,
     [](const TickRecord& r) -> ColumnValue { return Known(r, r.truth.tip_deflection_m[1]); }},
});

}  // namespace

std::span<const TickColumn> TickColumns() { return kColumns; }

}  // namespace flexarm
