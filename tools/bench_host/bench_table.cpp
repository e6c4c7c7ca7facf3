#include "tools/bench_host/bench_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <sstream>

namespace flexarm {
namespace {

std::string TimeText(const std::optional<Timing>& time) {
  if (!time) return "";
  return DurationText(time->median_s) + " (" + DurationText(time->lower_quartile_s) + " to " +
         DurationText(time->upper_quartile_s) + ", " + std::to_string(time->repetitions) + ")";
}

// 1234567 as 1,234,567.
std::string GroupedText(std::int64_t number) {
  std::string text = std::to_string(number);
  for (auto at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3) {
    text.insert(static_cast<std::size_t>(at), ",");
  }
  return text;
}

std::string RatioText(const std::optional<BenchRatio>& ratio) {
  if (!ratio) return "";
  const std::string value = ratio->value < 100.0 ? fmt::format("{:.3g}", ratio->value)
                                                 : fmt::format("{:.0f}", ratio->value);
  std::string text = "**" + value + "** " + ratio->unit;
  if (!ratio->bar) return text;
  const bool reached = ratio->value >= *ratio->bar;
  return text + fmt::format(" (bar {:g}: {})", *ratio->bar, reached ? "reached" : "MISSED");
}

// What a cell of Markdown cannot hold.
std::string CellText(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  std::replace(text.begin(), text.end(), '|', '/');
  return text;
}

std::string ResultText(const BenchRow& row) {
  if (!row.not_measured.empty()) return "not measured: " + row.not_measured;
  std::string text = RatioText(row.ratio);
  for (const std::string& part : {row.result, row.counted == kSingleStepped ? "" : row.counted}) {
    if (!text.empty() && !part.empty()) text += "; ";
    text += part;
  }
  return text;
}

void AddMachine(std::ostringstream& page, const BenchReport& report) {
  const MachineNotes& m = report.machine;
  page << "| | |\n|---|---|\n"
       << "| processor | " << CellText(m.processor) << (m.is_virtual ? ", virtual" : "") << ", "
       << m.cores << " cores |\n"
       << "| kernel, governor | " << m.kernel << ", "
       << (m.governor.empty() ? "none" : CellText(m.governor)) << " |\n"
       << "| load before, share of a core | "
       << fmt::format("{:.1f}, {:.0f} %", m.load, 100.0 * m.processor_share) << " |\n| build | "
       << m.build << ", " << m.build_type << " |\n"
       << "| config | " << CellText(report.config) << " |\n";
  for (const FloatBound& bound : report.bounds) {
    page << "| one core, " << bound.what << " | " << fmt::format("{:.1f}", 1e-9 * bound.flops_per_s)
         << " Gflop/s |\n";
  }
}

nlohmann::ordered_json MachineJson(const MachineNotes& machine) {
  return {{"processor", machine.processor},
          {"cores", machine.cores},
          {"virtual", machine.is_virtual},
          {"kernel", machine.kernel},
          {"governor", machine.governor},
          {"load", machine.load},
          {"processor_share", machine.processor_share},
          {"compiler", machine.compiler},
          {"build_type", machine.build_type}};
}

nlohmann::ordered_json RowJson(const BenchRow& row, double bound_flops_per_s) {
  nlohmann::ordered_json json = {{"name", row.name},
                                 {"what", row.what},
                                 {"median_s", nullptr},
                                 {"lower_quartile_s", nullptr},
                                 {"upper_quartile_s", nullptr},
                                 {"repetitions", nullptr},
                                 {"flops", nullptr},
                                 {"instructions", nullptr},
                                 {"counted", row.counted},
                                 {"flops_per_s", nullptr},
                                 {"bound_share", nullptr},
                                 {"ratio_of", nullptr},
                                 {"ratio", nullptr},
                                 {"ratio_unit", nullptr},
                                 {"ratio_bar", nullptr},
                                 {"result", row.result},
                                 {"not_measured", nullptr}};
  if (row.time) {
    json["median_s"] = row.time->median_s;
    json["lower_quartile_s"] = row.time->lower_quartile_s;
    json["upper_quartile_s"] = row.time->upper_quartile_s;
    json["repetitions"] = row.time->repetitions;
  }
  if (row.work) {
    json["flops"] = row.work->flops;
    json["instructions"] = row.work->instructions;
  }
  if (const std::optional<double> share = BoundShare(row, bound_flops_per_s)) {
    json["flops_per_s"] = *share * bound_flops_per_s;
    json["bound_share"] = *share;
  }
  if (row.ratio) {
    json["ratio_of"] = row.ratio->name;
    json["ratio"] = row.ratio->value;
    json["ratio_unit"] = row.ratio->unit;
    if (row.ratio->bar) json["ratio_bar"] = *row.ratio->bar;
  }
  if (!row.not_measured.empty()) json["not_measured"] = row.not_measured;
  return json;
}

}  // namespace

std::string DurationText(double seconds) {
  constexpr std::array<const char*, 4> kUnits = {"s", "ms", "us", "ns"};
  std::size_t unit = 0;
  double value = seconds;
  for (; value < 0.9995 && unit + 1 < kUnits.size(); ++unit) value *= 1e3;  // 3 digits: not 1000
  return fmt::format("{:.3g} {}", value, kUnits[unit]);
}

std::string BenchMarkdown(const BenchReport& report) {
  std::ostringstream page;
  page << kBenchHostMark << "\n\nWritten by `flexarm bench-host" << (report.quick ? " --quick" : "")
       << "`; docs/performance.md explains it.\n\n";
  AddMachine(page, report);
  for (const std::string& warning : WarningsOf(report.machine)) {
    page << "\n- Warning: " << warning << '\n';
  }
  const double bound = BestOf(report.bounds);
  page << "\n| what | median (quartiles, repetitions) | floating-point operations | Gflop/s | "
          "share of the bound | result |\n|---|---|---|---|---|---|\n";
  for (const BenchRow& row : report.rows) {
    const std::optional<double> share = BoundShare(row, bound);
    page << "| " << CellText(row.what) << " | " << TimeText(row.time) << " | "
         << (row.work ? GroupedText(row.work->flops) : "") << " | "
         << (share ? fmt::format("{:.2f}", 1e-9 * *share * bound) : "") << " | "
         << (share ? fmt::format("{:.1f} %", 100.0 * *share) : "") << " | "
         << CellText(ResultText(row)) << " |\n";
  }
  page << "\nThe operations are those of the machine code that was timed, executed one instruction "
          "at a time, unless the last column says otherwise. The bound is the highest of the rates "
          "above.\n";
  return page.str();
}

nlohmann::ordered_json BenchJson(const BenchReport& report) {
  nlohmann::ordered_json json;
  json["quick"] = report.quick;
  json["config"] = report.config;
  json["machine"] = MachineJson(report.machine);
  json["warnings"] = WarningsOf(report.machine);
  json["bounds"] = nlohmann::ordered_json::array();
  for (const FloatBound& bound : report.bounds) {
    json["bounds"].push_back({{"name", bound.name}, {"flops_per_s", bound.flops_per_s}});
  }
  json["rows"] = nlohmann::ordered_json::array();
  for (const BenchRow& row : report.rows) {
    json["rows"].push_back(RowJson(row, BestOf(report.bounds)));
  }
  json["build"] = report.machine.build;
  return json;
}

}  // namespace flexarm
