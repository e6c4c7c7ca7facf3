#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "controller/exchange/spsc_queue.h"
#include "controller/health/health_report.h"
#include "controller/types/records.h"

namespace flexarm {

/// What the monitor needs of its daemon.
struct HealthMonitorSettings {
  ControlConfig config;
  HealthConfig health;
  NominalPlant plant;
  std::filesystem::path file;  ///< of the history; its folder exists when Start is called
  /// Writes a line of the journal.
  std::function<void(bool is_error, const std::string& text)> report;
  std::function<std::string()> utc_now;  ///< ISO 8601
};

/// The parallel plant beside the runs of a daemon, on a thread of its own of ordinary priority: the
/// operator task hands over each sample that it reads anyway, through a bounded queue, and no
/// thread ever waits. A run of which samples were lost is kept, and not judged.
///
/// After each run the history is written, and an alarm that appears is reported. It never trips.
/// A file that cannot be read is reported and set aside as FILE.broken-N, and a new one begun.
class HealthMonitor {
 public:
  /// Samples that wait: 20 s at 50 Hz. A drift that is large takes a second after its run.
  static constexpr std::size_t kDepth = 1'000;

  explicit HealthMonitor(HealthMonitorSettings settings);
  ~HealthMonitor();
  HealthMonitor(const HealthMonitor&) = delete;
  HealthMonitor& operator=(const HealthMonitor&) = delete;

  /// Reads the history and begins. Once.
  void Start();
  /// After the last Take: takes the samples that wait, and ends.
  void Stop();

  /// Operator thread: every sample, in order. Never waits.
  /// @param payload_changes  the run changes the payload of the simulated arm
  void Take(const TickRecord& tick, bool payload_changes) noexcept;

  /// Any thread. Part "health" of the status: {runs, newest_run, alarms: [{channel, text}], lost,
  /// error}.
  nlohmann::json Status() const;

 private:
  struct Sample {
    TickRecord tick;
    bool payload_changes;
  };

  void Read();
  void SetAside(const std::string& problem);
  void Run(const std::stop_token& stop);
  void TakeWaiting();
  void Follow(const Sample& sample);
  void Finish();
  void Publish(const HealthReport& report);

  HealthMonitorSettings settings_;
  SpscQueue<Sample> waiting_{kDepth};
  // Of the thread:
  HealthHistory history_;
  std::vector<std::string> alarmed_;  // keys
  std::optional<RunHealth> run_;
  Calibration calibration_{};
  std::uint32_t run_number_ = 0;
  std::string run_began_utc_;
  bool payload_changes_ = false;

  mutable std::mutex mutex_;  // of what follows; held for a few instructions
  std::condition_variable_any ended_;
  nlohmann::json shown_;
  std::string error_;    // of the file; empty: it was written
  std::jthread thread_;  // the last member: it uses the others
};

}  // namespace flexarm
