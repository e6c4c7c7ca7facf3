#include "tools/torture/disturbed_executor.h"

#include <algorithm>
#include <functional>

#include "controller/realtime/float_environment.h"
#include "controller/realtime/wakeup.h"

namespace flexarm {
namespace {

constexpr std::int64_t kPauseNs = 200'000'000;  // of a stuck thread
constexpr double kDriftShare = 5e-3;            // a drifting thread is 5 ms later every second

}  // namespace

DisturbedExecutor::DisturbedExecutor(const WakeUps& wake_ups, const std::vector<Fault>& faults,
                                     std::int64_t end_ns)
    : wake_ups_(wake_ups), faults_(&faults), random_(wake_ups.seed) {
  for (int i = 0; i < wake_ups.order_changes; ++i) {
    const auto after = static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(end_ns));
    changes_.push_back(wake_ups.start_ns + after);
  }
  std::sort(changes_.begin(), changes_.end(), std::greater<>());
}

void DisturbedExecutor::Add(Task& task, std::optional<FaultPlace> place) {
  const Task::Traits traits = task.traits();
  slots_.push_back({.task = &task,
                    .traits = traits,
                    .place = place,
                    .due_ns = wake_ups_.start_ns + traits.phase_ns,
                    .wake_ns = 0,
                    .missed_in_a_row = 0,
                    .rank = random_()});
  slots_.back().wake_ns = WakeOf(slots_.back());
}

void DisturbedExecutor::DrawRanks() {
  for (Slot& slot : slots_) slot.rank = random_();
}

std::int64_t DisturbedExecutor::WakeOf(const Slot& slot) {
  const std::int64_t latest_ns =
      slot.traits.priority > 0 ? wake_ups_.latest_ns : wake_ups_.latest_slow_ns;
  const std::uint64_t drawn = random_();
  std::int64_t wake_ns = slot.due_ns;
  if (latest_ns > 0) {
    wake_ns += static_cast<std::int64_t>(drawn % static_cast<std::uint64_t>(latest_ns));
  }
  for (const Fault& fault : *faults_) {
    if (fault.place != slot.place || !IsActive(fault, slot.due_ns)) continue;
    const std::int64_t period_ns = slot.traits.period_ns;
    switch (fault.kind) {
      case FaultKind::kOff:
        return std::max(wake_ns, fault.to_ns);
      case FaultKind::kStuck:
        wake_ns = std::max(wake_ns, fault.from_ns + kPauseNs);
        break;
      case FaultKind::kLate:
        wake_ns += period_ns;
        break;
      case FaultKind::kDelayed:
        wake_ns += 3 * period_ns;
        break;
      case FaultKind::kSlow:
        wake_ns += static_cast<std::int64_t>(drawn % static_cast<std::uint64_t>(2 * period_ns));
        break;
      case FaultKind::kIntermittent:
        if (drawn % 2 == 0) wake_ns += period_ns;
        break;
      case FaultKind::kDrifting:
        wake_ns += static_cast<std::int64_t>(kDriftShare *
                                             static_cast<double>(slot.due_ns - fault.from_ns));
        break;
      case FaultKind::kGarbage:
      case FaultKind::kNotANumber:
      case FaultKind::kWrongScale:
        break;  // not of a thread
    }
  }
  return wake_ns;
}

// As RealtimeExecutor::Loop.
void DisturbedExecutor::RunSlot(Slot* slot) {
  const std::int64_t woke_ns = slot->wake_ns;
  const std::int64_t behind = (woke_ns - slot->due_ns) / slot->traits.period_ns;
  slot->due_ns += behind * slot->traits.period_ns;
  slot->missed_in_a_row += static_cast<int>(behind);
  const bool guarded = guard_ != nullptr && slot->traits.priority > 0;
  if (guarded) guard_->Enter();
  slot->task->Run({.due_ns = slot->due_ns,
                   .missed_in_a_row = slot->missed_in_a_row,
                   .late_ns = woke_ns - slot->due_ns});
  if (guarded) guard_->Leave();
  const bool is_missed = woke_ns > slot->due_ns + slot->traits.deadline_ns;
  slot->missed_in_a_row = is_missed ? slot->missed_in_a_row + 1 : 0;
  slot->due_ns += slot->traits.period_ns;
  slot->wake_ns = std::max(WakeOf(*slot), woke_ns);
}

void DisturbedExecutor::TakeWakeups(std::int64_t now_ns) {
  for (Slot& slot : slots_) {
    Wakeup* wakeup = slot.task->wakeup();
    if (wakeup != nullptr && wakeup->Take()) slot.task->Woken(now_ns);
  }
}

void DisturbedExecutor::Release(std::int64_t now_ns) {
  for (Slot& slot : slots_) {
    if (slot.wake_ns > slot.due_ns) slot.wake_ns = std::max(slot.due_ns, now_ns);
  }
}

void DisturbedExecutor::RunUntil(std::int64_t end_ns) {
  const FlushDenormals flush;
  for (;;) {
    const auto next =
        std::min_element(slots_.begin(), slots_.end(), [](const Slot& a, const Slot& b) {
          return a.wake_ns != b.wake_ns ? a.wake_ns < b.wake_ns : a.rank < b.rank;
        });
    if (next == slots_.end() || next->wake_ns >= end_ns) return;
    const std::int64_t now_ns = next->wake_ns;
    while (!changes_.empty() && changes_.back() <= now_ns) {
      changes_.pop_back();
      DrawRanks();
    }
    RunSlot(&*next);
    TakeWakeups(now_ns);
  }
}

}  // namespace flexarm
