#include "controller/runlog/run_files.h"

#include <exception>
#include <utility>

#include "controller/runlog/errors.h"
#include "controller/runlog/retention.h"
#include "controller/runlog/run_writer.h"

namespace flexarm {
namespace {

constexpr std::int64_t kTryAgainNs = 1'000'000'000;
constexpr double kBytesPerMb = 1e6;

std::string MegabytesText(double mb) { return std::to_string(static_cast<std::int64_t>(mb)); }

}  // namespace

/// A run of the daemon: tells the files how the disk does, and leaves its end to the finisher.
class RunFiles::Recorded final : public RunSink {
 public:
  Recorded(RunFiles* files, std::unique_ptr<RunWriter> writer)
      : files_(files), writer_(std::move(writer)) {
    files_->run_file_ = writer_->Name();
    files_->run_trouble_.clear();
  }
  ~Recorded() override {
    files_->run_file_.clear();
    files_->run_trouble_.clear();
  }

  std::string Name() const override { return writer_->Name(); }
  void Tick(const TickRecord& record) override { writer_->Tick(record); }
  void Timing(const TimingRecord& record) override { writer_->Timing(record); }
  void Safety(const SafetyRecord& record) override { writer_->Safety(record); }
  void Event(const RunEvent& event) override { writer_->Event(event); }
  void Commit() override {
    writer_->Commit();
    const std::string trouble = writer_->Trouble();
    if (trouble != files_->run_trouble_ && files_->report_) {
      files_->report_(!trouble.empty(), trouble.empty()
                                            ? writer_->Name() + ": everything is written again"
                                            : trouble + "; the run goes on, its records wait");
    }
    files_->run_trouble_ = trouble;
  }
  std::string Trouble() const override { return writer_->Trouble(); }
  void Close(const std::string& result_json) override {
    files_->finisher_->Add(writer_->End(result_json));
  }

 private:
  RunFiles* files_;
  std::unique_ptr<RunWriter> writer_;
};

RunFiles::RunFiles(std::filesystem::path directory, const LogConfig& config, RunFinisher* finisher,
                   Report report)
    : directory_(std::move(directory)),
      config_(config),
      finisher_(finisher),
      report_(std::move(report)) {
  status_.required = config_.required;
}

void RunFiles::Want() {
  if (++last_asked_ == 0) ++last_asked_;
  asked_.store(last_asked_, std::memory_order_release);
}

void RunFiles::Release() { asked_.store(0, std::memory_order_release); }

LogStatus RunFiles::status() const {
  const std::uint32_t asked = asked_.load(std::memory_order_acquire);
  const std::lock_guard lock(mutex_);
  LogStatus status = status_;
  status.answered = asked != 0 && answered_ == asked;
  status.ready = status.answered && is_reserved_;
  return status;
}

void RunFiles::Follow(std::int64_t now_ns) noexcept {
  try {
    const std::uint32_t asked = asked_.load(std::memory_order_acquire);
    const bool looks = now_ns >= next_look_ns_;
    if (looks) next_look_ns_ = now_ns + kTryAgainNs;
    std::error_code ignored;
    const bool vanished =
        looks && reserved_.is_valid() && !std::filesystem::exists(reserved_.path(), ignored);
    if (asked == 0 || vanished) reserved_ = ReservedRunFile();
    if (asked == 0) SetError("");
    const bool is_due = asked != answered_ || now_ns >= next_try_ns_;
    if (asked != 0 && !reserved_.is_valid() && is_due) {
      next_try_ns_ = now_ns + kTryAgainNs;
      Reserve();
    }
    if (reserved_.is_valid()) next_try_ns_ = INT64_MIN;  // the next one at once
    if (looks) free_bytes_ = FreeBytes(directory_);
    Publish(asked);
  } catch (const std::exception& error) {  // out of memory: the next period tries again
    if (report_) report_(true, std::string("log: ") + error.what());
  }
}

void RunFiles::Reserve() {
  try {
    RemoveOldRuns(directory_, config_, report_);
    ReservedRunFile file = ReservedRunFile::In(
        directory_, static_cast<std::uint64_t>(config_.reserve_mb * kBytesPerMb));
    // After the reservation, which has taken its space already where the file system can reserve.
    const std::optional<std::uint64_t> free = FreeBytes(directory_);
    if (free && static_cast<double>(*free) < config_.keep_free_mb * kBytesPerMb) {
      throw RunLogError(directory_.string() + ": " +
                        MegabytesText(static_cast<double>(*free) / kBytesPerMb) +
                        " MB are free beside the next run; log.keep_free_mb asks for " +
                        MegabytesText(config_.keep_free_mb) + " MB");
    }
    reserved_ = std::move(file);
    SetError("");
  } catch (const std::exception& error) {
    SetError(error.what());
  }
}

// Each error once: it is found again every second.
void RunFiles::SetError(const std::string& error) {
  if (error == reserve_error_) return;
  reserve_error_ = error;
  if (!error.empty() && report_) report_(true, "no file for the next run: " + error);
}

void RunFiles::Publish(std::uint32_t asked) {
  std::optional<double> free_mb;
  if (free_bytes_) free_mb = static_cast<double>(*free_bytes_) / kBytesPerMb;
  const std::lock_guard lock(mutex_);
  answered_ = asked;
  is_reserved_ = reserved_.is_valid();
  status_.file = run_file_;
  status_.error = run_trouble_.empty() ? reserve_error_ : run_trouble_;
  status_.free_mb = free_mb;
}

std::unique_ptr<RunSink> RunFiles::Open(const RunInfo& info) {
  const std::filesystem::path file = NewRunFile(directory_, info.experiment_name);
  if (reserved_.is_valid()) {
    try {
      reserved_.Rename(file);
      return std::make_unique<Recorded>(
          this, std::make_unique<RunWriter>(std::exchange(reserved_, ReservedRunFile()), info));
    } catch (const RunLogError& error) {  // it was removed, or its disk was
      reserved_ = ReservedRunFile();
      if (report_) report_(true, std::string(error.what()) + "; trying another file");
    }
  }
  return std::make_unique<Recorded>(this, std::make_unique<RunWriter>(file, info));
}

}  // namespace flexarm
