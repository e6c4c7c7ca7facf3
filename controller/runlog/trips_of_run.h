#pragma once

#include <filesystem>
#include <vector>

#include "controller/safety/safety_record.h"

namespace flexarm {

/// The trips of a run log, in order of time.
///
/// A run whose program ended while the relay may have been closed has one more: the next daemon
/// started Tripped with `ended-while-armed`, at the last record here.
/// @throws InputError as RunReader
std::vector<SafetyRecord> TripsOfRun(const std::filesystem::path& log);

}  // namespace flexarm
