#include "config/attachment.h"

#include <algorithm>
#include <numbers>

#include "config/config.h"
#include "config/document.h"
#include "config/toml_text.h"
#include "controller/files/external_file.h"
#include "controller/runlog/csv_table.h"
#include "controller/runlog/errors.h"
#include "model/units.h"

namespace flexarm {
namespace {

bool Attached(const toml::table& document, const std::string& file) {
  const toml::array* rows = document["attached"].as_array();
  if (rows == nullptr) return false;
  return std::any_of(rows->begin(), rows->end(), [&file](const toml::node& row) {
    const toml::table* table = row.as_table();
    return table != nullptr && (*table)["file"].value<std::string>() == file;
  });
}

}  // namespace

std::string WithAttachments(const std::string& text, const std::filesystem::path& file) {
  const toml::table document = ParseToml(text, file.string());
  const toml::node* key = document["csv"]["file"].node();
  const auto name = document["csv"]["file"].value<std::string>();
  if (!name || name->empty() || Attached(document, *name)) return text;
  const std::filesystem::path csv = (file.parent_path() / *name).lexically_normal();
  const auto refuse = [&](const std::string& rule) {
    throw ConfigError({{file.string(), static_cast<int>(key->source().begin.line), "csv.file",
                        ValueText(*key), rule}});
  };
  std::error_code error;
  if (!std::filesystem::exists(csv, error)) refuse("there is no file " + csv.string());
  const std::string content = ReadConfigFile(csv, kTrajectoryFile);
  if (content.find("'''") != std::string::npos) refuse("must be a CSV file of numbers");
  return text + "\n[[attached]]\nfile = " + ValueText(*key) + "\ntext = '''\n" + content + "'''\n";
}

std::vector<TrajectoryPoint> ReadTrajectory(const std::string& file, const std::string& text) {
  CsvTable table(file, text);
  const bool degrees = table.Has("th1_deg");
  const std::array<std::string, 2> column = {degrees ? "th1_deg" : "th1_rad",
                                             degrees ? "th2_deg" : "th2_rad"};
  table.Need({"time_s", column[0], column[1]});
  const double unit = degrees ? kRadPerDeg : 1.0;
  std::vector<TrajectoryPoint> points;
  while (table.Next()) {
    const double time_s = table.Number("time_s");
    if (points.empty() && time_s != 0.0) table.FailCell("time_s", "0 in the first row");
    if (!points.empty() && !(time_s > points.back().time_s)) {
      table.FailCell("time_s", "a later time than in the row above");
    }
    points.push_back(
        {.time_s = time_s,
         .angle_rad = {unit * table.Number(column[0]), unit * table.Number(column[1])}});
  }
  if (points.size() < 2) throw InputError(file + ": expected at least two rows of numbers");
  return points;
}

}  // namespace flexarm
