#pragma once

#include <string>
#include <vector>

#include "config/config.h"
#include "controller/runlog/csv_import.h"
#include "tools/csv/strain_scale_check.h"

namespace flexarm {

/// A line for people on each wrong scale, with what to check; none: nothing speaks against them.
std::vector<std::string> ScaleWarnings(const StrainScaleResult& result, const RigConfig& config,
                                       const CsvFacts& facts);

}  // namespace flexarm
