#include "controller/operator/switch_proof_record.h"

#include <nlohmann/json.hpp>

#include "hal/line_names.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kKind = "switch-proof";
constexpr int kVersion = 1;
constexpr double kDay_s = 86'400.0;
constexpr std::int64_t kClockTolerance_s = 60;  // a clock that was corrected meanwhile

Json LinesJson(const std::optional<GpiodConfig>& lines) {
  if (!lines) return nullptr;
  Json json{{"chip", lines->chip}};
  for (int i = 0; i < kLines; ++i) {
    json[ToString(static_cast<Line>(i))] = lines->input[static_cast<std::size_t>(i)];
  }
  json["relay"] = lines->relay;
  json["pump"] = lines->pump;
  return json;
}

}  // namespace

std::string SwitchProofText(const std::optional<GpiodConfig>& lines, std::int64_t proved_s) {
  const Json json{{"flexarm", kKind},
                  {"version", kVersion},
                  {"proved_unix_s", proved_s},
                  {"lines", LinesJson(lines)}};
  return json.dump(1) + "\n";
}

std::string WhyNoProof(const std::string& text, const std::optional<GpiodConfig>& lines,
                       double valid_days, std::int64_t now_s) {
  const Json json = Json::parse(text, nullptr, false);
  const auto is = [&json](const char* key, const Json& value) {
    const auto found = json.find(key);
    return found != json.end() && *found == value;
  };
  if (!json.is_object() || !is("flexarm", kKind) || !is("version", kVersion) ||
      !json.contains("proved_unix_s") || !json["proved_unix_s"].is_number_integer()) {
    return "the proof of the switches cannot be read: it is not a file of this version";
  }
  if (!is("lines", LinesJson(lines))) {
    return "the switches were proved on other lines than those of [hal.gpiod] now";
  }
  const double age_s = static_cast<double>(now_s) - json["proved_unix_s"].get<double>();
  if (age_s < -static_cast<double>(kClockTolerance_s)) {
    return "the switches were proved in the future: check the clock of the computer";
  }
  if (age_s > valid_days * kDay_s) {
    return "the switches were proved " + std::to_string(static_cast<int>(age_s / kDay_s)) +
           " days ago, longer than safety.prove_days";
  }
  return {};
}

}  // namespace flexarm
