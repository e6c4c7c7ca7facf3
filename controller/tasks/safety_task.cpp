#include "controller/tasks/safety_task.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace flexarm {
namespace {

using FactBytes = std::array<std::uint8_t, sizeof(SafetyFacts)>;

bool SameFacts(const SafetyFacts& a, const SafetyFacts& b) noexcept {
  return std::bit_cast<FactBytes>(a) == std::bit_cast<FactBytes>(b);
}

bool RaisesEnergy(RequestKind kind) noexcept {
  return kind == RequestKind::kArm || kind == RequestKind::kRun;
}

}  // namespace

SafetyTask::SafetyTask(const MonitorLimits& limits, SafetyChannels channels)
    : channels_(std::move(channels)), monitor_(limits) {}

Task::Traits SafetyTask::traits() const noexcept {
  return {.name = "safety",
          .period_ns = kPeriodNs,
          .phase_ns = 0,
          .deadline_ns = kPeriodNs,
          .priority = kPriority};
}

void SafetyTask::Run(const Activation& activation) noexcept {
  const std::int64_t due_ns = activation.due_ns;
  const ControlReportHistory& control = channels_.control->Read();
  const DriveSide drive = ReadDrives(due_ns);
  const LineLevels levels =
      MergeRedundantLevels(channels_.lines->Read(due_ns), drive.report.levels);
  const auto [requested, request, earlier] = TakeRequest(due_ns);

  const SafetyInputs in{.due_ns = due_ns,
                        .levels = levels,
                        .control = control.At(due_ns).value,
                        .control_alive_ns = control.Newest().value.due_ns,
                        .drive = drive.report,
                        .drive_alive_ns = drive.alive_ns,
                        .troubles = drive.troubles,
                        .request = request.kind,
                        .state = status_.state,
                        .state_since_ns = state_since_ns_,
                        .running_since_ns = running_since_ns_,
                        .may_open = may_open_};
  const SafetyFacts facts = monitor_.Judge(in);
  const SafetyStatus before = status_;
  const SafetyDecision decision = NextSafetyState(before, facts);
  Enter(decision.status, in);
  if (decision.status.state != before.state) {
    may_open_ = decision.status.state == SafetyState::kRunning ? request.may_open : 0;
  }
  Drive(due_ns);
  Publish(due_ns, levels);

  const bool tripped = status_ != before && status_.state == SafetyState::kTripped;
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
  if (requested) {
    channels_.answers->Push({.number = request.number,
                             .kind = request.kind,
                             .refusal = decision.refusal,
                             .state = before.state,
                             .present = facts.present});
  }
  if (tripped) {
    CancelPlanned(waiting_count_, facts.present);
  } else if (request.kind == RequestKind::kStop || request.kind == RequestKind::kDisarm) {
    CancelPlanned(earlier, facts.present);
  }
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
    const std::int64_t alive_ns = history.Newest().value.due_ns;
    if (alive_ns < side.alive_ns) side.troubles.oldest_bus = bus;
    side.alive_ns = std::min(side.alive_ns, alive_ns);
  }
  return side;
}

SafetyTask::Taken SafetyTask::TakeRequest(std::int64_t due_ns) noexcept {
  while (waiting_count_ < kMaxWaiting && channels_.requests->Pop(&waiting_[waiting_count_])) {
    ++waiting_count_;
  }
  for (std::size_t i = 0; i < waiting_count_; ++i) {
    if (waiting_[i].not_before_ns > due_ns) continue;
    const Taken taken{.any = true, .request = waiting_[i], .earlier = i};
    --waiting_count_;
    for (std::size_t k = i; k < waiting_count_; ++k) waiting_[k] = waiting_[k + 1];
    return taken;
  }
  return Taken{};
}

void SafetyTask::CancelPlanned(std::size_t first, TripCauses present) noexcept {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < waiting_count_; ++i) {
    const OperatorRequest& planned = waiting_[i];
    if (i < first && RaisesEnergy(planned.kind)) {
      channels_.answers->Push({.number = planned.number,
                               .kind = planned.kind,
                               .refusal = Refusal::kCancelled,
                               .state = status_.state,
                               .present = present});
    } else {
      waiting_[kept++] = planned;
    }
  }
  waiting_count_ = kept;
}

void SafetyTask::Enter(const SafetyStatus& next, const SafetyInputs& in) noexcept {
  if (next == status_) return;
  if (next.state != status_.state) {
    state_since_ns_ = in.due_ns;
    if (next.state == SafetyState::kRunning) running_since_ns_ = in.due_ns;
  }
  evidence_ =
      next.state == SafetyState::kTripped ? monitor_.EvidenceOf(next.cause, in) : Evidence{};
  status_ = next;
}

void SafetyTask::Drive(std::int64_t due_ns) noexcept {
  const bool closed = Powered(status_.state);
  pump_level_ = closed && !pump_level_;
  channels_.lines->Write(due_ns, {.relay_closed = closed, .pump_level = pump_level_});
}

void SafetyTask::Publish(std::int64_t due_ns, LineLevels levels) noexcept {
  permits_.Push(due_ns, {.state = status_.state,
                         .cause = status_.cause,
                         .renewed_ns = due_ns,
                         .running_since_ns = running_since_ns_,
                         .evidence = evidence_,
                         .levels = levels});
  for (PermitChannel* channel : channels_.permits) channel->Publish(permits_);
}

}  // namespace flexarm
