#include "controller/safety/safety_machine.h"

namespace flexarm {
namespace {

const char* WrongStateText(RequestKind request, SafetyState state) noexcept {
  using enum SafetyState;
  if (state == kStarting) return "The daemon is still starting. Try again in a moment.";
  if (CauseLatched(state) && request != RequestKind::kReset) {
    return "The arm has tripped. Remove the cause, press the reset button, then run `flexarm "
           "reset`.";
  }
  if (state == kFaultStopping) return "The arm is being stopped. Try again in a second.";
  if (TestsPower(state)) return "The arm is being armed. Try again in a moment.";
  if (state == kDisarming) return "The arm is being disarmed. Try again in a moment.";
  switch (request) {
    case RequestKind::kNone:
      break;
    case RequestKind::kArm:
      return "The arm is already armed.";
    case RequestKind::kRun:
      return state == kIdle
                 ? "The arm is not armed. Run `flexarm arm` first."
                 : "An experiment is running. Run `flexarm stop` first and wait for Armed.";
    case RequestKind::kStop:
      return "No experiment is running.";
    case RequestKind::kDisarm:
      return state == kIdle
                 ? "The arm is not armed."
                 : "An experiment is running. Run `flexarm stop` first and wait for Armed.";
    case RequestKind::kReset:
      return "There is no trip to reset.";
    case RequestKind::kChange:
      return "No experiment is running.";
  }
  return "Unknown request.";
}

}  // namespace

const char* ToString(RequestKind request) noexcept {
  switch (request) {
    case RequestKind::kNone:
      return "none";
    case RequestKind::kArm:
      return "arm";
    case RequestKind::kRun:
      return "run";
    case RequestKind::kStop:
      return "stop";
    case RequestKind::kDisarm:
      return "disarm";
    case RequestKind::kReset:
      return "reset";
    case RequestKind::kChange:
      return "change";
  }
  return "corrupted";
}

const char* ToString(Refusal refusal) noexcept {
  switch (refusal) {
    case Refusal::kNone:
      return "none";
    case Refusal::kWrongState:
      return "wrong-state";
    case Refusal::kNotAtRest:
      return "not-at-rest";
    case Refusal::kCauseRemains:
      return "cause-remains";
    case Refusal::kNoReset:
      return "no-reset";
    case Refusal::kUnhealthy:
      return "unhealthy";
    case Refusal::kCancelled:
      return "cancelled";
    case Refusal::kBusy:
      return "busy";
    case Refusal::kShuttingDown:
      return "shutting-down";
    case Refusal::kDrivesOff:
      return "drives-off";
    case Refusal::kNotKept:
      return "not-kept";
    case Refusal::kTooLate:
      return "too-late";
    case Refusal::kRelayClosed:
      return "relay-closed";
  }
  return "corrupted";
}

const char* RefusalText(RequestKind request, Refusal refusal, SafetyState state) noexcept {
  switch (refusal) {
    case Refusal::kNone:
      return "";
    case Refusal::kWrongState:
      return WrongStateText(request, state);
    case Refusal::kNotAtRest:
      return "The arm is moving. Wait until it is at rest, then repeat the request.";
    case Refusal::kCauseRemains:
      return "A cause of a trip is still present: see `flexarm status`. Remove it, then repeat the "
             "request.";
    case Refusal::kNoReset:
      return "The reset button has not been pressed since the trip. Press it at the rig for 50 ms "
             "or longer, then "
             "repeat the request.";
    case Refusal::kUnhealthy:
      return "A cause of a trip is present, or a task has not reported yet: see `flexarm status`.";
    case Refusal::kCancelled:
      return "A stop, a disarm or a trip cancelled this planned request. Repeat the request.";
    case Refusal::kBusy:
      return "Another arm, run or reset has not been answered yet. Repeat the request.";
    case Refusal::kShuttingDown:
      return "The daemon is shutting down. Start it again first.";
    case Refusal::kTooLate:
      return "The change was planned too late for this run, or the run has ended. Repeat the "
             "command.";
    case Refusal::kRelayClosed:
      return "Relay and charge pump are off, but the relay's mirror contact or the drives' voltage "
             "does not say that the power is off. A relay needs 0.1 s, the voltage "
             "hal.gpiod.drive_voltage.fall_ms: repeat the request then. If it is refused again, "
             "the "
             "relay is welded or the wire of its contact is cut: switch the power off and repair "
             "it.";
    case Refusal::kDrivesOff:
      return "The drives have not confirmed that they are on. Check their supply and their "
             "display, then repeat the request.";
    case Refusal::kNotKept:
      return "The daemon could not write to its state folder, so a trip would not survive a "
             "restart. Make room or give permission there, then repeat the request.";
  }
  return "Unknown reason of refusal.";
}

}  // namespace flexarm
