#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <variant>

#include "controller/types/records.h"

namespace flexarm {

/// Value of a readable column. NaN: it is not known.
using ColumnValue = std::variant<std::int64_t, double, std::string_view>;

/// A readable column of a sample: the name carries its unit.
struct TickColumn {
  const char* name;
  const char* unit;       ///< of the units row of an exported file
  double steps_per_unit;  ///< view `tick` of the log has it in such steps; 0: exported files only
  ColumnValue (*value)(const TickRecord& record);
};

/// All of them, in their order: the one place that a new column needs. Before them stand `tick` and
/// `time_s`; `state` is in both.
std::span<const TickColumn> TickColumns();

}  // namespace flexarm
