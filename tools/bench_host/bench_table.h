#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tools/bench_host/bench_host.h"

namespace flexarm {

/// First line of a page, by which flexarm knows its own.
inline constexpr const char* kBenchHostMark = "<!-- flexarm bench-host -->";

/// The page: the machine, its warnings, its bounds, and the table.
std::string BenchMarkdown(const BenchReport& report);

/// The same as numbers: `machine`, `warnings`, `bounds`, `rows`, `build`, `quick`. What a row does
/// not have is null.
nlohmann::ordered_json BenchJson(const BenchReport& report);

/// A duration with three digits and the unit that suits it: "1.23 us".
std::string DurationText(double seconds);

}  // namespace flexarm
