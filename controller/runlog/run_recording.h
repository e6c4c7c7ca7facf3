#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "controller/realtime/timing_record.h"
#include "controller/runlog/recent_records.h"
#include "controller/runlog/run_context.h"
#include "controller/runlog/run_sink.h"

namespace flexarm {

/// Creates the sink of a run that begins. @throws RunLogError
using OpenSink = std::function<std::unique_ptr<RunSink>(const RunInfo&)>;

OpenSink RunInFile(const std::filesystem::path& file);  ///< for one run; must not exist
OpenSink RunInMemory(RunContents* contents);

inline constexpr std::int64_t kAfterRunNs = 1'000'000'000;   ///< recorded after the end of a run
inline constexpr std::int64_t kAfterTripNs = 5'000'000'000;  ///< recorded after a trip

/// Assigns the records to runs, and derives events from them.
///
/// A run begins when `run`, `pluck` or `home` is granted. The loop is reset then, so each run
/// replays on its own: its first tick is that of the reset. It lasts until the next one is granted,
/// until the arm is disarmed, until kAfterRunNs after it came to its end, or until kAfterTripNs
/// after a trip. A trip outside a run is recorded as a run of its own, which begins with the last
/// kBeforeTripNs, but not before the last reset: an earlier trip stands in its own log. Events
/// since the arm was last disarmed precede those of a run: who armed it, and with which overrides.
/// Records must come in order of time. Errors of the sink end the recording of the run; they are
/// reported and counted, never thrown.
class RunRecording {
 public:
  /// For the journal. Called on the recorder's thread.
  using Report = std::function<void(bool is_error, const std::string& text)>;

  /// @param info  common to all runs; start and experiment are filled in
  RunRecording(RunInfo info, OpenSink open, Report report);

  void Safety(const SafetyRecord& record) noexcept;
  void Tick(const TickRecord& record) noexcept;
  void Timing(const TimingRecord& record) noexcept;
  /// Kind "experiment" announces an experiment for which a run is asked: its `name`, and its file
  /// as `text`.
  void Event(const RunEvent& event) noexcept;

  /// No older record will follow: closes a run that has ended by then.
  void Until(std::int64_t time_ns) noexcept;
  void Commit() noexcept;
  /// Closes the run that is open, if any.
  void Finish() noexcept;

  /// An error outside the recording: counts and reports it, and ends the recording of the run.
  void CountError(const std::string& what) noexcept;

  /// Records are missing, in a run or between two: an error line of the journal, no more.
  void ReportGap(const std::string& what) const {
    if (report_) report_(true, "log: " + what);
  }

  bool is_open() const { return sink_ != nullptr; }
  std::int64_t errors() const { return errors_; }

 private:
  template <typename Action>
  void Guarded(Action action) noexcept;
  void Open(std::int64_t start_ns);
  void BeginRun(const SafetyRecord& granted);
  void BeginTrip(const SafetyRecord& trip);
  void Close();
  void WriteEventsOf(const SafetyRecord& record);
  void WriteTick(const TickRecord& record);
  void SetEnd(const SafetyRecord& record);
  std::string ResultJson() const;

  RunInfo info_;
  OpenSink open_;
  Report report_;
  std::unique_ptr<RunSink> sink_;
  std::int64_t errors_ = 0;
  RecentRecords recent_;
  RunContext context_;
  SafetyState state_ = SafetyState::kIdle;

  // State of the open run.
  std::optional<std::int64_t> end_ns_;  // it ends after this instant
  std::optional<std::int64_t> last_tick_;
  std::int64_t ticks_ = 0;
  std::int64_t last_tick_ns_ = 0;
  std::int64_t missing_ticks_ = 0;
  bool stopped_ = false;  // by a command
  TripCause trip_ = TripCause::kNone;
  bool has_run_ = false;  // false: a trip outside a run
};

}  // namespace flexarm
