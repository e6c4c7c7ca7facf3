#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace flexarm {

/// Text among the first of a page, by which flexarm knows its own.
inline constexpr const char* kTripPageMark = "<title>Trip report of flexarm: ";

/// The report of a trip: one HTML page that needs no other file, no script and no network.
///
/// What happened, what to check and how to continue; the chain of causes; the signals of the last
/// kWindowBefore_s and, coarser, of the time before; timing of the threads, buses; commands; what
/// differs from the config of the last good run; whether the run replays to the bit. Every text of
/// the log is escaped. Its size is limited for any duration, some 0.5 MB; so is its memory, about
/// 10 MB.
/// @param number  of the trip in the log, from 0
/// @throws InputError, ConfigError as ReadTrip
std::string TripPage(const std::filesystem::path& log, std::size_t number);

}  // namespace flexarm
