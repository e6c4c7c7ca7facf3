#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "controller/realtime/timing_record.h"
#include "controller/runlog/sqlite_db.h"
#include "controller/types/records.h"

namespace flexarm {

// What users read of a closed run: views `tick` and `timing`.
//
// SQLite needs 9 bytes for a double, and 2 to 4 for a small whole number. So tables `sample` and
// `activation` have whole numbers of small steps, and times as what they differ from those of table
// `grid`, which is nothing as a rule. The views give them their units.

/// The activations of the control task, in their order, as view `timing` has them.
inline constexpr const char* kSelectTiming =
    "SELECT a.number AS number, g.first + a.number - 1 + a.off_tick AS tick,\n"
    "  g.first_ns + (a.number - 1) * g.period_ns + a.off_grid_ns AS due_ns,\n"
    "  g.first_ns + (a.number - 1) * g.period_ns + a.off_grid_ns + a.late_ns AS woke_ns,\n"
    "  g.first_ns + (a.number - 1) * g.period_ns + a.off_grid_ns + a.late_ns + a.took_ns"
    " AS finished_ns,\n"
    "  a.late_ns / 1e3 AS late_us, a.took_ns / 1e3 AS took_us\n"
    "  FROM activation AS a, grid AS g WHERE g.number = 2 ORDER BY a.number";

/// The statements that make the tables and the views.
std::string CreateSampleTables();

/// Fills the tables. Every method throws SqliteError. Thread: one at a time.
class SampleTable {
 public:
  /// @param db  with the tables; outlives this
  explicit SampleTable(SqliteDb* db);

  /// In order, and as many at a time as there are: the first two make the grid.
  /// @param start_ns  time_s = 0
  void Add(std::span<const TickRecord> records, std::int64_t start_ns);
  void Add(std::span<const TimingRecord> records);

 private:
  /// Where a record is expected to stand in the clock of the loop.
  struct Grid {
    std::int64_t first, first_ns, period_ns;

    std::int64_t TimeOf(std::int64_t number) const;
  };
  struct Point {
    std::int64_t number, time_ns;
  };
  Grid MakeGrid(std::int64_t number, Point first, std::optional<Point> second);

  SqliteStatement insert_grid_, insert_sample_, insert_activation_;
  std::optional<Grid> ticks_, activations_;
  std::int64_t activation_ = 0;  // number of the last one
};

}  // namespace flexarm
