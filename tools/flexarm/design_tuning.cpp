#include "tools/flexarm/design_tuning.h"

#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "controller/files/external_json.h"
#include "tools/command_line/verbs.h"
#include "tools/tuning/tuning_search.h"

namespace flexarm {
namespace {

constexpr int kMostDesigns = 150;

nlohmann::ordered_json ToJson(const DesignScore& score) {
  return {{"score", score.value}, {"verdict", ToString(score.result)}, {"found", score.found}};
}

nlohmann::ordered_json ToJson(const Tuning& tuning, const std::vector<std::string>& obstacles) {
  nlohmann::ordered_json json;
  json["before"] = ToJson(tuning.before);
  json["after"] = ToJson(tuning.after);
  json["changed"] = nlohmann::ordered_json::array();
  for (const TunedKey& key : tuning.changed) {
    json["changed"].push_back({{"key", key.key}, {"before", key.before}, {"after", key.after}});
  }
  json["obstacles"] = obstacles;
  return json;
}

void PrintText(const Tuning& tuning, const std::vector<std::string>& obstacles) {
  std::printf(
      "margins: %.3g before, %.3g after (0: a check just passes or fails; 1: all with room)\n",
      tuning.before.value, tuning.after.value);
  if (tuning.changed.empty()) {
    std::printf(tuning.after.value >= 1.0 ? "every margin has room: nothing to change\n"
                                          : "nothing better was found\n");
  } else {
    std::printf("lines to change:\n");
  }
  for (const TunedKey& key : tuning.changed) {
    std::printf("%s = %s  # was %s\n", key.key.c_str(), key.after.c_str(), key.before.c_str());
  }
  if (!tuning.after.found.empty()) std::printf("still: %s\n", tuning.after.found.c_str());
  for (const std::string& obstacle : obstacles) std::printf("in the way: %s\n", obstacle.c_str());
}

}  // namespace

int TuneAndPrint(const RigConfig& config, bool json) {
  const bool show = isatty(STDERR_FILENO) == 1 && !json;
  const Tuning tuning = TuneDesign(config, kMostDesigns, [show](int designs, double score) {
    if (show)
      std::fprintf(stderr, "\rdesign %d of at most %d, margins %.3g ", designs, kMostDesigns,
                   score);
  });
  if (show) std::fprintf(stderr, "\r\033[K");
  const bool sound = tuning.after.result == DesignVerdict::Result::kSound;
  const std::vector<std::string> obstacles =
      sound ? std::vector<std::string>() : ObstaclesOf(config);
  if (json) {
    std::cout << PrintedJson(ToJson(tuning, obstacles)) << '\n';
  } else {
    PrintText(tuning, obstacles);
  }
  return sound ? Exit::kDone : Exit::kFailed;
}

}  // namespace flexarm
