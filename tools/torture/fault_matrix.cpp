#include "tools/torture/fault_matrix.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "tools/support/parallel_for.h"

namespace flexarm {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr std::array<double, 2> kMoveToDeg = {30.0, -40.0};
// In mid-move, where both joints are fast; in the others, once they have begun.
constexpr std::int64_t kAfterRunningNs = 420 * kMs, kAfterNs = 40 * kMs;

TortureScenario Healthy(const TortureSpace& space, const RigConfig& config, const std::string& law,
                        Situation situation) {
  TortureScenario scenario = ScenarioOf(kSeed, space, config);
  scenario.law = law;
  scenario.plant.clear();
  scenario.faults.clear();
  scenario.commands.clear();
  scenario.recovers = false;
  scenario.wake_ups = {};
  scenario.move_to_deg = kMoveToDeg;
  scenario.payload_kg = config.arm.payload_mass_kg;
  scenario.move_s = MoveTime_s(space, kMoveToDeg, space.payload_kg[1], 1.2);
  scenario.situation = situation;
  scenario.after_ns = situation == Situation::kRunning ? kAfterRunningNs : kAfterNs;
  return scenario;
}

// Of the gauges of a link the first, one in the middle and the last: they differ in leverage.
std::vector<int> IndicesOf(FaultPlace place, int gauges) {
  std::vector<int> all;
  const int of_link = gauges / 2;
  for (int i = 0; i < CountOf(place, gauges); ++i) {
    const bool chosen =
        i % of_link == 0 || i % of_link == of_link / 2 || i % of_link == of_link - 1;
    if (place != FaultPlace::kGauge || of_link < 1 || chosen) all.push_back(i);
  }
  return all;
}

double Apart(const std::array<double, 2>& a, const std::array<double, 2>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

// In which the cause has latched before the fault.
bool AlreadyLatched(Situation situation) {
  return situation == Situation::kFaultStopping || situation == Situation::kTripped;
}

// In which the operator has the arm move; what damps it after a trip is like Stopping.
bool IsMove(Situation situation) {
  return situation == Situation::kRunning || situation == Situation::kStopping;
}

void AddOutcome(const TortureOutcome& outcome, const TortureOutcome& healthy, Situation situation,
                MatrixCell* cell) {
  ++cell->sessions;
  const bool tripped = outcome.cause != TripCause::kNone;
  if (tripped) {
    cell->first_ns =
        cell->causes.empty() ? outcome.latched_ns : std::min(cell->first_ns, outcome.latched_ns);
    cell->last_ns = std::max(cell->last_ns, outcome.latched_ns);
    cell->causes.insert(ToString(outcome.cause));
  } else {
    ++cell->without_trip;
  }
  const bool ends = tripped || AlreadyLatched(situation);
  cell->torque_ns = std::max(cell->torque_ns, ends ? outcome.last_torque_ns : 0);
  Raise(outcome.peaks, &cell->peaks);
  const std::size_t ms = std::min(outcome.tip_m.size(), healthy.tip_m.size());
  const auto trip = tripped ? static_cast<std::size_t>(outcome.latched_ns / kMs) : ms;
  for (std::size_t i = 0; i < std::min(ms, trip); ++i) {
    cell->tip_m = std::max(cell->tip_m, Apart(outcome.tip_m[i], healthy.tip_m[i]));
  }
  for (std::size_t i = trip; i < outcome.tip_m.size(); ++i) {
    cell->coast_m = std::max(cell->coast_m, Apart(outcome.tip_m[i], outcome.tip_m[trip]));
  }
  for (const Violation& violation : outcome.violations) {
    cell->broken.push_back(violation.rule + ": " + violation.what);
  }
}

std::string CellText(const MatrixCell& cell, const RigConfig& config) {
  if (cell.causes.empty()) return "-";
  std::string text;
  for (const std::string& cause : cell.causes) text += (text.empty() ? "" : " / ") + cause;
  const auto ticks = [&config](std::int64_t ns) {
    return std::to_string((ns + config.loop.period_ns() - 1) / config.loop.period_ns());
  };
  text += ", " + ticks(cell.first_ns);
  if (ticks(cell.last_ns) != ticks(cell.first_ns)) text += " to " + ticks(cell.last_ns);
  if (cell.without_trip > 0) {
    text +=
        ", " + std::to_string(cell.without_trip) + " of " + std::to_string(cell.sessions) + " -";
  }
  return text;
}

std::string Rounded(double value, int digits) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

const MatrixCell& CellOf(const MatrixRow& row, Situation situation) {
  const auto* const at = std::find(kMatrixSituations.begin(), kMatrixSituations.end(), situation);
  return row.cells.at(static_cast<std::size_t>(at - kMatrixSituations.begin()));
}

// Largest values of Running and Stopping.
MatrixCell WorstOfMove(const MatrixRow& row) {
  MatrixCell worst;
  for (std::size_t i = 0; i < row.cells.size(); ++i) {
    if (!IsMove(kMatrixSituations.at(i))) continue;
    Raise(row.cells[i].peaks, &worst.peaks);
    worst.tip_m = std::max(worst.tip_m, row.cells[i].tip_m);
    worst.coast_m = std::max(worst.coast_m, row.cells[i].coast_m);
  }
  return worst;
}

std::string RowText(const MatrixRow& row, const RigConfig& config) {
  std::string text = std::string("| ") + ToString(row.place) + " " + ToString(row.kind);
  for (std::size_t i = 0; i < row.cells.size(); ++i) {
    if (!AlreadyLatched(kMatrixSituations.at(i))) text += " | " + CellText(row.cells[i], config);
  }
  for (const Situation situation : {Situation::kRunning, Situation::kStopping}) {
    const MatrixCell& cell = CellOf(row, situation);
    text += " | " + (cell.causes.empty() ? std::string("-") : std::to_string(cell.torque_ns / kMs));
  }
  const MatrixCell worst = WorstOfMove(row);
  text += " | " + std::to_string(CellOf(row, Situation::kFaultStopping).torque_ns / kMs);
  text += " | " + Rounded(worst.peaks.torque_share, 2);
  text += " | " + Rounded(worst.peaks.angle_share, 2);
  text += " | " + Rounded(worst.peaks.strain_share, 2);
  text += " | " + Rounded(1e3 * worst.tip_m, 0);
  text += " | " + Rounded(1e3 * worst.coast_m, 0);
  return text + " |\n";
}

}  // namespace

std::vector<MatrixRow> EmptyMatrix(const TortureSpace& space) {
  std::vector<MatrixRow> rows;
  for (const std::string& law : space.laws) {
    for (int place = 0; place < kFaultPlaces; ++place) {
      for (int kind = 0; kind < kFaultKinds; ++kind) {
        const auto at = static_cast<FaultPlace>(place);
        const auto of = static_cast<FaultKind>(kind);
        if (!Exists(at, of) || !Has(law, at)) continue;
        rows.push_back({.place = at,
                        .kind = of,
                        .law = law,
                        .cells = std::vector<MatrixCell>(kMatrixSituations.size())});
      }
    }
  }
  return rows;
}

std::vector<TortureScenario> MatrixScenarios(const TortureSpace& space, const RigConfig& config,
                                             const MatrixRow& row, Situation situation) {
  std::vector<TortureScenario> scenarios;
  for (const int index : IndicesOf(row.place, space.gauges)) {
    scenarios.push_back(Healthy(space, config, row.law, situation));
    scenarios.back().faults = {{.place = row.place,
                                .index = index,
                                .kind = row.kind,
                                .from_ns = 0,
                                .to_ns = INT64_MAX,
                                .seed = kSeed}};
  }
  return scenarios;
}

std::size_t MatrixCells(const TortureSpace& space) {
  return EmptyMatrix(space).size() * kMatrixSituations.size();
}

std::vector<MatrixRow> FaultMatrix(const TorturedRigs& rigs, const TortureSpace& space,
                                   const RigConfig& config, std::size_t jobs,
                                   const std::function<void(std::size_t)>& progress) {
  std::map<std::pair<std::string, Situation>, TortureOutcome> healthy;
  for (const std::string& law : space.laws) {
    for (const Situation situation : kMatrixSituations) {
      healthy[{law, situation}] = RunScenario(rigs, Healthy(space, config, law, situation));
    }
  }
  std::vector<MatrixRow> rows = EmptyMatrix(space);
  const std::size_t cells = kMatrixSituations.size();
  ParallelFor(
      rows.size() * cells,
      [&](std::size_t i) {
        MatrixRow& row = rows[i / cells];
        const Situation situation = kMatrixSituations.at(i % cells);
        for (const TortureScenario& scenario : MatrixScenarios(space, config, row, situation)) {
          AddOutcome(RunScenario(rigs, scenario), healthy.at({row.law, situation}), situation,
                     &row.cells[i % cells]);
        }
      },
      progress, jobs);
  return rows;
}

std::string MatrixMarkdown(const std::vector<MatrixRow>& rows, const RigConfig& config) {
  std::string page = std::string(kMatrixMark) + "\n\n# Fault matrix\n\n" +
                     "Written by `flexarm torture --matrix`; what faults and columns mean: "
                     "[torture.md](torture.md).\n";
  std::string law;
  for (const MatrixRow& row : rows) {
    if (row.law != law) {
      law = row.law;
      page +=
          "\n## " + law +
          "\n\n| fault | Starting | Idle | Armed | Running | Stopping | Disarming | torque ends in "
          "Running, ms | in Stopping | in FaultStopping | torque | angle | strain | tip, mm | "
          "coasts, mm |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    }
    page += RowText(row, config);
  }
  return page;
}

nlohmann::ordered_json MatrixJson(const std::vector<MatrixRow>& rows) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const MatrixRow& row : rows) {
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      const MatrixCell& cell = row.cells[i];
      json.push_back({{"place", ToString(row.place)},
                      {"kind", ToString(row.kind)},
                      {"law", row.law},
                      {"state", ToString(kMatrixSituations.at(i))},
                      {"causes", cell.causes},
                      {"sessions", cell.sessions},
                      {"without_trip", cell.without_trip},
                      {"first_ms", cell.first_ns / kMs},
                      {"last_ms", cell.last_ns / kMs},
                      {"torque_ends_ms", std::max<std::int64_t>(cell.torque_ns, 0) / kMs},
                      {"peak_torque_share", cell.peaks.torque_share},
                      {"peak_angle_share", cell.peaks.angle_share},
                      {"peak_rate_share", cell.peaks.rate_share},
                      {"peak_strain_share", cell.peaks.strain_share},
                      {"tip_mm", 1e3 * cell.tip_m},
                      {"coasts_mm", 1e3 * cell.coast_m},
                      {"broken_rules", cell.broken}});
    }
  }
  return json;
}

std::vector<std::string> BrokenCells(const std::vector<MatrixRow>& rows) {
  std::vector<std::string> broken;
  for (const MatrixRow& row : rows) {
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      for (const std::string& rule : row.cells[i].broken) {
        broken.push_back(row.law + ", " + ToString(kMatrixSituations.at(i)) + ", " +
                         ToString(row.place) + " " + ToString(row.kind) + ": " + rule);
      }
    }
  }
  return broken;
}

}  // namespace flexarm
