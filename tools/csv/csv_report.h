#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "config/config.h"
#include "controller/runlog/csv_import.h"
#include "tools/csv/strain_scale_check.h"

namespace flexarm {

/// The table [csv] of a config: which column is which channel, its unit, scale and decimation.
nlohmann::ordered_json CsvMappingJson(const RigConfig& config);

/// What a CSV file holds and what is missing in it, or why it cannot be read: key `problem`.
nlohmann::ordered_json CsvFileJson(const std::filesystem::path& file, const RigConfig& config);

/// What was found in a file that was read.
nlohmann::ordered_json CsvFactsJson(const CsvFacts& facts, const RigConfig& config);

/// The verdicts on the scales of the strains, and the warnings.
nlohmann::ordered_json ScalesJson(const StrainScaleResult& result,
                                  const std::vector<std::string>& warnings,
                                  const RigConfig& config);

/// The first two for people, a line each.
std::vector<std::string> CsvMappingText(const nlohmann::ordered_json& mapping);
std::vector<std::string> CsvFactsText(const nlohmann::ordered_json& facts);

}  // namespace flexarm
