#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "controller/types/experiment.h"

namespace flexarm {

/// The text of an experiment with the CSV file that it names appended as a row [[attached]], so
/// that one text goes to the daemon and into the log. Unchanged if the experiment names no file or
/// already contains it.
/// @param file  of the experiment; the CSV file's name is relative to it
/// @throws ConfigError  the CSV file cannot be read, is too large, or is not text
std::string WithAttachments(const std::string& text, const std::filesystem::path& file);

/// The rows of a trajectory: columns time_s and th1_deg, th2_deg or th1_rad, th2_rad.
/// @throws InputError  with file, line and column; times must start at 0 and ascend
std::vector<TrajectoryPoint> ReadTrajectory(const std::string& file, const std::string& text);

}  // namespace flexarm
