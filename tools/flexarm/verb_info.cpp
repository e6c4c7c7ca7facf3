#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>

#include "controller/files/external_json.h"
#include "controller/files/external_text.h"
#include "controller/files/nesting.h"
#include "controller/host/daemon_identity.h"
#include "controller/runlog/run_labels_file.h"
#include "controller/safety/safety_machine.h"
#include "controller/safety/torque_gate.h"
#include "tools/command_line/config_refusal.h"
#include "tools/command_line/options.h"
#include "tools/command_line/run_choice.h"
#include "tools/command_line/verbs.h"
#include "tools/runs/run_summary.h"

namespace flexarm {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr std::size_t kMostShown = 400;  // bytes of a text of the log

struct InfoOptions {
  RunChoice run;
  bool json = false;
};

OrderedJson TripJson(const LoadedRun& run) {
  const std::optional<SafetyRecord> trip = TripOf(run.contents.safety);
  if (!trip) return nullptr;
  return {{"name", ToString(trip->after.cause)},
          {"time_s", static_cast<double>(trip->due_ns - run.contents.info.start_ns) * 1e-9},
          {"value", NumberOrNull(trip->evidence.value)},
          {"limit", NumberOrNull(trip->evidence.limit)},
          {"channel", trip->evidence.channel},
          {"text", OperatorText(trip->after.cause)}};
}

OrderedJson TimingJson(const std::vector<TimingRecord>& records) {
  if (records.empty()) return nullptr;
  std::vector<double> late_us, took_us;
  for (const TimingRecord& record : records) {
    late_us.push_back(static_cast<double>(record.woke_ns - record.due_ns) * 1e-3);
    took_us.push_back(static_cast<double>(record.finished_ns - record.woke_ns) * 1e-3);
  }
  std::sort(late_us.begin(), late_us.end());
  std::sort(took_us.begin(), took_us.end());
  return {{"late_median_us", late_us[late_us.size() / 2]},
          {"late_max_us", late_us.back()},
          {"took_median_us", took_us[took_us.size() / 2]},
          {"took_max_us", took_us.back()}};
}

std::int64_t MissingTicks(const std::vector<TickRecord>& ticks) {
  if (ticks.empty()) return 0;
  return ticks.back().input.tick - ticks.front().input.tick + 1 -
         static_cast<std::int64_t>(ticks.size());
}

// Longest loop delay of the run, from sampling instant to torque, as measured at the drives.
OrderedJson DelayJson(const LoadedRun& run) {
  if (run.contents.tick.empty()) return nullptr;
  const auto latest = std::max_element(
      run.contents.tick.begin(), run.contents.tick.end(),
      [](const auto& a, const auto& b) { return a.input.acted_late_ns < b.input.acted_late_ns; });
  return 1e3 * run.period_s() + 1e-6 * static_cast<double>(latest->input.acted_late_ns);
}

// Samples of state Running before which the gate changed the torque, by reason.
OrderedJson GateJson(const std::vector<TickRecord>& ticks) {
  OrderedJson json = OrderedJson::object();
  for (const GateReason& reason : kGateReasons) {
    const auto count = std::count_if(ticks.begin(), ticks.end(), [&](const TickRecord& record) {
      return record.input.safety_state == SafetyState::kRunning &&
             (record.gate_reasons & reason.bit) != 0;
    });
    if (count > 0) json[reason.name] = count;
  }
  return json;
}

std::string StateText(const LoadedRun& run) {
  if (run.closed()) {
    return run.digest_holds ? "closed, as it was written" : "DAMAGED since it was written";
  }
  std::string text = run.state == RunState::kWritten
                         ? "is being written"
                         : "was left by a killed program: see flexarm log recover";
  if (run.state == RunState::kLeft && run.left_out_bytes > 0) {
    text += "; " + std::to_string(run.left_out_bytes) +
            " bytes after the last whole record are left out";
  }
  return text;
}

// Null unless it is JSON that can be printed: parser and destructor are recursive.
OrderedJson ResultOf(const std::string& text) {
  if (LineNestedTooDeepJson(text) != 0) return nullptr;
  OrderedJson result = OrderedJson::parse(text, nullptr, false);
  return result.is_discarded() ? OrderedJson(nullptr) : result;
}

// As it is called now: labels can change after a run.
RunLabel LabelOf(const LoadedRun& run) {
  const std::filesystem::path folder = run.file.has_parent_path() ? run.file.parent_path() : ".";
  return ReadRunLabels(folder).Of(run.file.filename().string(), run.contents.info.label);
}

// That of the first sample: which zeros of the counters, and of how many strain channels.
OrderedJson CalibrationJson(const LoadedRun& run) {
  if (run.contents.tick.empty()) return nullptr;
  const Calibration& calibration = run.contents.tick.front().input.calibration;
  const auto known = [](const auto& values) {
    return std::count_if(values.begin(), values.end(), [](float value) { return value != 0.0F; });
  };
  return {{"counter_zero", calibration.counter_zero},
          {"tared_channels", known(calibration.strain_zero_counts)},
          {"scaled_channels", known(calibration.strain_gain_error)}};
}

OrderedJson Info(const LoadedRun& run) {
  const RunInfo& info = run.contents.info;
  const auto& ticks = run.contents.tick;
  OrderedJson json;
  json["run"] = run.file.string();
  const RunLabel label = LabelOf(run);
  json["name"] = TextOrNull(label.name);
  json["note"] = TextOrNull(label.note);
  json["tags"] = label.tags;
  json["start_utc"] = info.start_utc;
  json["rig"] = info.rig_name;
  json["backend"] = info.backend;
  json["clock"] = info.clock;
  json["seed"] = info.seed;
  json["experiment"] = TextOrNull(info.experiment_name);
  json["law"] = TextOrNull(info.law);
  json["payload_kg"] = info.payload_kg ? NumberOrNull(*info.payload_kg) : OrderedJson(nullptr);
  json["config_hash"] = ConfigHash(run.config.text);
  json["calibration"] = CalibrationJson(run);
  json["version"] = info.version;
  json["build_id"] = info.build_id;
  json["closed"] = run.closed();
  json["log"] = StateText(run);
  json["digest"] = run.digest.empty() ? OrderedJson(nullptr) : OrderedJson(run.digest);
  json["digest_holds"] = run.digest_holds;
  json["ticks"] = ticks.size();
  json["missing_ticks"] = MissingTicks(ticks);
  json["duration_s"] =
      ticks.empty()
          ? 0.0
          : static_cast<double>(ticks.back().input.now_ns - ticks.front().input.now_ns) * 1e-9;
  json["delay_max_ms"] = DelayJson(run);
  json["final_state"] = run.contents.safety.empty()
                            ? OrderedJson(nullptr)
                            : OrderedJson(ToString(run.contents.safety.back().after.state));
  json["trip"] = TripJson(run);
  json["gate"] = GateJson(ticks);
  json["result"] = ResultOf(info.result_json);
  const std::optional<RunMetrics> metrics = MetricsOf(run);
  json["metrics"] = metrics ? ToJson(*metrics) : OrderedJson(nullptr);
  json["timing"] = TimingJson(run.contents.timing);
  return json;
}

std::string Text(const OrderedJson& value) {
  if (value.is_null()) return "-";
  if (value.is_string()) return Shown(value.get<std::string>(), kMostShown);
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  std::ostringstream text;
  text << std::setprecision(4);
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) text << (i > 0 ? ", " : "") << Text(value[i]);
  } else if (value.is_number_float()) {
    text << value.get<double>();
  } else {
    text << Shown(value.dump(-1, ' ', true, OrderedJson::error_handler_t::replace), kMostShown);
  }
  return text.str();
}

void PrintLine(const std::string& name, const OrderedJson& value, const std::string& unit = "") {
  std::cout << "  " << std::left << std::setw(24) << name << Text(value)
            << (unit.empty() || value.is_null() ? "" : " " + unit) << '\n';
}

void PrintMetrics(const OrderedJson& metrics, const std::string& settling) {
  std::cout << (metrics["truth"].get<bool>() ? "Metrics, from the plant's true motion\n"
                                             : "Metrics, from the estimate\n");
  PrintLine("joint error, rms", metrics["joint_rms_error_deg"], "deg");
  PrintLine("joint error, largest", metrics["joint_peak_error_deg"], "deg");
  PrintLine("joint error, final", metrics["joint_final_error_deg"], "deg");
  PrintLine("tip settling time", settling);
  PrintLine("tip off its target", metrics["tip_target_error_mm"], "mm");
  PrintLine("tip residual, rms", metrics["tip_residual_rms_mm"], "mm");
  PrintLine("peak torque", metrics["peak_torque_nm"], "N m");
  PrintLine("torque, rms", metrics["torque_rms_nm"], "N m");
  PrintLine("peak bending", metrics["peak_bending_mm"], "mm");
}

void PrintSafety(const RunContents& run) {
  std::cout << "Safety\n" << std::fixed << std::setprecision(3);
  for (const SafetyRecord& record : run.safety) {
    if (record.before == record.after) continue;
    std::cout << std::right << std::setw(10)
              << static_cast<double>(record.due_ns - run.info.start_ns) * 1e-9 << " s  "
              << ToString(record.before.state) << " -> " << ToString(record.after.state);
    if (record.after.cause != TripCause::kNone) std::cout << ": " << ToString(record.after.cause);
    if (record.facts.request != RequestKind::kNone) {
      std::cout << " (" << ToString(record.facts.request) << ")";
    }
    std::cout << '\n';
  }
  std::cout << std::defaultfloat;
}

void PrintText(const OrderedJson& json, const LoadedRun& run) {
  std::cout << Text(json["run"]) << '\n';
  for (const char* key : {"name", "note", "tags", "start_utc", "rig", "backend", "clock", "seed",
                          "experiment", "law", "config_hash", "calibration", "version", "build_id",
                          "log", "digest", "ticks", "missing_ticks"}) {
    PrintLine(key, json[key]);
  }
  PrintLine("payload", json["payload_kg"], "kg");
  PrintLine("duration", json["duration_s"], "s");
  PrintLine("delay, longest", json["delay_max_ms"], "ms");
  PrintLine("final state", json["final_state"]);
  if (!json["trip"].is_null()) {
    PrintLine("TRIPPED", json["trip"]["name"]);
    PrintLine("", json["trip"]["text"]);
  }
  if (const auto metrics = MetricsOf(run)) PrintMetrics(json["metrics"], SettlingText(*metrics));
  if (!json["timing"].is_null()) {
    std::cout << "Timing of the loop\n";
    PrintLine("lateness, worst", json["timing"]["late_max_us"], "us");
    PrintLine("step duration, worst", json["timing"]["took_max_us"], "us");
  }
  if (!run.contents.safety.empty()) PrintSafety(run.contents);
}

}  // namespace

void RegisterInfo(CLI::App& app, Exit&) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App* verb = app.add_subcommand(
      "info", "Summarise a run log: result, safety transitions, metrics, timing");
  options->run.AddTo(verb);
  RefuseConfig(verb, kLogHasItsConfig);
  AddJson(verb, &options->json);
  verb->footer(
      "Metrics: tracking errors, settling time and residual of the tip, torques, bending.\n"
      "Examples: flexarm info runs/today.flexarm\n"
      "          flexarm info --last");
  verb->callback([options] {
    const LoadedRun run = LoadRun(options->run.File());
    const OrderedJson json = Info(run);
    if (options->json) {
      std::cout << PrintedJson(json) << '\n';
    } else {
      PrintText(json, run);
    }
  });
}

}  // namespace flexarm
