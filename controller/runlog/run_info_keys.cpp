#include "controller/runlog/run_info_keys.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "controller/runlog/build_info.h"
#include "controller/runlog/run_label.h"
#include "controller/runlog/schema.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

struct TextKey {
  const char* key;
  std::string RunInfo::* text;
};

constexpr std::array kTextKeys = {
    TextKey{run_key::kStartUtc, &RunInfo::start_utc},
    TextKey{run_key::kVersion, &RunInfo::version},
    TextKey{run_key::kBuildId, &RunInfo::build_id},
    TextKey{run_key::kRigName, &RunInfo::rig_name},
    TextKey{run_key::kClock, &RunInfo::clock},
    TextKey{run_key::kBackend, &RunInfo::backend},
    TextKey{run_key::kConfig, &RunInfo::config_text},
    TextKey{run_key::kExperimentName, &RunInfo::experiment_name},
    TextKey{run_key::kExperiment, &RunInfo::experiment_text},
    TextKey{run_key::kGains, &RunInfo::gains_json},
    TextKey{run_key::kLaw, &RunInfo::law},
};

template <typename T>
T IntegerOf(const std::string& text) {
  T value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::optional<double> NumberOf(const std::string& text) {
  double value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  return read.ec == std::errc() && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

std::vector<InfoRecord> InfoKeys(const RunInfo& info) {
  RunInfo filled = info;
  if (filled.version.empty()) filled.version = ThisBuild().version;
  if (filled.build_id.empty()) filled.build_id = BuildId();
  std::vector<InfoRecord> keys = {{run_key::kStartNs, std::to_string(info.start_ns)},
                                  {run_key::kSeed, std::to_string(info.seed)}};
  for (const TextKey& key : kTextKeys) keys.push_back({key.key, filled.*key.text});
  keys.push_back({run_key::kPayload, info.payload_kg ? NumberText(*info.payload_kg) : ""});
  keys.push_back({run_key::kLabel, LabelToJson(info.label).dump()});
  return keys;
}

void SetInfo(RunInfo* info, const std::string& key, const std::string& value) {
  if (key == run_key::kStartNs) info->start_ns = IntegerOf<std::int64_t>(value);
  if (key == run_key::kSeed) info->seed = IntegerOf<std::uint64_t>(value);
  if (key == run_key::kResult) info->result_json = value;
  if (key == run_key::kPayload) info->payload_kg = NumberOf(value);
  if (key == run_key::kLabel) info->label = LabelOfText(value);
  for (const TextKey& text : kTextKeys) {
    if (key == text.key) info->*text.text = value;
  }
}

}  // namespace flexarm
