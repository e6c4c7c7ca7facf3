#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/plot/gnuplot.h"
#include "tools/sweep/sweep_file.h"
#include "tools/sweep/sweep_grid.h"
#include "tools/sweep/sweep_row.h"

namespace flexarm {

/// The runs that differ in their seed only.
struct SweepGroup {
  std::vector<std::size_t> index;    ///< index of the value on each axis of the summary
  std::size_t runs = 0;              ///< number of runs
  std::size_t completed = 0;         ///< number of completed runs
  std::vector<std::string> trips;    ///< distinct causes
  std::vector<std::string> refused;  ///< distinct reasons
  /// Over the completed runs; NaN: none. An infinite settling time is "never".
  std::array<double, kSweepMeasures.size()> median{};
  /// Least and greatest of the same runs.
  std::array<double, kSweepMeasures.size()> least{}, most{};
};

/// Medians over the seeds.
struct SweepSummary {
  std::vector<SweepAxis> axes;     ///< without the seeds; the axis to compare along is last
  std::vector<SweepGroup> groups;  ///< the last axis varies fastest
  std::size_t points = 0, done = 0;

  /// The measures to show: those over the bound only if a run has them.
  std::vector<std::size_t> Measured() const;
};

/// @param by  column of the axis to compare along; empty: the first with more than one value
/// @throws InputError  there is no such axis
SweepSummary Summarise(SweepFile* file, const std::string& by);

/// @param index  index of the rows' value on each axis
/// @param rows   of one group
SweepGroup GroupOf(const std::vector<std::size_t>& index, const std::vector<SweepRow>& rows);

/// The middle value, or the mean of the two middle values; NaN without values.
double MedianOf(std::vector<double> values);

/// The number of completed runs, the reasons of the others, and the medians.
nlohmann::ordered_json GroupJson(const SweepGroup& group);
nlohmann::ordered_json SummaryJson(const SweepSummary& summary);
void PrintSummary(const SweepSummary& summary);
/// Rules for such a table: one that flexarm wrote is replaced.
OutputRules SummaryCsvRules(std::vector<std::filesystem::path> inputs, bool overwrite);
/// @throws InputError as WriteFile does
void WriteSummaryCsv(const SweepSummary& summary, const std::filesystem::path& output,
                     const OutputRules& rules);
/// Draws rms, final errors, settling, distance from the target, residual and motion along the last
/// axis, with one curve for every combination of the other axes: medians, with a bar from the least
/// to the greatest over the seeds. A cross at the top: no run completed, or not settled.
/// @throws InputError  there is nothing to draw
void DrawSummary(const SweepSummary& summary, const std::filesystem::path& output,
                 const OutputRules& rules = ReplacedPicture());

}  // namespace flexarm
