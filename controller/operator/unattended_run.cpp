#include "controller/operator/unattended_run.h"

#include <algorithm>

#include "controller/runlog/run_recording.h"

namespace flexarm {

OperatorRequest UnattendedRun::Ask(RequestKind kind, std::int64_t not_before_ns) noexcept {
  if (asked_ == kind) return {.kind = RequestKind::kNone, .number = 0, .not_before_ns = 0};
  asked_ = kind;
  OperatorRequest request{.kind = kind, .number = ++number_, .not_before_ns = not_before_ns};
  if (kind == RequestKind::kRun) request.run.experiment = experiment_;
  return request;
}

OperatorRequest UnattendedRun::Update(std::int64_t due_ns, const Permit& permit) noexcept {
  const OperatorRequest request = NextRequest(due_ns, permit);
  if (permit.state == SafetyState::kTripped && trip_ == TripCause::kNone) {
    trip_ = permit.cause;
    over_ns_ = due_ns + kAfterTripNs;
  } else if (over() && over_ns_ == INT64_MAX) {
    over_ns_ = due_ns + settle_ns_;
  }
  return request;
}

OperatorRequest UnattendedRun::NextRequest(std::int64_t due_ns, const Permit& permit) noexcept {
  const std::int64_t soon_ns = due_ns + kLeadNs;
  if (!over()) {
    switch (permit.state) {
      case SafetyState::kStarting:
        break;
      case SafetyState::kIdle:
        if (!ran_) return Ask(RequestKind::kArm, std::max(soon_ns, kFirstArmNs));
        progress_ = Progress::kDone;
        break;
      case SafetyState::kArmed:
        if (!ran_) return Ask(RequestKind::kRun, soon_ns);
        progress_ = Progress::kDisarming;
        return Ask(RequestKind::kDisarm, soon_ns);
      case SafetyState::kFaultStopping:
      case SafetyState::kDisarming:
      case SafetyState::kTestingPump:
      case SafetyState::kTestingRelay:
      case SafetyState::kTestingPower:
        break;  // ends by itself
      case SafetyState::kRunning:
      case SafetyState::kStopping:
        progress_ = Progress::kRunning;
        ran_ = true;
        break;
      case SafetyState::kTripped:
        progress_ = Progress::kDone;
        break;
    }
  }
  return {.kind = RequestKind::kNone, .number = 0, .not_before_ns = 0};
}

void UnattendedRun::Answered(const RequestAnswer& answer) noexcept {
  if (answer.number == number_ && answer.refusal != Refusal::kNone && !over()) {
    progress_ = Progress::kRefused;
  }
}

}  // namespace flexarm
