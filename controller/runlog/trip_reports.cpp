#include "controller/runlog/trip_reports.h"

#include <exception>
#include <utility>

#include "controller/files/write_file.h"
#include "controller/runlog/run_list.h"
#include "controller/runlog/trips_of_run.h"

namespace flexarm {
namespace {

// Number 1 has no number in its name.
std::filesystem::path TripPage(const std::filesystem::path& log, int number) {
  std::filesystem::path page = log;
  return page.replace_extension(number == 1 ? ".trip.html"
                                            : ".trip-" + std::to_string(number) + ".html");
}

}  // namespace

std::filesystem::path NewTripPage(const std::filesystem::path& log) {
  int number = 1;
  while (std::filesystem::exists(TripPage(log, number))) ++number;
  return TripPage(log, number);
}

std::vector<std::filesystem::path> TripPagesOf(const std::filesystem::path& log) {
  std::vector<std::filesystem::path> pages;
  std::error_code ignored;
  for (int number = 1; std::filesystem::exists(TripPage(log, number), ignored); ++number) {
    pages.push_back(TripPage(log, number));
  }
  return pages;
}

TripReport TripReports::newest() const {
  const std::lock_guard lock(newest_mutex_);
  return newest_;
}

void TripReports::SetNewest(const std::filesystem::path& file, std::int64_t trip_ns) {
  TripReport report{.file = std::filesystem::absolute(file), .trip_ns = trip_ns};
  const std::lock_guard lock(newest_mutex_);
  if (trip_ns == INT64_MIN && !newest_.file.empty()) return;  // one of this daemon is newer
  newest_ = std::move(report);
}

void TripReports::Make(const std::filesystem::path& log, std::size_t number, std::int64_t trip_ns) {
  if (waiting_.size() >= kMostWaiting) {
    return report_(true, "trip report of " + log.string() +
                             ": too many wait for the disk; `flexarm trip-report` makes it");
  }
  waiting_.push_back({.log = log, .trip_ns = trip_ns, .page = make_(log, number), .error = {}});
}

void TripReports::Closed(const std::filesystem::path& log) noexcept {
  try {
    const std::lock_guard lock(work_);
    if (!make_ || ReadRunHead(log).trip.empty()) return;
    const auto trips = TripsOfRun(log);
    for (std::size_t i = 0; i < trips.size(); ++i) Make(log, i, trips[i].due_ns);
    WriteWaiting();
  } catch (const std::exception& error) {
    report_(true, "trip report of " + log.string() + ": " + error.what());
  }
}

void TripReports::Recall(const std::filesystem::path& folder, const char* cause) noexcept {
  try {
    const std::lock_guard lock(work_);
    if (!make_ || !std::filesystem::is_directory(folder)) return;
    std::filesystem::path log;
    for (const ListedRun& run : ListRuns(folder)) {
      if (run.problem.empty()) {
        log = run.file;
        break;
      }
    }
    if (log.empty()) return;
    const auto trips = TripsOfRun(log);
    if (trips.empty() || ToString(trips.back().after.cause) != std::string(cause)) return;
    const auto pages = TripPagesOf(log);
    if (!pages.empty()) return SetNewest(pages.back(), INT64_MIN);
    Make(log, trips.size() - 1, INT64_MIN);
    WriteWaiting();
  } catch (const std::exception& error) {
    report_(true, "trip report in " + folder.string() + ": " + error.what());
  }
}

bool TripReports::Write(Waiting* waiting) {
  try {
    const std::filesystem::path file = NewTripPage(waiting->log);
    WriteFile(file, waiting->page, {.kind = "a trip report", .mark = {}, .inputs = {}});
    SetNewest(file, waiting->trip_ns);
    report_(false, "trip report: " + file.string());
    return true;
  } catch (const std::exception& error) {
    const bool changed = std::exchange(waiting->error, error.what()) != error.what();
    if (changed) report_(true, std::string("trip report: ") + error.what() + "; tried again");
    return false;
  }
}

bool TripReports::WriteWaiting() {
  std::erase_if(waiting_, [this](Waiting& waiting) { return Write(&waiting); });
  return waiting_.empty();
}

bool TripReports::Try() noexcept {
  try {
    const std::lock_guard lock(work_);
    return WriteWaiting();
  } catch (const std::exception&) {  // out of memory: the next try
    return false;
  }
}

}  // namespace flexarm
