#pragma once

#include <string>
#include <vector>

#include "controller/realtime/timing_record.h"
#include "controller/runlog/safety_rows.h"
#include "controller/types/records.h"

namespace flexarm {

/// Destination of the records of one run: a file (RunWriter), or memory (RunMemory).
/// Thread: the recorder's. Not real-time safe.
class RunSink {
 public:
  virtual ~RunSink() = default;

  virtual std::string Name() const = 0;  ///< for messages: the file
  virtual void Tick(const TickRecord& record) = 0;
  virtual void Timing(const TimingRecord& record) = 0;
  virtual void Safety(const SafetyRecord& record) = 0;
  virtual void Event(const RunEvent& event) = 0;
  /// Makes all data so far safe against a crash of the process.
  virtual void Commit() = 0;
  /// What keeps the data so far from being safe, for the operator; "" if nothing does. The sink
  /// goes on: nothing is lost yet, and the next Commit tries again.
  virtual std::string Trouble() const { return {}; }
  /// Ends the run. Nothing may follow.
  virtual void Close(const std::string& result_json) = 0;
};

/// A whole run in memory.
struct RunContents {
  RunInfo info;
  std::vector<TickRecord> tick;
  std::vector<TimingRecord> timing;
  std::vector<SafetyRecord> safety;
  std::vector<RunEvent> event;
};

/// Keeps a run in `contents`, which must outlive it: for metrics without a log.
class RunMemory : public RunSink {
 public:
  explicit RunMemory(RunContents* contents) : contents_(contents) {}

  std::string Name() const override { return "memory"; }
  void Tick(const TickRecord& record) override { contents_->tick.push_back(record); }
  void Timing(const TimingRecord& record) override { contents_->timing.push_back(record); }
  void Safety(const SafetyRecord& record) override { contents_->safety.push_back(record); }
  void Event(const RunEvent& event) override { contents_->event.push_back(event); }
  void Commit() override {}
  void Close(const std::string& result_json) override { contents_->info.result_json = result_json; }

 private:
  RunContents* contents_;
};

}  // namespace flexarm
