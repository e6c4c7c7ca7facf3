#include "controller/tasks/safety_task.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace flexarm {
namespace {

// What a drive in fault, or a bus that comes back, causes until it is well.
constexpr TripCauses kDriveSideCauses =
    CauseBit(TripCause::kBusLost) | CauseBit(TripCause::kDriveFault) |
    CauseBit(TripCause::kStaleFrame) | CauseBit(TripCause::kNoCounterReading);

using FactBytes = std::array<std::uint8_t, sizeof(SafetyFacts)>;

bool SameFacts(const SafetyFacts& a, const SafetyFacts& b) noexcept {
  return std::bit_cast<FactBytes>(a) == std::bit_cast<FactBytes>(b);
}

bool RaisesEnergy(RequestKind kind) noexcept {
  return kind == RequestKind::kArm || kind == RequestKind::kRun || kind == RequestKind::kChange;
}

bool IsCancelled(const OperatorRequest& request, std::uint32_t below) noexcept {
  return RaisesEnergy(request.kind) && request.number < below;
}

}  // namespace

SafetyTask::SafetyTask(const MonitorLimits& limits, SafetyChannels channels, std::int64_t phase_ns)
    : channels_(std::move(channels)), phase_ns_(phase_ns), monitor_(limits) {}

Task::Traits SafetyTask::traits() const noexcept {
  return {.name = "safety",
          .period_ns = kPeriodNs,
          .phase_ns = phase_ns_,
          .deadline_ns = kPeriodNs,
          .priority = kPriority};
}

void SafetyTask::Run(const Activation& activation) noexcept {
  const std::int64_t due_ns = activation.due_ns;
  const ControlReportHistory& control = channels_.control->Read();
  const DriveSide drive = ReadDrives(due_ns);
  const SafetyLines::Reading read = channels_.lines->Read(due_ns);
  const LineLevels levels = filter_.Next(MergeRedundantLevels(read.levels, drive.report.levels));
  // Before the request is taken: an arm that was asked for after a change of the limits finds it.
  if (!RelayClosed(status_.state)) reduced_ = channels_.reduced->load(std::memory_order_acquire);
  OperatorRequest request = TakeRequest(due_ns, drive.report);
  if (request.kind == RequestKind::kChange && TooLate(request, due_ns)) {
    Answer(request, Refusal::kTooLate, status_.state, last_facts_.present);
    request = {.kind = RequestKind::kNone, .number = 0, .not_before_ns = due_ns};
  }
  const bool requested = request.kind != RequestKind::kNone;

  const SafetyInputs in{.due_ns = due_ns,
                        .levels = levels,
                        .control = control.At(due_ns).value,
                        .control_alive_ns = control.Newest().value.due_ns,
                        .drive = drive.report,
                        .drive_alive_ns = drive.alive_ns,
                        .troubles = drive.troubles,
                        .request = request.kind,
                        .shutting_down = channels_.shutting_down->load(std::memory_order_acquire),
                        .state = status_.state,
                        .state_since_ns = state_since_ns_,
                        .running_since_ns = running_since_ns_,
                        .may_open = run_.may_open,
                        .levels_known = filter_.known(),
                        .line_calls = {.read = read.call, .write = written_},
                        .permit_age_ns = PermitAgeNs(activation),
                        .relay = read.relay};
  const SafetyFacts facts = monitor_.Judge(in);
  const SafetyStatus before = status_;
  const SafetyDecision decision = NextSafetyState(before, facts);
  Enter(decision.status, in, request);
  if (request.kind == RequestKind::kChange && decision.refusal == Refusal::kNone) {
    change_ = {.number = request.number, .experiment = request.run.experiment};
  }
  Drive(due_ns);
  Publish(due_ns, levels);
  PublishPresent(facts.present, in);
  if (DrivesEnabled(before.state) && !DrivesEnabled(status_.state)) {
    for (Wakeup* wakeup : channels_.wakeups) wakeup->Wake();
  }

  if (requested || !recorded_ || status_ != before || !SameFacts(facts, last_facts_)) {
    channels_.records->Push({.due_ns = due_ns,
                             .facts = facts,
                             .evidence = evidence_,
                             .request_number = request.number,
                             .before = before,
                             .after = status_,
                             .refusal = decision.refusal,
                             .reserved = {}});
    last_facts_ = facts;
    recorded_ = true;
  }
  AnswerRequests(request, decision.refusal, before.state, facts);
}

// Each request is answered once: a disarm when the relay is open, an arm after its tests.
void SafetyTask::AnswerRequests(const OperatorRequest& request, Refusal refusal, SafetyState before,
                                const SafetyFacts& facts) noexcept {
  const bool requested = request.kind != RequestKind::kNone;
  const bool tripped = CauseLatched(status_.state) && !CauseLatched(before);
  const bool disarms =
      request.kind == RequestKind::kDisarm && status_.state == SafetyState::kDisarming;
  if (disarms) {
    disarm_ = request;
  } else if (request.kind == RequestKind::kArm && TestsPower(status_.state) &&
             !TestsPower(before)) {
    arm_ = request;
  } else if (requested) {
    Answer(request, refusal, before, facts.present);
  }
  if (disarm_.number != 0 && status_.state != SafetyState::kDisarming) {  // the relay is open
    Answer(disarm_, Refusal::kNone, before, facts.present);
    disarm_ = {};
  }
  if (arm_.number != 0 && !TestsPower(status_.state)) {
    Answer(arm_, RefusalOfArm(facts), before, facts.present);
    arm_ = {};
  }
  if (tripped) {
    CancelBelow(UINT32_MAX);
  } else if (request.kind == RequestKind::kStop || request.kind == RequestKind::kDisarm) {
    CancelBelow(request.number);
  }
}

void SafetyTask::Ended() noexcept {
  // No later tick judges the call: the charge pump, which stands still now, is behind it.
  static_cast<void>(channels_.lines->Write(permits_.Newest().value.renewed_ns + kPeriodNs,
                                           {.relay_closed = false, .pump_level = false}));
}

// On the grid, plus how late this tick is: what a drive that looked just now would have found.
std::int64_t SafetyTask::PermitAgeNs(const Activation& activation) const noexcept {
  const std::int64_t renewed_ns = permits_.Newest().value.renewed_ns;
  return renewed_ns == INT64_MIN ? 0 : activation.due_ns + activation.late_ns - renewed_ns;
}

void SafetyTask::Answer(const OperatorRequest& request, Refusal refusal, SafetyState judged_in,
                        TripCauses present) noexcept {
  channels_.answers->Push({.number = request.number,
                           .kind = request.kind,
                           .refusal = refusal,
                           .state = judged_in,
                           .present = present});
}

SafetyTask::DriveSide SafetyTask::ReadDrives(std::int64_t due_ns) noexcept {
  DriveSide side{.report = {.due_ns = INT64_MAX, .bus_ok = true, .drive_ok = true},
                 .alive_ns = INT64_MAX,
                 .troubles = {}};
  std::uint32_t bus = 0;
  for (DriveReportChannel* channel : channels_.drives) {
    const DriveReportHistory& history = channel->Read();
    ++bus;
    const DriveReport& report = history.At(due_ns).value;
    side.report.due_ns = std::min(side.report.due_ns, report.due_ns);
    if (side.report.bus_ok && !report.bus_ok) side.troubles.lost = {bus, report.fault};
    if (side.report.drive_ok && !report.drive_ok) side.troubles.drive = {bus, report.fault};
    side.report.bus_ok = side.report.bus_ok && report.bus_ok;
    side.report.drive_ok = side.report.drive_ok && report.drive_ok;
    side.report.levels = MergeRedundantLevels(side.report.levels, report.levels);
    side.report.voltage = Joined(side.report.voltage, report.voltage);
    side.report.power = Joined(side.report.power, report.power);
    if (report.failed_in_window > side.report.failed_in_window) {
      side.report.failed_in_window = report.failed_in_window;
      side.troubles.unreliable = {bus, report.fault};
    }
    if (report.slow_in_window > side.report.slow_in_window) {
      side.report.slow_in_window = report.slow_in_window;
      side.troubles.slow = {bus, report.fault};
    }
    const std::int64_t alive_ns = history.Newest().value.due_ns;
    if (alive_ns < side.alive_ns) side.troubles.oldest_bus = bus;
    side.alive_ns = std::min(side.alive_ns, alive_ns);
  }
  return side;
}

OperatorRequest SafetyTask::TakeRequest(std::int64_t due_ns, const DriveReport& drives) noexcept {
  acknowledge_ = false;
  Receive();
  const OperatorRequest none{.kind = RequestKind::kNone, .number = 0, .not_before_ns = due_ns};
  if (const std::uint32_t number = channels_.stop->Take(); number != 0) {
    return {.kind = RequestKind::kStop, .number = number, .not_before_ns = due_ns};
  }
  if (const std::uint32_t number = channels_.disarm->Take(); number != 0) {
    return {.kind = RequestKind::kDisarm, .number = number, .not_before_ns = due_ns};
  }
  const bool enabling = status_.state == SafetyState::kArmed && drives.power != DrivePower::kOn &&
                        due_ns - state_since_ns_ <= kEnableNs;
  for (std::size_t i = 0; i < waiting_count_; ++i) {
    const auto& [waits, is_cancelled] = waiting_[i];
    const bool cancelled = is_cancelled;
    if (!cancelled) {
      if (waits.not_before_ns > due_ns) continue;
      if (enabling && waits.kind == RequestKind::kRun) continue;
      if (Acknowledges(waits, due_ns, drives)) continue;
    }
    const OperatorRequest request = waits;
    Waiting* const place = waiting_.data() + i;
    std::copy(place + 1, waiting_.data() + waiting_count_, place);
    --waiting_count_;
    if (!cancelled) return request;
    Answer(request, Refusal::kCancelled, status_.state, last_facts_.present);
    return none;
  }
  return none;
}

// One in a tick, like those that are judged: what others ask for does not make a tick longer.
void SafetyTask::Receive() noexcept {
  if (waiting_count_ == kMaxWaiting) return;
  Waiting& received = waiting_[waiting_count_];
  if (!channels_.requests->Pop(&received.request)) return;
  ++waiting_count_;
  received.cancelled = queued_ > 0 && IsCancelled(received.request, cancelled_below_);
  if (queued_ > 0) --queued_;
}

// Those that are still in the queue came before, too.
void SafetyTask::CancelBelow(std::uint32_t number) noexcept {
  for (std::size_t i = 0; i < waiting_count_; ++i) {
    if (IsCancelled(waiting_[i].request, number)) waiting_[i].cancelled = true;
  }
  // While some from before an earlier stop or trip are left, the higher number holds.
  cancelled_below_ = queued_ == 0 ? number : std::max(cancelled_below_, number);
  queued_ = channels_.requests->size();
}

// Only a reset that nothing but the drives stands in the way of: a cause that the operator can
// remove, or a button that was not pressed, refuses it before any fault is acknowledged.
bool SafetyTask::Acknowledges(const OperatorRequest& reset, std::int64_t due_ns,
                              const DriveReport& drives) noexcept {
  if (reset.kind != RequestKind::kReset || status_.state != SafetyState::kTripped) return false;
  const bool faulty = !drives.drive_ok || !drives.bus_ok;
  const bool others = (last_facts_.present & ~kDriveSideCauses) != 0;
  if (acknowledging_ != reset.number) {
    if (!faulty || others || last_facts_.reset_pressed == 0) return false;
    acknowledging_ = reset.number;
    acknowledging_since_ns_ = due_ns;
  }
  const bool well = !faulty && last_facts_.present == 0 && last_facts_.at_rest != 0;
  if (well || others || due_ns - acknowledging_since_ns_ > kAcknowledgeNs) return false;
  acknowledge_ = faulty;
  return true;
}

void SafetyTask::Enter(const SafetyStatus& next, const SafetyInputs& in,
                       const OperatorRequest& request) noexcept {
  if (next == status_) return;
  if (next.state != status_.state) {
    state_since_ns_ = in.due_ns;
    if (next.state == SafetyState::kRunning) {
      running_since_ns_ = in.due_ns;
      run_number_ = request.number;
      run_ = request.run;
      change_ = {};
    }
  }
  if (!CauseLatched(next.state)) {
    evidence_ = {};
  } else if (!CauseLatched(status_.state)) {
    evidence_ = monitor_.EvidenceOf(next.cause, in);
  }
  status_ = next;
}

// Of the tests of the power path, which have ended.
Refusal SafetyTask::RefusalOfArm(const SafetyFacts& facts) const noexcept {
  if (status_.state == SafetyState::kArmed) return Refusal::kNone;
  if (CauseLatched(status_.state)) return Refusal::kUnhealthy;
  if (facts.shutting_down != 0) return Refusal::kShuttingDown;
  return facts.at_rest == 0 ? Refusal::kNotAtRest : Refusal::kCancelled;
}

void SafetyTask::Drive(std::int64_t due_ns) noexcept {
  // The charge pump of the test before must have died away: never both while one is tested.
  const bool pump_dies = status_.state == SafetyState::kTestingRelay &&
                         due_ns - state_since_ns_ < 2 * SafetyLines::kPumpTimeoutNs;
  const bool closed = RelayClosed(status_.state) && !pump_dies;
  pump_level_ = PumpRuns(status_.state) && !pump_level_;
  written_ = channels_.lines->Write(due_ns, {.relay_closed = closed, .pump_level = pump_level_});
}

void SafetyTask::PublishPresent(TripCauses causes, const SafetyInputs& in) noexcept {
  if (causes == 0 && present_.causes == 0) return;
  present_.causes = causes;
  for (TripCauses left = causes; left != 0; left &= left - 1) {
    const auto number = static_cast<std::size_t>(std::countr_zero(left));
    present_.evidence[number] = monitor_.EvidenceOf(static_cast<TripCause>(number), in);
  }
  channels_.present->Publish(present_);
}

void SafetyTask::Publish(std::int64_t due_ns, LineLevels levels) noexcept {
  permits_.Push(due_ns, {.state = status_.state,
                         .cause = status_.cause,
                         .renewed_ns = due_ns,
                         .running_since_ns = running_since_ns_,
                         .evidence = evidence_,
                         .levels = levels,
                         .run_number = run_number_,
                         .run = run_,
                         .change = change_,
                         .reduced = reduced_,
                         .acknowledge = acknowledge_});
  for (PermitChannel* channel : channels_.permits) channel->PublishGrown(permits_);
  if (timing_ == monitor_.timing()) return;
  timing_ = monitor_.timing();
  channels_.timing->Publish(timing_);
}

}  // namespace flexarm
