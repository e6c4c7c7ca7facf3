#include "tools/csv/csv_report.h"

#include <nlohmann/json.hpp>

#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "controller/runlog/csv.h"
#include "controller/runlog/csv_sampling.h"
#include "controller/types/rounded_text.h"
#include "tools/runs/run_summary.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

const char* SeparatorName(char separator) {
  switch (separator) {
    case ';':
      return "semicolon";
    case '\t':
      return "tab";
    default:
      return "comma";
  }
}

const char* UnitOfTarget(const std::string& target) {
  if (target == "time") return "s";
  if (target.starts_with("torque")) return "N m";
  return target.starts_with("strain") ? "V" : "rad";
}

std::string Rounded(const Json& value) { return RoundedText(value.get<double>(), 6); }

std::string Joined(const Json& names) {
  std::string text;
  for (const Json& name : names) {
    text += (text.empty() ? "" : ", ") + Shown(name.get<std::string>());
  }
  return text.empty() ? "none" : text;
}

Json VerdictJson(const ScaleVerdict& verdict) {
  Json json{{"verdict", ToString(verdict.kind)},
            {"factor", nullptr},
            {"standard_error", nullptr},
            {"correlation", nullptr}};
  if (!verdict.fit) return json;
  json["factor"] = NumberOrNull(verdict.fit->factor);
  json["standard_error"] = NumberOrNull(verdict.fit->sigma);
  json["correlation"] = NumberOrNull(verdict.fit->correlation);
  return json;
}

}  // namespace

Json CsvMappingJson(const RigConfig& config) {
  if (!config.csv) return nullptr;
  const CsvImport& import = *config.csv;
  const double period_s = config.loop.period_s();
  Json json;
  json["separator"] = import.separator == 0 ? Json(nullptr) : Json(SeparatorName(import.separator));
  json["resample"] = import.resample;
  json["decimation"] = import.resample ? Json(nullptr) : Json(import.decimation);
  json["rate_hz"] = import.resample ? Json(nullptr) : Json(import.decimation / period_s);
  json["longest_gap_s"] = import.resample ? Json(LongestGap_s(import, period_s)) : Json(nullptr);
  for (const CsvColumn& column : import.column) {
    json["columns"].push_back({{"column", column.column},
                               {"target", column.target},
                               {"unit", column.unit.name},
                               {"scale", column.scale},
                               {"offset", column.offset},
                               {"value_of_one", column.scale * column.unit.si},
                               {"target_unit", UnitOfTarget(column.target)}});
  }
  return json;
}

Json CsvFactsJson(const CsvFacts& facts, const RigConfig& config) {
  Json json;
  json["format"] = facts.own ? "flexarm" : "other";
  json["separator"] = SeparatorName(facts.separator);
  json["decimal"] = facts.decimal_comma ? "comma" : "point";
  json["units_row"] = facts.units_row;
  json["used"] = facts.used;
  json["unused"] = facts.unused;
  json["missing"] = Json::array();
  json["rows"] = facts.rows;
  json["duration_s"] = facts.duration_s;
  json["rate_hz"] = facts.row_spacing_s > 0.0 ? Json(1.0 / facts.row_spacing_s) : Json(nullptr);
  json["resampled"] = nullptr;
  if (facts.resampling) {
    json["resampled"] = {{"to_hz", 1.0 / config.loop.period_s()},
                         {"longest_gap_s", facts.resampling->longest_gap_s},
                         {"longest_missing_s", facts.resampling->longest_missing_s},
                         {"rows_left_out", facts.resampling->rows_left_out},
                         {"samples_not_read", facts.resampling->samples_not_read}};
  }
  json["beyond_range"] = Json::object();
  const std::vector<std::string> names = StrainColumns(config.sensors);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (facts.beyond_range[i] > 0) json["beyond_range"][names[i]] = facts.beyond_range[i];
  }
  return json;
}

Json CsvFileJson(const std::filesystem::path& file, const RigConfig& config) {
  const CsvImport* import = config.csv ? &*config.csv : nullptr;
  Json json;
  json["file"] = file.string();
  try {
    const CsvRun run = ReadAnyCsv(file, import, config.sensors, config.loop.period_s());
    json.update(CsvFactsJson(run.facts, config));
    json["samples"] = run.input.size();
    json["problem"] = nullptr;
  } catch (const InputError& error) {
    json["problem"] = error.what();
    const CsvColumnUse use = ColumnsIn(file, import, config.sensors);
    json["format"] = use.own ? "flexarm" : "other";
    json["used"] = use.used;
    json["unused"] = use.unused;
    json["missing"] = use.missing;
  }
  return json;
}

Json ScalesJson(const StrainScaleResult& result, const std::vector<std::string>& warnings,
                const RigConfig& config) {
  Json json;
  for (const ScaleVerdict& link : result.link) json["links"].push_back(VerdictJson(link));
  const std::vector<std::string> names = StrainColumns(config.sensors);
  json["channels"] = Json::object();
  for (std::size_t i = 0; i < names.size(); ++i) {
    json["channels"][names[i]] = VerdictJson(result.channel[i]);
  }
  json["warnings"] = warnings;
  return json;
}

std::vector<std::string> CsvMappingText(const Json& mapping) {
  std::vector<std::string> lines;
  for (const Json& column : mapping["columns"]) {
    std::string line = Shown(column["column"].get<std::string>()) + " -> " +
                       Shown(column["target"].get<std::string>()) + ": " +
                       Rounded(column["scale"]) + " x cell in " + column["unit"].get<std::string>();
    if (column["offset"] != 0.0) line += " + " + Rounded(column["offset"]);
    line += "; a cell of 1 is " + Rounded(column["value_of_one"]) + " " +
            column["target_unit"].get<std::string>();
    lines.push_back(line);
  }
  lines.push_back(mapping["resample"].get<bool>()
                      ? "rows of any times are interpolated, over at most " +
                            Rounded(mapping["longest_gap_s"]) + " s"
                      : "decimation " + std::to_string(mapping["decimation"].get<int>()) +
                            ": rows at " + Rounded(mapping["rate_hz"]) + " Hz");
  lines.push_back("separator " + (mapping["separator"].is_null()
                                      ? std::string("as the header has it")
                                      : mapping["separator"].get<std::string>()));
  return lines;
}

std::vector<std::string> CsvFactsText(const Json& facts) {
  std::vector<std::string> lines = {"used: " + Joined(facts["used"]),
                                    "not used: " + Joined(facts["unused"]),
                                    "missing: " + Joined(facts["missing"])};
  if (!facts.contains("rows")) return lines;
  std::string line = std::to_string(facts["rows"].get<std::int64_t>()) + " rows over " +
                     Rounded(facts["duration_s"]) + " s";
  if (!facts["rate_hz"].is_null()) line += ", " + Rounded(facts["rate_hz"]) + " Hz";
  line += ", separator " + facts["separator"].get<std::string>();
  if (facts["decimal"] == "comma") line += ", decimal comma";
  if (facts["units_row"].get<bool>()) line += ", a row of units";
  lines.push_back(line);
  const Json& resampled = facts["resampled"];
  if (!resampled.is_null()) {
    lines.push_back("interpolated at " + Rounded(resampled["to_hz"]) +
                    " Hz; rows whose time did not advance, " +
                    "left out: " + std::to_string(resampled["rows_left_out"].get<std::int64_t>()) +
                    "; longest time without a reading " + Rounded(resampled["longest_missing_s"]) +
                    " s; samples with a sensor that counts as not read, beyond " +
                    Rounded(resampled["longest_gap_s"]) +
                    " s: " + std::to_string(resampled["samples_not_read"].get<std::int64_t>()));
  }
  for (const auto& [channel, count] : facts["beyond_range"].items()) {
    lines.push_back(channel + ": " + std::to_string(count.get<std::int64_t>()) +
                    " readings beyond the range of the converter");
  }
  return lines;
}

}  // namespace flexarm
