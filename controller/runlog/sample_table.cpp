#include "controller/runlog/sample_table.h"

#include <cmath>
#include <string_view>
#include <variant>

#include "controller/runlog/tick_columns.h"
#include "controller/runlog/wrapping.h"
#include "controller/types/safety_state.h"

namespace flexarm {
namespace {

constexpr const char* kPlainTables = R"sql(
CREATE TABLE grid (
  number INTEGER PRIMARY KEY,
  first INTEGER, first_ns INTEGER, period_ns INTEGER
);
CREATE TABLE activation (
  number INTEGER PRIMARY KEY,
  off_tick INTEGER, off_grid_ns INTEGER, late_ns INTEGER, took_ns INTEGER
);
)sql";

constexpr std::int64_t kTickGrid = 1, kActivationGrid = 2;  // numbers of table `grid`

// "hub_1_deg_x10000"; a whole number of units has the plain name.
std::string StoredName(const TickColumn& column) {
  std::string name = column.name;
  if (column.steps_per_unit == 1) return name;
  return name + "_x" + std::to_string(std::llround(column.steps_per_unit));
}

std::string ShownValue(const TickColumn& column) {
  std::string value = "s." + StoredName(column);
  if (column.steps_per_unit != 1) {
    value += " / " + std::to_string(std::llround(column.steps_per_unit)) + ".0";
  }
  return value + " AS " + column.name;
}

void BindSteps(SqliteStatement* insert, int parameter, const TickColumn& column,
               const TickRecord& record) {
  const ColumnValue value = column.value(record);
  if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    insert->Bind(parameter, *whole);
    return;
  }
  constexpr double kLargest = 9e15;  // whole numbers up to it have a double of their own
  const double steps = std::get<double>(value) * column.steps_per_unit;
  if (std::abs(steps) < kLargest) {
    insert->Bind(parameter, std::int64_t{std::llround(steps)});
  } else {
    insert->BindNull(parameter);  // also a NaN
  }
}

std::string InsertSample() {
  std::string sql = "INSERT INTO sample VALUES (?,?,?";
  for (const TickColumn& column : TickColumns()) {
    if (column.steps_per_unit != 0) sql += ",?";
  }
  return sql + ")";
}

}  // namespace

std::string CreateSampleTables() {
  std::string table =
      "CREATE TABLE sample (tick INTEGER PRIMARY KEY, off_grid_ns INTEGER, state INTEGER";
  std::string view =
      "CREATE VIEW tick AS SELECT s.tick AS tick,\n"
      "  (g.first_ns + (s.tick - g.first) * g.period_ns + s.off_grid_ns) / 1e9 AS time_s,\n"
      "  CASE s.state";
  for (int state = 0; state < kSafetyStates; ++state) {
    view += " WHEN " + std::to_string(state) + " THEN '" +
            ToString(static_cast<SafetyState>(state)) + "'";
  }
  view += " END AS state";
  for (const TickColumn& column : TickColumns()) {
    if (column.steps_per_unit == 0) continue;
    table += ", " + StoredName(column) + " INTEGER";
    view += ",\n  " + ShownValue(column);
  }
  view += "\n  FROM sample AS s, grid AS g WHERE g.number = 1;\n";
  return kPlainTables + table + ");\n" + view + "CREATE VIEW timing AS " + kSelectTiming + ";";
}

SampleTable::SampleTable(SqliteDb* db)
    : insert_grid_(db->Prepare("INSERT INTO grid VALUES (?,?,?,?)")),
      insert_sample_(db->Prepare(InsertSample())),
      insert_activation_(db->Prepare("INSERT INTO activation VALUES (?,?,?,?,?)")) {}

std::int64_t SampleTable::Grid::TimeOf(std::int64_t number) const {
  return WrappedSum(first_ns, WrappedProduct(WrappedDifference(number, first), period_ns));
}

SampleTable::Grid SampleTable::MakeGrid(std::int64_t number, Point first,
                                        std::optional<Point> second) {
  Grid grid{.first = first.number, .first_ns = first.time_ns, .period_ns = 0};
  if (second && second->number > first.number) {
    const std::int64_t steps = WrappedDifference(second->number, first.number);
    if (steps > 0) grid.period_ns = WrappedDifference(second->time_ns, first.time_ns) / steps;
  }
  insert_grid_.Bind(1, number);
  insert_grid_.Bind(2, grid.first);
  insert_grid_.Bind(3, grid.first_ns);
  insert_grid_.Bind(4, grid.period_ns);
  insert_grid_.Execute();
  return grid;
}

void SampleTable::Add(std::span<const TickRecord> records, std::int64_t start_ns) {
  const auto point = [&](std::size_t n) {
    const StepInput& input = records[n].input;
    return Point{.number = input.tick,
                 .time_ns = WrappedDifference(input.sampling_instant_ns, start_ns)};
  };
  if (!ticks_ && !records.empty()) {
    ticks_ =
        MakeGrid(kTickGrid, point(0), records.size() > 1 ? std::optional(point(1)) : std::nullopt);
  }
  for (std::size_t n = 0; n < records.size(); ++n) {
    const Point at = point(n);
    int next = 1;
    insert_sample_.Bind(next++, at.number);
    insert_sample_.Bind(next++, WrappedDifference(at.time_ns, ticks_->TimeOf(at.number)));
    insert_sample_.Bind(next++, std::int64_t{static_cast<int>(records[n].input.safety_state)});
    for (const TickColumn& column : TickColumns()) {
      if (column.steps_per_unit == 0) continue;
      BindSteps(&insert_sample_, next++, column, records[n]);
    }
    insert_sample_.Execute();
  }
}

// Their keys are not the ticks: that no tick comes twice is not promised.
void SampleTable::Add(std::span<const TimingRecord> records) {
  if (!activations_ && !records.empty()) {
    const Point first{.number = records[0].tick, .time_ns = records[0].due_ns};
    std::optional<Point> second;
    if (records.size() > 1) {
      second = {.number = WrappedSum(first.number, 1), .time_ns = records[1].due_ns};
    }
    activations_ = MakeGrid(kActivationGrid, first, second);
  }
  for (const TimingRecord& record : records) {
    const std::int64_t tick = WrappedSum(activations_->first, activation_++);
    insert_activation_.Bind(1, activation_);
    insert_activation_.Bind(2, WrappedDifference(record.tick, tick));
    insert_activation_.Bind(3, WrappedDifference(record.due_ns, activations_->TimeOf(tick)));
    insert_activation_.Bind(4, WrappedDifference(record.woke_ns, record.due_ns));
    insert_activation_.Bind(5, WrappedDifference(record.finished_ns, record.woke_ns));
    insert_activation_.Execute();
  }
}

}  // namespace flexarm
