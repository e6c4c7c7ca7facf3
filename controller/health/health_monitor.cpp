#include "controller/health/health_monitor.h"

#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "controller/files/input_error.h"
#include "controller/files/write_file.h"

namespace flexarm {
namespace {

// Between two looks into the queue.
constexpr std::chrono::milliseconds kLook{100};

nlohmann::json AlarmsJson(const HealthReport& report) {
  const std::vector<std::string> keys = report.AlarmedKeys(), texts = report.AlarmTexts();
  nlohmann::json alarms = nlohmann::json::array();
  for (std::size_t i = 0; i < keys.size(); ++i) {
    alarms.push_back({{"channel", keys[i]}, {"text", texts[i]}});
  }
  return alarms;
}

}  // namespace

HealthMonitor::HealthMonitor(HealthMonitorSettings settings) : settings_(std::move(settings)) {}

HealthMonitor::~HealthMonitor() { Stop(); }

void HealthMonitor::Start() {
  Read();
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

void HealthMonitor::Stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void HealthMonitor::Take(const TickRecord& tick, bool payload_changes) noexcept {
  waiting_.Push({.tick = tick, .payload_changes = payload_changes});
}

void HealthMonitor::Read() {
  const FileContent content = ReadExternalFile(settings_.file, kHealthFile);
  if (content.problem && !content.problem->missing) SetAside(content.problem->Text(settings_.file));
  if (!content.problem) {
    try {
      history_ = ParseHistory(content.text, settings_.file.string(),
                              DriftChannels(settings_.config.arm, settings_.config.sensors));
    } catch (const InputError& error) {
      SetAside(error.what());
    }
  }
  const HealthReport report = ReportOf(settings_.config, settings_.health, history_);
  alarmed_ = report.AlarmedKeys();
  Publish(report);
}

void HealthMonitor::SetAside(const std::string& problem) {
  std::filesystem::path aside;
  int number = 1;
  std::error_code error;
  do {
    aside = settings_.file.string() + ".broken-" + std::to_string(number++);
  } while (std::filesystem::exists(aside, error));
  std::filesystem::rename(settings_.file, aside, error);
  settings_.report(true, "health: " + problem + "; " +
                             (error ? "it cannot be set aside: " + error.message()
                                    : "set aside as " + aside.string()) +
                             ", the reference begins again");
}

void HealthMonitor::Run(const std::stop_token& stop) {
  pthread_setname_np(pthread_self(), "health");
  while (!stop.stop_requested()) {
    TakeWaiting();
    std::unique_lock lock(mutex_);
    ended_.wait_for(lock, stop, kLook, [] { return false; });
  }
  TakeWaiting();
}

void HealthMonitor::TakeWaiting() {
  Sample sample{};
  while (waiting_.Pop(&sample)) {
    // The arm may move: no error of these figures ends the daemon.
    try {
      Follow(sample);
    } catch (const std::exception& error) {
      run_.reset();
      settings_.report(true, std::string("health: the run is not judged: ") + error.what());
    }
  }
}

// The loop is reset at the grant of a run, and its log begins there.
void HealthMonitor::Follow(const Sample& sample) {
  if (sample.tick.input.reset != 0) {
    run_.emplace(settings_.config, settings_.plant);
    run_began_utc_ = settings_.utc_now();
    payload_changes_ = false;
  }
  if (!run_) return;
  run_->Take(sample.tick.input, sample.tick.output);
  if (run_->ended()) {
    Finish();
    run_.reset();
    return;
  }
  calibration_ = sample.tick.input.calibration;
  run_number_ = sample.tick.run_number;
  payload_changes_ = payload_changes_ || sample.payload_changes;
}

void HealthMonitor::Finish() {
  RunFigures figures = run_->Figures();
  if (payload_changes_) figures.unused = kPayloadChanges;
  HealthRecord record = RecordOf(settings_.config, calibration_, figures);
  record.run = std::to_string(run_number_);
  record.start_utc = run_began_utc_;
  history_.Add(std::move(record));

  std::string problem;
  const HealthReport report = ReportOf(settings_.config, settings_.health, history_);
  try {
    WriteFile(settings_.file, HistoryText(report.channels, history_),
              ReplaceAny("the health of a rig"));
  } catch (const InputError& error) {
    problem = error.what();
  }
  if (!problem.empty()) settings_.report(true, "health: " + problem);
  for (std::size_t i = 0; i < report.channels.size(); ++i) {
    if (!report.Alarmed(i)) continue;
    if (std::ranges::find(alarmed_, report.channels[i].Key()) != alarmed_.end()) continue;
    settings_.report(true, "health: " + AlarmText(report.channels[i], report.trends[i]));
  }
  alarmed_ = report.AlarmedKeys();
  {
    const std::scoped_lock lock(mutex_);
    error_ = problem;
  }
  Publish(report);
}

void HealthMonitor::Publish(const HealthReport& report) {
  const bool none = history_.run.empty();
  nlohmann::json shown = {
      {"runs", history_.run.size()},
      {"newest_run", none ? nlohmann::json(nullptr) : nlohmann::json(history_.run.back().run)},
      {"alarms", AlarmsJson(report)}};
  const std::scoped_lock lock(mutex_);
  shown_ = std::move(shown);
}

nlohmann::json HealthMonitor::Status() const {
  const std::scoped_lock lock(mutex_);
  nlohmann::json status = shown_;
  status["lost"] = waiting_.dropped();
  status["error"] = error_.empty() ? nlohmann::json(nullptr) : nlohmann::json(error_);
  return status;
}

}  // namespace flexarm
