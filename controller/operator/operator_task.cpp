#include "controller/operator/operator_task.h"

#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "controller/operator/limits_json.h"
#include "controller/operator/log_condition.h"
#include "controller/operator/request_answers.h"
#include "controller/operator/status_json.h"
#include "controller/runlog/csv.h"
#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

std::optional<ExperimentLoader::Order> OrderOf(const OperatorContext& context,
                                               const ExperimentLoader& loader) {
  if (!context.unattended) return std::nullopt;
  constexpr std::array<double, 2> kStart_rad = {0.0, 0.0};
  if (context.judge_experiment) {
    if (const auto unmet = context.judge_experiment(*context.unattended, kStart_rad, {})) {
      throw RejectedError(context.unattended->name + ": " + unmet->found + "; " + unmet->remedy);
    }
  }
  return loader.Plan(*context.unattended, kStart_rad);
}

// Within it the recorder takes the reserved file for the log of a trip: it is 0.15 s late at most.
constexpr std::int64_t kTripLogNs = 1'000'000'000;

// Of this thread.
double ProcessorTime_us() {
  timespec spent{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &spent);
  return 1e6 * static_cast<double>(spent.tv_sec) + 1e-3 * static_cast<double>(spent.tv_nsec);
}

}  // namespace

OperatorTask::OperatorTask(OperatorContext context)
    : context_(std::move(context)),
      requests_(context_.stack, context_.latch),
      experiments_(context_.stack, &requests_, context_.events, context_.design, context_.grid,
                   context_.limits, context_.reduced_limits),
      unattended_order_(OrderOf(context_, experiments_)),
      commissioning_(*context_.config, {.stack = context_.stack,
                                        .experiments = &experiments_,
                                        .requests = &requests_,
                                        .report = context_.report}),
      switches_(*context_.config, context_.latch, context_.report),
      overrides_(context_.events, context_.report),
      arm_(context_.arm_checks, {.requests = &requests_,
                                 .overrides = &overrides_,
                                 .files = context_.files,
                                 .report = context_.report}),
      run_({.experiments = &experiments_,
            .commissioning = &commissioning_,
            .switches = &switches_,
            .overrides = &overrides_,
            .files = context_.files,
            .parse_experiment = context_.parse_experiment,
            .judge_experiment = context_.judge_experiment,
            .plan_wait = context_.plan_wait}),
      change_({.experiments = &experiments_,
               .events = context_.events,
               .period_s = context_.grid.period_s(),
               .plan_wait = context_.plan_wait}),
      run_watch_(context_.grid.period_s()),
      warnings_(context_.grid.period_ns, context_.delay_margin_s,
                StrainColumns(context_.config->sensors), context_.events, context_.report),
      state_journal_(context_.stack, &context_.config->sensors, context_.events, context_.report),
      circumstances_({.sensors = &context_.config->sensors,
                      .bus_text =
                          [this](TripCause cause, const Evidence& evidence) {
                            return context_.stack->BusText(cause, evidence);
                          },
                      .thread_status = context_.thread_status},
                     context_.events),
      bus_counters_(context_.events),
      timing_warnings_(context_.events, context_.report),
      record_(context_.events, context_.report),
      lease_(context_.events, context_.report),
      dispatch_({.stack = context_.stack,
                 .requests = &requests_,
                 .commissioning = &commissioning_,
                 .switches = &switches_,
                 .arm = &arm_,
                 .run = &run_,
                 .change = &change_,
                 .lease = &lease_,
                 .record = &record_,
                 .files = context_.files,
                 .status = [this] { return Status(); },
                 .report = context_.report}),
      unattended_(unattended_order_ ? unattended_order_->planned.get() : nullptr,
                  Shutdown::kSettleNs),
      auto_disarm_(context_.config->safety.disarm_after_s),
      shutdown_(Shutdown::LimitNs(context_.config->safety)) {
  if (unattended_order_) RequireArm();
  if (unattended_order_ && context_.files != nullptr) context_.files->Want();
  if (!context_.socket.empty()) socket_ = std::make_unique<OperatorSocket>(context_.socket);
  if (unattended_order_) experiments_.Announce(now_.now_ns, *unattended_order_);
}

OperatorTask::~OperatorTask() = default;

void OperatorTask::RequireArm() const {
  if (const std::string why = arm_.WhyNotUnattended(); !why.empty()) throw RejectedError(why);
}

Task::Traits OperatorTask::traits() const noexcept {
  return {.name = "operator",
          .period_ns = kLookNs,
          .phase_ns = 0,
          .deadline_ns = kLookNs,
          .priority = 0};
}

void OperatorTask::Run(const Activation& activation) noexcept {
  try {
    now_.now_ns = activation.due_ns;
    look_began_us_ = ProcessorTime_us();
    // On the grid of the periods, or soon after one that was skipped.
    const bool late = followed_ns_ != INT64_MIN && now_.now_ns - followed_ns_ > kPeriodNs;
    if (now_.now_ns % kPeriodNs == 0 || late) return Follow();
    now_.permit = context_.stack->operator_permits().Read().At(now_.now_ns - 1).value;
    FollowLatch();  // a trip that a client is told of survives a kill
    if (socket_) Serve();
  } catch (const std::exception& error) {
    context_.report(true, std::string("operator: ") + error.what());
  }
}

void OperatorTask::Follow() {
  followed_ns_ = now_.now_ns;
  BeginShutdown();  // its line precedes those of its effects
  FollowState();
  FollowBuses();
  if (!context_.stack->late_threads_trip()) {
    timing_warnings_.Follow(now_.now_ns, context_.stack->timing());
  }
  commissioning_.Follow(context_.stack->count_epochs());
  TakeTicks();
  TakeAnswers();
  FollowLatch();
  FollowLog();
  FollowAutoDisarm();
  Reply(arm_.Follow(now_));
  record_.Follow(now_.now_ns);
  if (socket_) Serve();
  FollowUnattended();
  FollowShutdown();
  experiments_.FreeReleased();
  if (loop_watch_.Follow(now_, context_.report)) {
    context_.alive(now_.now_ns, ToString(now_.permit.state));
  }
}

void OperatorTask::FollowState() {
  now_.permit = context_.stack->operator_permits().Read().At(now_.now_ns - 1).value;
  const bool latched = CauseLatched(now_.permit.state);
  trip_.store(latched ? now_.permit.cause : TripCause::kNone, std::memory_order_relaxed);
  state_journal_.Follow(now_.now_ns, now_.permit);
  lease_.Follow(now_.now_ns, now_.permit.state);
  overrides_.Follow(now_.permit);
}

void OperatorTask::FollowBuses() {
  const std::vector<BusHealth> buses = context_.stack->buses();
  bus_journal_.Follow(now_.now_ns, buses, context_.report);
  bus_counters_.Follow(now_.now_ns, now_.permit.state, buses);
  circumstances_.Follow(now_.now_ns, now_.permit, context_.stack->present_causes(), buses);
}

void OperatorTask::TakeTicks() {
  while (context_.stack->operator_ticks().Pop(&now_.tick)) {
    commissioning_.Take(now_.tick);
    switches_.Take(now_.tick);
    warnings_.Take(now_.now_ns, now_.tick);
    if (context_.take_tick) context_.take_tick(now_.tick);
  }
  Reply(commissioning_.TakeAnswer(now_));
  Reply(switches_.TakeAnswer(now_.permit));
}

// The permit is read first: a stop that ended the run it shows has been answered before.
void OperatorTask::TakeAnswers() {
  const Permit newest = context_.stack->operator_permits().Read().Newest().value;
  RequestAnswer answer{};
  while (context_.stack->answers().Pop(&answer)) Take(answer);
  run_watch_.Follow(now_.now_ns, newest, now_.tick, now_.shutting_down);
}

void OperatorTask::Take(const RequestAnswer& answer) {
  unattended_.Answered(answer);
  const std::vector<int> clients = requests_.TakeClientsOf(answer);
  if (clients.empty()) context_.report(answer.refusal != Refusal::kNone, AnswerLine(answer));
  experiments_.Answered(answer);
  run_watch_.Answered(answer, experiments_.name());
  overrides_.Answered(now_.now_ns, answer);
  const std::optional<std::string> change = change_.Answered(now_.now_ns, answer);
  Reply(commissioning_.Answered(answer, now_));
  // The safety task publishes the permit of a tick before the answers of that tick.
  const SafetyState state = context_.stack->operator_permits().Read().Newest().value.state;
  for (const int client : clients) {
    if (answer.kind == RequestKind::kArm && answer.refusal == Refusal::kNone) {
      if (const std::optional<Peer> by = record_.Giver(client, "arm")) {
        lease_.Armed(now_.now_ns, *by);
      }
    }
    nlohmann::json json = AnswerJson(answer, state);
    if (change) json["command"] = *change;
    Reply(client, std::move(json));
  }
}

// After the answers, of the newest permit: an arm that was answered is in it.
void OperatorTask::FollowLatch() {
  const Permit& newest = context_.stack->operator_permits().Read().Newest().value;
  context_.latch->Follow(now_.now_ns, newest, requests_.busy());
}

// The reserved file is for an arm that is armed, or about to be; and for the log of a trip, which
// the recorder begins a moment after it. Of the newest permit, as above.
void OperatorTask::FollowLog() {
  if (context_.files == nullptr || requests_.busy() || arm_.waits()) return;
  const SafetyState state = context_.stack->operator_permits().Read().Newest().value.state;
  if (!CauseLatched(state)) trip_log_until_ns_ = now_.now_ns + kTripLogNs;
  const bool disarmed =
      state == SafetyState::kIdle || (CauseLatched(state) && now_.now_ns >= trip_log_until_ns_);
  const bool is_planned = context_.unattended && !unattended_.over();
  if (disarmed && !is_planned) context_.files->Release();
}

void OperatorTask::FollowAutoDisarm() {
  if (context_.unattended || !auto_disarm_.Follow(now_.now_ns, now_.permit.state)) return;
  context_.report(false, "armed without a run for " +
                             std::to_string(std::llround(context_.config->safety.disarm_after_s)) +
                             " s (safety.disarm_after_s): disarming");
  requests_.Ask(RequestKind::kDisarm, now_.now_ns, RequestTracker::kNoClient);
}

void OperatorTask::Serve() {
  socket_->SetHolder(lease_.holder());
  for (const OperatorSocket::Message& message : socket_->Poll()) {
    record_.Heard(message.waited_polls, ProcessorTime_us() - look_began_us_);
    nlohmann::json answer = dispatch_.Answer(message.client, message.by, message.line, now_);
    if (!answer.is_null()) Reply(message.client, std::move(answer));
  }
  const auto is_there = [this](int client) { return socket_->IsThere(client); };
  Reply(run_.Follow(now_, is_there));
  Reply(change_.Follow(now_, is_there));
  for (const Peer& peer : socket_->turned_away()) record_.TurnedAway(now_.now_ns, peer);
}

void OperatorTask::FollowUnattended() {
  if (!context_.unattended || shutdown_requested_.load(std::memory_order_relaxed)) return;
  if (!LogReady()) return;
  const OperatorRequest request = unattended_.Update(now_.now_ns, now_.permit);
  if (request.kind != RequestKind::kNone) {
    const RequestTracker::Asked asked = requests_.AskPlanned(request);
    if (asked.refusal != Refusal::kNone) {
      Take({.number = request.number,
            .kind = request.kind,
            .refusal = asked.refusal,
            .state = now_.permit.state,
            .present = 0});
    }
  }
  if (unattended_.progress() == UnattendedRun::Progress::kRefused) {
    refused_.store(true, std::memory_order_relaxed);
  }
  if (now_.now_ns >= unattended_.over_ns()) done_.store(true, std::memory_order_release);
}

// Before the run is asked for. A file that cannot be had refuses the run.
bool OperatorTask::LogReady() {
  if (log_ready_) return true;
  const std::optional<UnmetCondition> no_log = UnmetLog(context_.files);
  log_ready_ = !no_log;
  if (log_ready_) return true;
  const bool late = now_.now_ns > ArmCommand::kLongestCheckNs;
  if (!context_.files->status().answered && !late) return false;
  if (!refused_.exchange(true, std::memory_order_relaxed)) {
    context_.report(true, "arm: refused: " + no_log->found + "; " + no_log->remedy);
  }
  done_.store(true, std::memory_order_release);
  return false;
}

void OperatorTask::BeginShutdown() {
  if (!shutdown_requested_.load(std::memory_order_relaxed) || shutdown_.begun()) return;
  now_.shutting_down = true;
  shutdown_.Begin(now_.now_ns, unattended_.over_ns());
  context_.report(false, "shutting down: bringing the arm to rest");
}

void OperatorTask::FollowShutdown() {
  if (!shutdown_.begun() || done()) return;
  shutdown_.Update(now_.now_ns, now_.permit.state);
  if (shutdown_.over()) done_.store(true, std::memory_order_release);
}

// Of the trip that is latched: a report takes seconds, and until then the newest is of another.
std::string OperatorTask::TripReportFile() const {
  if (!context_.newest_trip_report) return {};
  const TripReport report = context_.newest_trip_report();
  return circumstances_.IsOfLatched(report.trip_ns) ? report.file.string() : std::string();
}

// Once a look, however many ask.
const nlohmann::json& OperatorTask::Status() {
  if (status_ns_ == now_.now_ns) return status_;
  status_ns_ = now_.now_ns;
  status_ = StatusJson(
      {.now = &now_,
       .delay = &warnings_.delay(),
       .sensors = &context_.config->sensors,
       .angles = &commissioning_.angles(),
       .layout = context_.config->controller.nominal,
       .missing_gauges = warnings_.missing_gauges(),
       .experiment = experiments_.name(),
       .buses = context_.stack->buses(),
       .bus_text =
           [this](TripCause cause, const Evidence& evidence) {
             return context_.stack->BusText(cause, evidence);
           },
       .present = &context_.stack->present_causes(),
       .latch = context_.latch,
       .trip_report = TripReportFile(),
       .threads = context_.thread_status(),
       .host = arm_.HostStatus(),
       .design = arm_.DesignStatus(),
       .overrides = overrides_.Json(),
       .switches = switches_.Json(),
       .log = LogJson(context_.files),
       .telemetry =
           context_.telemetry_status ? context_.telemetry_status() : nlohmann::json(nullptr),
       .health = context_.health_status ? context_.health_status() : nlohmann::json(nullptr),
       .identity = context_.identity,
       .lease = lease_.Json(now_.now_ns),
       .run = run_watch_.Json(),
       .why_no_run = commissioning_.WhyNoRun(),
       .timing = context_.stack->timing(),
       .late_threads_trip = context_.stack->late_threads_trip(),
       .log_records_dropped = context_.stack->tick_records().dropped() +
                              context_.stack->safety_records().dropped() +
                              context_.events->dropped()});
  status_["limits"] = LimitsJson(context_.config->safety, now_.permit.reduced);
  return status_;
}

void OperatorTask::Reply(int client, nlohmann::json answer) {
  record_.Answered(now_.now_ns, client, &answer);
  socket_->Reply(client, answer.dump());
}

void OperatorTask::Reply(std::optional<ClientAnswer> answer) {
  if (answer) Reply(answer->client, std::move(answer->json));
}

}  // namespace flexarm
