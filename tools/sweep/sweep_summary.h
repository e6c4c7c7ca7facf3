#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/sweep/sweep_file.h"
#include "tools/sweep/sweep_grid.h"
#include "tools/sweep/sweep_row.h"

namespace flexarm {

/// The runs that differ in their seed only.
struct SweepGroup {
  std::vector<std::size_t> index;    ///< which value of each axis of the summary
  std::size_t runs = 0;              ///< that there are
  std::size_t completed = 0;         ///< of them
  std::vector<std::string> trips;    ///< causes, each once
  std::vector<std::string> refused;  ///< reasons, each once
  /// Over the completed runs; NaN: none. An infinite settling time is "never".
  std::array<double, kSweepMeasures.size()> median{};
};

/// Medians over the seeds.
struct SweepSummary {
  std::vector<SweepAxis> axes;     ///< without the seeds; the one to look along comes last
  std::vector<SweepGroup> groups;  ///< last axis fastest
  std::size_t points = 0, done = 0;
};

/// @param by  column of the axis to look along; empty: the first with more than one value
/// @throws InputError  there is no such axis
SweepSummary Summarise(SweepFile* file, const std::string& by);

/// @param index  which value of each axis these rows have
/// @param rows   of one group
SweepGroup GroupOf(const std::vector<std::size_t>& index, const std::vector<SweepRow>& rows);

/// Middle value, or mean of the two; NaN of nothing.
double MedianOf(std::vector<double> values);

/// How many runs completed, why the others did not, and the medians.
nlohmann::ordered_json GroupJson(const SweepGroup& group);
nlohmann::ordered_json SummaryJson(const SweepSummary& summary);
void PrintSummary(const SweepSummary& summary);
/// @throws InputError if the file cannot be written
void WriteSummaryCsv(const SweepSummary& summary, const std::filesystem::path& output);
/// Rms, final errors, settling and residual along the last axis, a curve for every combination of
/// the others. @throws InputError  nothing to draw
void DrawSummary(const SweepSummary& summary, const std::filesystem::path& output);

}  // namespace flexarm
