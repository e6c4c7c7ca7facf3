#include "tools/runs/run_summary.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "controller/runlog/errors.h"

namespace flexarm {
namespace {

nlohmann::ordered_json Pair(const std::array<double, 2>& pair) {
  return nlohmann::ordered_json::array({NumberOrNull(pair[0]), NumberOrNull(pair[1])});
}

}  // namespace

nlohmann::ordered_json TextOrNull(const std::string& text) {
  return text.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(text);
}

nlohmann::ordered_json NumberOrNull(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

RigConfig ConfigOf(const RunReader& reader) {
  const std::string name = reader.file().string() + " (its config)";
  if (reader.info().config_text.empty()) {
    throw InputError(reader.file().string() +
                     ": contains no config; expected the whole config text");
  }
  return ParseConfig(reader.info().config_text, name);
}

LoadedRun LoadRun(const std::filesystem::path& file) {
  RunReader reader(file);
  LoadedRun run{.file = file,
                .state = reader.state(),
                .left_out_bytes = reader.left_out_bytes(),
                .digest = reader.digest(),
                .digest_holds = reader.DigestHolds(),
                .contents = reader.ReadAll(),
                .config = ConfigOf(reader),
                .experiment = std::nullopt};
  const RunInfo& info = run.contents.info;
  // Of pluck and home it is their command, a JSON object: they have no experiment to judge.
  if (!info.experiment_text.empty() && !info.experiment_text.starts_with('{')) {
    run.experiment = ParseExperiment(info.experiment_text, file.string() + " (its experiment)");
  }
  return run;
}

std::optional<RunMetrics> MetricsOf(const LoadedRun& run) {
  if (!run.experiment) return std::nullopt;
  return ComputeMetrics(run.contents.tick, *run.experiment, run.period_s(),
                        TipGeometryOf(run.config));
}

nlohmann::ordered_json ToJson(const RunMetrics& metrics) {
  nlohmann::ordered_json json;
  json["ticks"] = metrics.ticks;
  json["joint_rms_error_deg"] = Pair(metrics.joint_rms_error_deg);
  json["joint_peak_error_deg"] = Pair(metrics.joint_peak_error_deg);
  json["joint_final_error_deg"] = Pair(metrics.joint_final_error_deg);
  json["tip_settling_time_s"] =
      metrics.tip_settling_time_s ? NumberOrNull(*metrics.tip_settling_time_s) : nullptr;
  json["tip_target_error_mm"] = NumberOrNull(metrics.tip_target_error_mm);
  json["tip_residual_rms_mm"] = NumberOrNull(metrics.tip_residual_rms_mm);
  json["tip_last_second_rms_mm"] = NumberOrNull(metrics.tip_last_second_rms_mm);
  json["tip_motion_rms_mm"] = NumberOrNull(metrics.tip_motion_rms_mm);
  json["peak_torque_nm"] = Pair(metrics.peak_torque_nm);
  json["torque_rms_nm"] = Pair(metrics.torque_rms_nm);
  json["peak_bending_mm"] = Pair(metrics.peak_bending_mm);
  json["truth"] = metrics.truth;
  return json;
}

std::string SettlingText(const RunMetrics& metrics) {
  if (std::isnan(metrics.tip_target_error_mm)) return "no rest to judge";
  if (!metrics.tip_still_within_15mm_s) return "not settled: still moving at the end of a rest";
  std::array<char, 64> text{};
  if (metrics.tip_settling_time_s) {
    std::snprintf(text.data(), text.size(), "%.2f s", *metrics.tip_settling_time_s);
  } else {
    std::snprintf(text.data(), text.size(), "not settled: %.0f mm off its target",
                  metrics.tip_target_error_mm);
  }
  return text.data();
}

std::optional<SafetyRecord> TripOf(const std::vector<SafetyRecord>& records) {
  for (const SafetyRecord& record : records) {
    if (Trips(record)) return record;
  }
  return std::nullopt;
}

}  // namespace flexarm
