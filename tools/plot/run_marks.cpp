#include "tools/plot/run_marks.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "hal/line_names.h"

namespace flexarm {
namespace {

std::string Short(double value, int digits = 3) {
  if (!std::isfinite(value)) return "-";
  std::ostringstream text;
  text.precision(digits);
  text << value;
  return text.str();
}

std::string Two(const std::array<double, 2>& pair) {
  return Short(pair[0]) + ", " + Short(pair[1]);
}

// Payload of the simulated arm at the start of the run; empty: not simulated, not known.
std::string SimulatedPayload(const LoadedRun& run) {
  for (const RunEvent& event : run.contents.event) {
    if (event.kind != "simulation" || event.name != "payload") continue;
    const auto value = nlohmann::json::parse(event.value_json, nullptr, false);
    if (value.is_object() && value.contains("payload_kg") && value["payload_kg"].is_number()) {
      return Short(value["payload_kg"].get<double>()) + " kg";
    }
  }
  return {};
}

// What an event is called on the time axis; empty: it is not drawn.
std::string MarkText(const RunEvent& event) {
  if (event.kind == "command") return event.name;
  if (event.kind == "refusal") return event.name + " refused";
  if (event.kind == "warning") return "warning: " + event.name;
  if (event.kind == "gap") return "samples missing";
  if (event.kind == "lease" || event.kind == "bus") return event.kind + ": " + event.name;
  return {};
}

std::string MarkText(const SimEvent& event) {
  if (event.payload_kg) return "payload " + Short(*event.payload_kg) + " kg";
  if (event.line) {
    return std::string(ToString(*event.line)) + (event.level != 0 ? " closed" : " opened");
  }
  if (event.kill) return "process killed";
  return event.freeze == FreezeTarget::kPlant ? "plant stopped" : "control thread stopped";
}

}  // namespace

std::int64_t TimeZero_ns(const LoadedRun& run) {
  const auto& ticks = run.contents.tick;
  const auto first = std::find_if(ticks.begin(), ticks.end(), [](const TickRecord& record) {
    return record.input.safety_state == SafetyState::kRunning;
  });
  if (first == ticks.end()) return run.contents.info.start_ns;
  return first->input.sampling_instant_ns + std::llround(run.period_s() * 1e9) +
         first->input.acts_late_ns;
}

std::string TitleOf(const LoadedRun& run) {
  const RunInfo& info = run.contents.info;
  return (info.experiment_name.empty() ? "no experiment" : info.experiment_name) + ", " +
         LawOf(run.config.controller.kind).name + " on " + info.rig_name;
}

std::string DetailsOf(const LoadedRun& run) {
  const RunInfo& info = run.contents.info;
  const std::string payload = SimulatedPayload(run);
  std::string text = info.start_utc;
  text += payload.empty() ? "; designed for " + Short(run.config.arm.payload_mass_kg) + " kg"
                          : "; payload " + payload + ", designed for " +
                                Short(run.config.arm.payload_mass_kg) + " kg";
  if (info.backend == "sim") text += "; simulated, seed " + std::to_string(info.seed);
  return text + "; " + run.file.filename().string();
}

std::string ReplayCommand(const LoadedRun& run) {
  const std::string file = run.file.string();
  if (file.find_first_of(" '\"$`\\*?;&|<>()") == std::string::npos) return "flexarm replay " + file;
  std::string quoted;
  for (const char c : file) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return "flexarm replay '" + quoted + "'";
}

std::string TripText(const LoadedRun& run, std::int64_t zero_ns) {
  const std::optional<SafetyRecord> trip = TripOf(run.contents.safety);
  if (!trip) return {};
  std::string text = ToString(trip->after.cause);
  if (trip->evidence.limit != 0.0) {
    text += ": " + Short(trip->evidence.value, 4) + " of " + Short(trip->evidence.limit, 4);
  }
  return text + " at " + Short(static_cast<double>(trip->due_ns - zero_ns) * 1e-9) + " s";
}

std::vector<PlotRun::Mark> MarksOf(const LoadedRun& run, std::int64_t zero_ns) {
  constexpr double kAtStart_s = 0.05;  // the command that starts the run, and those before it
  std::vector<PlotRun::Mark> marks;
  for (const RunEvent& event : run.contents.event) {
    const double at_s = static_cast<double>(event.time_ns - zero_ns) * 1e-9;
    const std::string text = MarkText(event);
    if (!text.empty() && at_s > kAtStart_s) marks.push_back({at_s, text, false});
  }
  const double end_s =
      run.contents.tick.empty()
          ? 0.0
          : static_cast<double>(run.contents.tick.back().input.sampling_instant_ns - zero_ns) *
                1e-9;
  if (run.experiment && run.contents.info.backend == "sim") {
    for (const SimEvent& event : run.experiment->sim_event) {
      if (event.at_s <= end_s) marks.push_back({event.at_s, MarkText(event), false});
    }
  }
  if (const auto trip = TripOf(run.contents.safety)) {
    marks.push_back({static_cast<double>(trip->due_ns - zero_ns) * 1e-9,
                     "TRIP " + std::string(ToString(trip->after.cause)), true});
  }
  std::stable_sort(marks.begin(), marks.end(),
                   [](const auto& a, const auto& b) { return a.at_s < b.at_s; });
  return marks;
}

std::vector<std::string> FigureLines(const RunMetrics& metrics) {
  std::vector<std::string> lines = {"joint error, rms: " + Two(metrics.joint_rms_error_deg) +
                                    " deg"};
  if (std::isfinite(metrics.tip_target_error_mm)) {
    lines.push_back("at rest: joints off by " + Two(metrics.joint_final_error_deg) + " deg");
    lines.push_back("tip settling: " + SettlingText(metrics));
    lines.push_back("tip off its target: " + Short(metrics.tip_target_error_mm) +
                    " mm, then moves " + Short(metrics.tip_residual_rms_mm) + " mm rms");
  } else {
    lines.emplace_back("the run ended before a rest: nothing to say about settling");
  }
  lines.push_back("peak torque: " + Two(metrics.peak_torque_nm) + " N m");
  return lines;
}

}  // namespace flexarm
