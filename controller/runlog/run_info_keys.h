#pragma once

#include <string>
#include <vector>

#include "controller/runlog/record_format.h"
#include "controller/types/records.h"

namespace flexarm {

/// All of a run's metadata but its result, as keys of table `run`. An empty version or build_id is
/// that of this build.
std::vector<InfoRecord> InfoKeys(const RunInfo& info);

/// Sets what the key means; a key of no meaning is ignored.
void SetInfo(RunInfo* info, const std::string& key, const std::string& value);

}  // namespace flexarm
