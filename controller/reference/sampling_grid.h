#pragma once

#include <string>

namespace flexarm {

/// Converts `time_s` to a whole number of periods.
/// @param what  its name for the message: "move[0].start_s"
/// @throws RejectedError if it is not a multiple of `period_s`
int OnGrid(double time_s, double period_s, const std::string& what);

/// `periods` in seconds, rounded to decimals: 70 of 0.02 s are 1.4.
double InSeconds(int periods, double period_s);

}  // namespace flexarm
