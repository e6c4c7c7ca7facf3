#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

#include "tools/torture/scenario.h"
#include "tools/torture/torture.h"

namespace flexarm {

/// What became of one kind of fault at one place, in one situation with one law: the worst of every
/// index of the place.
struct MatrixCell {
  std::set<std::string> causes;  ///< that latched
  std::size_t sessions = 0;
  std::size_t without_trip = 0;            ///< of them
  std::int64_t first_ns = 0, last_ns = 0;  ///< from the begin of the fault until a cause latched
  std::int64_t torque_ns = 0;  ///< from the begin of the fault until the torque was zero
  Peaks peaks{};
  double tip_m = 0.0;               ///< from where it is without the fault, until the trip
  double coast_m = 0.0;             ///< the way of the tip after the trip, within the session
  std::vector<std::string> broken;  ///< rules
};

/// One kind of fault at one place.
struct MatrixRow {
  FaultPlace place;
  FaultKind kind;
  std::string law;
  std::vector<MatrixCell> cells;  ///< by kMatrixSituations
};

inline constexpr std::array<Situation, kSituations> kMatrixSituations = {
    Situation::kStarting, Situation::kIdle,      Situation::kArmed,         Situation::kRunning,
    Situation::kStopping, Situation::kDisarming, Situation::kFaultStopping, Situation::kTripped};

/// Every fault in every situation with every law, on the nominal arm, with threads on time.
/// @param progress  called with the number of cells that are done
std::vector<MatrixRow> FaultMatrix(const TorturedRigs& rigs, const TortureSpace& space,
                                   const RigConfig& config, std::size_t jobs,
                                   const std::function<void(std::size_t)>& progress = {});

/// The sessions of a cell: one for each index of the place that is tried.
std::vector<TortureScenario> MatrixScenarios(const TortureSpace& space, const RigConfig& config,
                                             const MatrixRow& row, Situation situation);

/// The rows of a matrix without results.
std::vector<MatrixRow> EmptyMatrix(const TortureSpace& space);

/// How many cells FaultMatrix has.
std::size_t MatrixCells(const TortureSpace& space);

/// First line of a page, by which flexarm knows its own.
inline constexpr const char* kMatrixMark = "<!-- flexarm torture --matrix -->";
std::string MatrixMarkdown(const std::vector<MatrixRow>& rows, const RigConfig& config);
nlohmann::ordered_json MatrixJson(const std::vector<MatrixRow>& rows);

/// Cells in which a rule was broken, as text; empty: none.
std::vector<std::string> BrokenCells(const std::vector<MatrixRow>& rows);

}  // namespace flexarm
