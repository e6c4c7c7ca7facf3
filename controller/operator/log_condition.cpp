#include "controller/operator/log_condition.h"

#include "controller/operator/json_values.h"

namespace flexarm {
std::optional<UnmetCondition> UnmetLog(const RunFiles* files) {
  if (files == nullptr) return std::nullopt;
  const LogStatus log = files->status();
  if (!log.required || log.ready) return std::nullopt;
  const std::string why = log.error.empty() ? "the disk has not answered" : log.error;
  return UnmetCondition{.name = "log",
                        .refusal = "no-log",
                        .found = "there is no file for the log of the next run: " + why,
                        .remedy =
                            "make room or mend the disk (`flexarm status` shows `log`), and "
                            "repeat; log.required = false in the config does without",
                        .may_override = false};
}

nlohmann::json LogJson(const RunFiles* files) {
  if (files == nullptr) return nullptr;
  const LogStatus log = files->status();
  return {{"file", TextOrNull(log.file)},
          {"ok", log.error.empty()},
          {"error", TextOrNull(log.error)},
          {"free_mb", log.free_mb ? nlohmann::json(*log.free_mb) : nlohmann::json(nullptr)},
          {"ready", log.ready},
          {"required", log.required}};
}

}  // namespace flexarm
