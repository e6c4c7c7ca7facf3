#include "controller/runlog/run_recording.h"

#include <exception>
#include <nlohmann/json.hpp>
#include <utility>

#include "controller/runlog/run_writer.h"

namespace flexarm {
namespace {

RunEvent TripEvent(const SafetyRecord& record) {
  const nlohmann::json value = {{"value", record.evidence.value},
                                {"limit", record.evidence.limit},
                                {"channel", record.evidence.channel},
                                {"present", CauseNames(record.facts.present)}};
  return {.time_ns = record.due_ns,
          .kind = "trip",
          .name = ToString(record.after.cause),
          .text = OperatorText(record.after.cause),
          .value_json = value.dump()};
}

RunEvent RequestEvent(const SafetyRecord& record) {
  const RequestKind request = record.facts.request;
  const bool accepted = record.refusal == Refusal::kNone;
  const nlohmann::json value = {{"number", record.request_number},
                                {"state", ToString(record.before.state)},
                                {"refusal", ToString(record.refusal)}};
  return {.time_ns = record.due_ns,
          .kind = accepted ? "command" : "refusal",
          .name = ToString(request),
          .text = RefusalText(request, record.refusal, record.before.state),
          .value_json = value.dump()};
}

RunEvent GapEvent(std::int64_t time_ns, std::int64_t first, std::int64_t count) {
  const nlohmann::json value = {{"first_tick", first}, {"ticks", count}};
  return {.time_ns = time_ns,
          .kind = "gap",
          .name = "ticks",
          .text = "There are no records of " + std::to_string(count) + " ticks from tick " +
                  std::to_string(first) + " on.",
          .value_json = value.dump()};
}

}  // namespace

OpenSink RunsInDirectory(const std::filesystem::path& directory) {
  return [directory](const RunInfo& info) -> std::unique_ptr<RunSink> {
    return std::make_unique<RunWriter>(NewRunFile(directory, info.experiment_name), info);
  };
}

OpenSink RunInFile(const std::filesystem::path& file) {
  return [file](const RunInfo& info) -> std::unique_ptr<RunSink> {
    return std::make_unique<RunWriter>(file, info);
  };
}

OpenSink RunInMemory(RunContents* contents) {
  return [contents](const RunInfo& info) -> std::unique_ptr<RunSink> {
    *contents = RunContents{};
    contents->info = info;
    return std::make_unique<RunMemory>(contents);
  };
}

RunRecording::RunRecording(RunInfo info, OpenSink open, Report report)
    : info_(std::move(info)), open_(std::move(open)), report_(std::move(report)) {}

template <typename Action>
void RunRecording::Guarded(Action action) noexcept {
  try {
    action();
  } catch (const std::exception& error) {
    CountError(error.what());
  }
}

void RunRecording::CountError(const std::string& what) noexcept {
  ++errors_;
  sink_.reset();
  try {
    if (report_) report_(true, what + "; the recording of this run has ended");
  } catch (const std::exception&) {  // counted; the report itself failed
  }
}

void RunRecording::Open(std::int64_t start_ns) {
  info_.start_ns = start_ns;
  info_.start_utc = UtcNow();
  end_ns_.reset();
  last_tick_.reset();
  ticks_ = missing_ticks_ = 0;
  trip_ = TripCause::kNone;
  has_run_ = false;
  sink_ = open_(info_);
  sink_name_ = sink_->Name();
  if (report_) report_(false, "recording to " + sink_name_);
}

void RunRecording::Close() {
  sink_->Close(ResultJson());
  sink_.reset();
  info_.experiment_name.clear();
  info_.experiment_text.clear();
  if (report_) report_(false, "run closed: " + sink_name_);
}

std::string RunRecording::ResultJson() const {
  const bool tripped = trip_ != TripCause::kNone;
  nlohmann::json result;
  result["completed"] = has_run_ && !tripped && !TorqueAllowed(state_);
  result["trip"] = tripped ? nlohmann::json(ToString(trip_)) : nlohmann::json(nullptr);
  result["ticks"] = ticks_;
  result["missing_ticks"] = missing_ticks_;
  result["final_state"] = ToString(state_);
  return result.dump();
}

void RunRecording::WriteEventsOf(const SafetyRecord& record) {
  if (record.facts.request != RequestKind::kNone) sink_->Event(RequestEvent(record));
  const bool trips = CauseLatched(record.after.state) && !CauseLatched(record.before.state);
  if (!trips) return;
  sink_->Event(TripEvent(record));
  trip_ = record.after.cause;
  end_ns_ = record.due_ns + kAfterTripNs;
}

void RunRecording::Safety(const SafetyRecord& record) noexcept {
  Guarded([&] {
    const bool arms = record.before.state == SafetyState::kIdle &&
                      (record.after.state == SafetyState::kArmed || TestsPower(record.after.state));
    if (arms && sink_ != nullptr) Close();
    if (arms) Open(record.due_ns);
    state_ = record.after.state;
    if (sink_ == nullptr) return;
    sink_->Safety(record);
    WriteEventsOf(record);
    if (state_ == SafetyState::kRunning) has_run_ = true;
    if (state_ == SafetyState::kIdle) end_ns_ = record.due_ns;
  });
}

void RunRecording::Tick(const TickRecord& record) noexcept {
  const std::int64_t tick = record.input.tick;
  if (sink_ == nullptr || (!last_tick_ && record.input.reset == 0)) return;
  Guarded([&] {
    if (last_tick_ && tick != *last_tick_ + 1) {
      const std::int64_t missing = tick - *last_tick_ - 1;
      missing_ticks_ += missing;
      sink_->Event(GapEvent(record.input.now_ns, *last_tick_ + 1, missing));
    }
    last_tick_ = tick;
    ++ticks_;
    sink_->Tick(record);
  });
}

void RunRecording::Timing(const TimingRecord& record) noexcept {
  if (sink_ == nullptr || !last_tick_) return;
  Guarded([&] { sink_->Timing(record); });
}

void RunRecording::Event(const RunEvent& event) noexcept {
  Guarded([&] {
    const bool announces = event.kind == "experiment";
    if (announces && sink_ == nullptr) {
      info_.experiment_name = event.name;
      info_.experiment_text = event.text;
    }
    if (sink_ == nullptr) return;
    if (announces) sink_->SetExperiment(event.name, event.text);
    sink_->Event(event);
  });
}

void RunRecording::Until(std::int64_t time_ns) noexcept {
  if (sink_ == nullptr || !end_ns_ || time_ns <= *end_ns_) return;
  Guarded([&] { Close(); });
}

void RunRecording::Commit() noexcept {
  if (sink_ == nullptr) return;
  Guarded([&] { sink_->Commit(); });
}

void RunRecording::Finish() noexcept {
  if (sink_ == nullptr) return;
  Guarded([&] { Close(); });
}

}  // namespace flexarm
