#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "controller/types/records.h"

namespace flexarm {

/// Value of a readable column. NaN is stored as NULL.
using ColumnValue = std::variant<std::int64_t, double, std::string_view>;

/// A readable column of table `tick`: the name carries its unit.
struct TickColumn {
  const char* name;
  const char* type;  ///< of SQL
  const char* unit;  ///< of the units row of an exported file
  ColumnValue (*value)(const TickRecord& record);
};

/// All of them, in their order: the one place that a new column needs. Before them stand `tick` and
/// `time_s`, behind them the BLOBs `input` and `output`.
std::span<const TickColumn> TickColumns();

/// The statement that makes table `tick`.
std::string CreateTickTable();

/// The statement that inserts a row: tick, time_s, the columns, input, output.
std::string InsertTick();

}  // namespace flexarm
