#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace flexarm {

/// Makes the page of the trip `number` (from 0) of a closed run log. May throw std::exception.
using MakeTripPage =
    std::function<std::string(const std::filesystem::path& log, std::size_t number)>;

/// What flexarm writes where the report of a trip goes: "<log>.trip.html" beside the log, with
/// "-2", "-3", .. before the suffix if that exists.
std::filesystem::path NewTripPage(const std::filesystem::path& log);

/// The reports that stand beside a log, in order.
std::vector<std::filesystem::path> TripPagesOf(const std::filesystem::path& log);

/// The report of a trip.
struct TripReport {
  std::filesystem::path file;        ///< empty: none yet
  std::int64_t trip_ns = INT64_MIN;  ///< safety tick of the trip; INT64_MIN: of a daemon before
};

/// Writes a page for each trip of the runs that have ended. What cannot be written, as on a full
/// disk, is reported once and tried again with each Try; pages wait in memory meanwhile.
/// Not real-time safe. Thread: any that may wait for the disk; newest() waits for none.
class TripReports {
 public:
  /// For the journal. Called on the thread that works.
  using Report = std::function<void(bool is_error, const std::string& text)>;

  /// Pages that wait for the disk, at most; what comes beyond is told and left out: `flexarm
  /// trip-report` makes it from the log.
  static constexpr std::size_t kMostWaiting = 8;

  /// @param make  empty: no pages are written
  TripReports(MakeTripPage make, Report report)
      : make_(std::move(make)), report_(std::move(report)) {}

  /// This run is closed: makes and writes the pages of its trips.
  void Closed(const std::filesystem::path& log) noexcept;

  /// The daemon before left a trip latched, with that cause: its report is beside the newest log of
  /// the folder. Makes it if it is not there, as after a kill.
  void Recall(const std::filesystem::path& folder, const char* cause) noexcept;

  /// Tries again what could not be written. @returns true if nothing waits any more
  bool Try() noexcept;

  TripReport newest() const;

 private:
  struct Waiting {
    std::filesystem::path log;
    std::int64_t trip_ns;
    std::string page;
    std::string error;  // of the last try
  };

  void Make(const std::filesystem::path& log, std::size_t number, std::int64_t trip_ns);
  bool WriteWaiting();
  void SetNewest(const std::filesystem::path& file, std::int64_t trip_ns);
  bool Write(Waiting* waiting);

  MakeTripPage make_;
  Report report_;
  std::mutex work_;  // held while pages are made and written
  std::deque<Waiting> waiting_;
  mutable std::mutex newest_mutex_;  // held for a copy, never during I/O
  TripReport newest_;
};

}  // namespace flexarm
