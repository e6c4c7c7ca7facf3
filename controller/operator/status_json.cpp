#include "controller/operator/status_json.h"

#include "controller/operator/json_values.h"
#include "controller/operator/payload_json.h"
#include "controller/operator/sensor_json.h"
#include "controller/types/shown_reference.h"
#include "hal/line_names.h"
#include "model/units.h"

namespace flexarm {
namespace {

nlohmann::json AnglesJson(const AngleKnowledge& angles, const StepOutput& out) {
  nlohmann::json all = nlohmann::json::array();
  for (std::size_t joint = 0; joint < 2; ++joint) {
    all.push_back(angles.knows(joint) ? nlohmann::json(out.angle_rad[joint] * kDegPerRad)
                                      : nlohmann::json(nullptr));
  }
  return all;
}

nlohmann::json ReferenceJson(const StepInput& in) {
  const auto reference_rad = ShownReference(in);
  if (!reference_rad) return nullptr;
  return {(*reference_rad)[0] * kDegPerRad, (*reference_rad)[1] * kDegPerRad};
}

// As the estimator has them; of an angle that is unknown, too.
nlohmann::json HubRatesJson(const StateLayout& layout, const StepOutput& out) {
  nlohmann::json rates = nlohmann::json::array();
  for (int joint = 0; joint < 2; ++joint) {
    rates.push_back(out.x_hat[static_cast<std::size_t>(layout.rate(layout.hub(joint)))]);
  }
  return rates;
}

// What makes the torque of a sample; null: no torque is allowed.
nlohmann::json TorqueSourceJson(const StepInput& in) {
  if (!TorqueAllowed(in.safety_state)) return nullptr;
  if (in.mode == LoopMode::kOpenLoop) return "open-loop";
  if (in.mode == LoopMode::kRegulate) return "regulator";
  return in.safety_state == SafetyState::kRunning ? "law" : "stop-controller";
}

nlohmann::json TripJson(const StatusSources& sources) {
  const Permit& permit = sources.now->permit;
  if (!CauseLatched(permit.state)) return nullptr;
  const std::optional<HeldTrip>& held = sources.latch->trip();
  nlohmann::json json =
      CauseJson(permit.cause, permit.evidence, *sources.sensors, sources.bus_text);
  json["text"] = OperatorText(permit.cause);
  json["time_utc"] = TextOrNull(held ? held->time_utc : std::string());
  json["before_start"] = held && held->before_start;
  json["record_problem"] = TextOrNull(held ? held->record_problem : std::string());
  json["report"] = TextOrNull(sources.trip_report);
  return json;
}

nlohmann::json InputsJson(LineLevels levels) {
  nlohmann::json all = nlohmann::json::object();
  for (int i = 0; i < kLines; ++i) {
    const auto line = static_cast<Line>(i);
    all[ToString(line)] = (levels & LineBit(line)) != 0 ? 1 : 0;
  }
  return all;
}

}  // namespace

nlohmann::json BusesJson(const std::vector<BusHealth>& buses) {
  nlohmann::json all = nlohmann::json::array();
  for (const BusHealth& bus : buses) {
    all.push_back({{"name", bus.name},
                   {"ok", bus.ok},
                   {"fault", TextOrNull(bus.fault)},
                   {"notice", TextOrNull(bus.notice)},
                   {"failed", bus.failed},
                   {"recovered", bus.recovered},
                   {"failed_in_window", bus.failed_in_window},
                   {"slow", bus.slow},
                   {"slow_in_window", bus.slow_in_window},
                   {"longest_ms", bus.longest_ms},
                   {"declared_ms", bus.declared_ms},
                   {"counters", CountersJson(bus.counters)}});
  }
  return all;
}

nlohmann::json CountersJson(const std::vector<BusCounter>& counters) {
  nlohmann::json all = nlohmann::json::object();
  for (const BusCounter& counter : counters) all[counter.name] = counter.value;
  return all;
}

nlohmann::json TimingJson(const TimingCounts& counts, bool trips) {
  return {{"trips", trips},
          {"safety_overruns", counts.safety_overruns},
          {"safety_worst_ms", static_cast<double>(counts.oldest_permit_ns) * 1e-6},
          {"deadlines_missed_in_a_row", counts.deadlines_missed},
          {"deadlines_often_missed", counts.deadlines_often_missed}};
}

nlohmann::json StatusJson(const StatusSources& sources) {
  const OperatorSnapshot& now = *sources.now;
  const StepInput& in = now.tick.input;
  const StepOutput& out = now.tick.output;
  nlohmann::json json{
      {"ok", true},
      {"protocol", kProtocolVersion},
      {"state", ToString(now.permit.state)},
      {"time_s", static_cast<double>(now.now_ns) * 1e-9},
      {"tick", in.tick},
      {"experiment", TextOrNull(sources.experiment)},
      {"joint_angle_deg", AnglesJson(*sources.angles, out)},
      {"joint_angle_unknown",
       {TextOrNull(sources.angles->Text(0)), TextOrNull(sources.angles->Text(1))}},
      {"reference_deg", ReferenceJson(in)},
      {"hub_rate_rad_s", HubRatesJson(sources.layout, out)},
      {"torque_source", TorqueSourceJson(in)},
      {"torque_nm", out.torque_nm},
      {"modal_m", out.modal_m},
      {"root_strain", out.root_strain},
      {"gauges", GaugesJson(now, *sources.sensors)},
      {"gauges_missing", sources.missing_gauges},
      {"encoders", EncodersJson(now, *sources.sensors)},
      {"tick_age_ms", TickAgeJson(now)},
      {"permit_age_ms", PermitAgeJson(now)},
      {"at_rest", out.at_rest != 0},
      {"payload", PayloadJson(in, out)},
      {"delay_ms", sources.delay->delay_ms()},
      {"delay_max_ms", sources.delay->longest_ms()},
      {"delay_margin_ms", sources.delay->margin_ms()},
      {"levels", in.frame.levels},
      {"inputs", InputsJson(now.permit.levels)},
      {"relay_closed", RelayClosed(now.permit.state)},
      {"trip", TripJson(sources)},
      {"present", PresentJson(*sources.present, *sources.sensors, sources.bus_text)},
      {"lease", sources.lease},
      {"run", sources.run},
      {"wiring",
       {{"proved", sources.why_no_run.empty()}, {"why_not", TextOrNull(sources.why_no_run)}}},
      {"latch_problem", TextOrNull(sources.latch->problem())},
      {"timing", TimingJson(sources.timing, sources.late_threads_trip)},
      {"buses", BusesJson(sources.buses)},
      {"log_records_dropped", sources.log_records_dropped},
      {"threads", sources.threads},
      {"host", sources.host},
      {"design", sources.design},
      {"overrides", sources.overrides},
      {"switches", sources.switches},
      {"log", sources.log},
      {"telemetry", sources.telemetry},
      {"health", sources.health}};
  json.update(sources.identity);
  return json;
}

}  // namespace flexarm
