#include "controller/runlog/run_recording.h"

#include <exception>
#include <nlohmann/json.hpp>
#include <utility>

#include "controller/runlog/run_label.h"
#include "controller/runlog/run_writer.h"

namespace flexarm {
namespace {

// By a command, before the end of the experiment.
bool Stops(const SafetyRecord& record) {
  return record.facts.request == RequestKind::kStop && record.refusal == Refusal::kNone &&
         record.before.state == SafetyState::kRunning && record.facts.experiment_done == 0;
}

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
  last_tick_ns_ = start_ns;
  stopped_ = false;
  trip_ = TripCause::kNone;
  has_run_ = false;
  sink_ = open_(info_);
  if (report_) report_(false, "recording to " + sink_->Name());
}

void RunRecording::BeginRun(const SafetyRecord& granted) {
  if (sink_ != nullptr) Close();
  const RunEvent experiment = context_.Experiment(granted.request_number);
  info_.experiment_name = experiment.name;
  info_.experiment_text = experiment.text;
  info_.label = LabelOfAnnouncement(experiment);
  // Frames are on whole milliseconds, and ticks of the safety task just before them.
  Open(granted.due_ns - granted.due_ns % 1'000'000);
  has_run_ = true;
  for (const RunEvent& event : context_.events()) sink_->Event(event);
  if (Announces(experiment)) sink_->Event(experiment);
}

// No tick of it need be that of a reset: replay compares from the first reset on.
void RunRecording::BeginTrip(const SafetyRecord& trip) {
  info_.experiment_name = std::string("trip-") + ToString(trip.after.cause);
  info_.experiment_text.clear();
  info_.label = {};
  Open(recent_.empty() ? trip.due_ns : recent_.oldest_ns());
  for (const RunEvent& event : context_.events()) {  // who armed it, if that is longer ago
    if (event.time_ns < info_.start_ns) sink_->Event(event);
  }
  struct Write {
    RunRecording* recording;
    void operator()(const TickRecord& record) const { recording->WriteTick(record); }
    void operator()(const TimingRecord& record) const { recording->sink_->Timing(record); }
    void operator()(const SafetyRecord& record) const {
      recording->sink_->Safety(record);
      recording->WriteEventsOf(record);
    }
    void operator()(const RunEvent& event) const { recording->sink_->Event(event); }
  };
  recent_.ForEach(Write{this});
}

void RunRecording::Close() {
  sink_->Close(ResultJson());
  sink_.reset();
}

std::string RunRecording::ResultJson() const {
  const bool tripped = trip_ != TripCause::kNone;
  nlohmann::json result;
  result["completed"] = has_run_ && !tripped && !TorqueAllowed(state_);
  result["trip"] = tripped ? nlohmann::json(ToString(trip_)) : nlohmann::json(nullptr);
  result["ticks"] = ticks_;
  result["missing_ticks"] = missing_ticks_;
  result["stopped"] = stopped_;
  result["duration_s"] = static_cast<double>(last_tick_ns_ - info_.start_ns) * 1e-9;
  result["final_state"] = ToString(state_);
  return result.dump();
}

void RunRecording::WriteEventsOf(const SafetyRecord& record) {
  if (record.facts.request != RequestKind::kNone) sink_->Event(RequestEvent(record));
  stopped_ = stopped_ || Stops(record);
  if (!Trips(record)) return;
  sink_->Event(TripEvent(record));
  trip_ = record.after.cause;
}

void RunRecording::WriteTick(const TickRecord& record) {
  const std::int64_t tick = record.input.tick;
  if (last_tick_ && tick != *last_tick_ + 1) {
    const std::int64_t missing = tick - *last_tick_ - 1;
    missing_ticks_ += missing;
    sink_->Event(GapEvent(record.input.now_ns, *last_tick_ + 1, missing));
  }
  last_tick_ = tick;
  last_tick_ns_ = record.input.now_ns;
  ++ticks_;
  sink_->Tick(record);
}

void RunRecording::SetEnd(const SafetyRecord& record) {
  if (Trips(record)) {
    end_ns_ = record.due_ns + kAfterTripNs;
  } else if (record.after.state == SafetyState::kIdle) {
    end_ns_ = record.due_ns;
  } else if (!end_ns_ && !TorqueAllowed(record.after.state)) {
    end_ns_ = record.due_ns + kAfterRunNs;
  }
}

void RunRecording::Safety(const SafetyRecord& record) noexcept {
  Guarded([&] {
    const SafetyState before = record.before.state;
    if (record.after.state == SafetyState::kRunning && before != SafetyState::kRunning) {
      BeginRun(record);  // it may close the log of the run before, whose end is in state_
    }
    state_ = record.after.state;
    if (Trips(record) && sink_ == nullptr) BeginTrip(record);
    if (before == SafetyState::kTripped && state_ != before) recent_ = {};  // another log has them
    recent_.Add(record);
    if (state_ == SafetyState::kIdle && before != state_ && before != SafetyState::kStarting) {
      context_.Clear();
    }
    if (sink_ == nullptr) {
      if (record.facts.request != RequestKind::kNone) context_.Add(RequestEvent(record));
      return;
    }
    sink_->Safety(record);
    WriteEventsOf(record);
    SetEnd(record);
  });
}

void RunRecording::Tick(const TickRecord& record) noexcept {
  Guarded([&] {
    recent_.Add(record);
    const bool precedes = has_run_ && !last_tick_ && record.input.reset == 0;
    if (sink_ != nullptr && !precedes) WriteTick(record);
  });
}

void RunRecording::Timing(const TimingRecord& record) noexcept {
  Guarded([&] {
    recent_.Add(record);
    if (sink_ != nullptr && last_tick_) sink_->Timing(record);
  });
}

void RunRecording::Event(const RunEvent& event) noexcept {
  Guarded([&] {
    recent_.Add(event);
    if (sink_ == nullptr || Announces(event)) {
      context_.Add(event);
    } else {
      sink_->Event(event);
    }
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
