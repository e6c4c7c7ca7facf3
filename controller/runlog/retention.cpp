#include "controller/runlog/retention.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>
#include <system_error>
#include <vector>

#include "controller/files/external_file.h"
#include "controller/files/input_error.h"
#include "controller/runlog/record_format.h"
#include "controller/runlog/run_file_lock.h"
#include "controller/runlog/run_list.h"
#include "controller/runlog/schema.h"
#include "controller/runlog/trip_reports.h"

namespace flexarm {
namespace {

using Clock = std::filesystem::file_time_type::clock;

struct Run {
  std::filesystem::path file;
  std::filesystem::file_time_type written;
  double bytes;  // with its trip reports
};

// By its first bytes: a SQLite file with the application id of a run log, which is at byte 68, big
// endian; or a record file.
bool IsRunLog(const std::filesystem::path& file) {
  constexpr std::size_t kApplicationId = 68;
  const std::string bytes = Beginning(file, kApplicationId + 4);
  if (bytes.starts_with(kRecordMagic)) return true;
  if (bytes.size() < kApplicationId + 4 || !bytes.starts_with("SQLite format 3")) return false;
  std::uint32_t id = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    id = id << 8 | static_cast<unsigned char>(bytes[kApplicationId + i]);
  }
  return id == kRunLogApplicationId;
}

// Oldest first. Files that cannot be looked at, or are being written, are left out.
std::vector<Run> Runs(const std::filesystem::path& directory) {
  std::vector<Run> runs;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(directory, error)) {
    const std::filesystem::path& file = entry.path();
    if (file.extension() != ".flexarm" || file.filename().string().starts_with('.')) continue;
    if (!entry.is_regular_file(error) || entry.is_symlink(error)) continue;
    if (!IsRunLog(file) || RunFileIsLocked(file)) continue;
    const auto written = entry.last_write_time(error);
    if (error) continue;
    auto bytes = static_cast<double>(entry.file_size(error));
    for (const std::filesystem::path& page : TripPagesOf(file)) {
      std::error_code ignored;
      const auto size = std::filesystem::file_size(page, ignored);
      if (!ignored) bytes += static_cast<double>(size);
    }
    if (!error) runs.push_back({.file = file, .written = written, .bytes = bytes});
  }
  std::ranges::sort(runs, {}, &Run::written);
  return runs;
}

// Its end must be known before it goes.
bool MustStay(const std::filesystem::path& file, const LogConfig& config) {
  try {
    const RunHead head = ReadRunHead(file);
    return head.end == RunEnd::kOpen || (config.keep_trips && !head.trip.empty());
  } catch (const InputError&) {
    return true;
  }
}

}  // namespace

void RemoveOldRuns(const std::filesystem::path& directory, const LogConfig& config,
                   const std::function<void(bool is_error, const std::string& text)>& report) {
  if (config.keep_days == 0.0 && config.keep_total_mb == 0.0) return;
  const std::vector<Run> runs = Runs(directory);
  double total_mb = 0.0;
  for (const Run& run : runs) total_mb += run.bytes * 1e-6;
  const auto now = Clock::now();
  for (std::size_t i = 0; i + 1 < runs.size(); ++i) {
    const Run& run = runs[i];
    const double days = std::chrono::duration<double>(now - run.written).count() / 86400.0;
    const bool is_old = config.keep_days > 0.0 && days > config.keep_days;
    const bool is_much = config.keep_total_mb > 0.0 && total_mb > config.keep_total_mb;
    if (!is_old && !is_much) return;  // the later ones are younger
    if (MustStay(run.file, config)) continue;
    std::error_code error;
    // Its pages first: one that remained would belong to the next log of that name.
    for (const std::filesystem::path& page : TripPagesOf(run.file)) {
      if (!error) std::filesystem::remove(page, error);
    }
    if (!error) std::filesystem::remove(run.file, error);
    if (!error) total_mb -= run.bytes * 1e-6;
    if (!report) continue;
    const std::string key = is_old ? "log.keep_days" : "log.keep_total_mb";
    report(static_cast<bool>(error),
           error ? run.file.string() + ": cannot be removed (" + key + "): " + error.message()
                 : run.file.string() + ": removed (" + key + ")");
  }
}

}  // namespace flexarm
