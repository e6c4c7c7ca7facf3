#include "controller/safety/safety_machine.h"

namespace flexarm {
namespace {

const char* WrongStateText(RequestKind request, SafetyState state) noexcept {
  using enum SafetyState;
  if (state == kStarting) return "The daemon is still starting. Try again in a moment.";
  if (state == kTripped && request != RequestKind::kReset) {
    return "The arm has tripped. Remove the cause, press the reset button, then `flexarm reset`.";
  }
  switch (request) {
    case RequestKind::kNone:
      break;
    case RequestKind::kArm:
      return "The arm is armed already.";
    case RequestKind::kRun:
      return state == kIdle ? "The arm is not armed. First `flexarm arm`."
                            : "An experiment is running. First `flexarm stop`, and wait for Armed.";
    case RequestKind::kStop:
      return "Nothing is running that could be stopped.";
    case RequestKind::kDisarm:
      return state == kIdle ? "The arm is not armed."
                            : "An experiment is running. First `flexarm stop`, and wait for Armed.";
    case RequestKind::kReset:
      return "Nothing has tripped: there is nothing to reset.";
  }
  return "The daemon does not know this request.";
}

}  // namespace

const char* Name(RequestKind request) noexcept {
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
  }
  return "corrupted";
}

const char* Name(Refusal refusal) noexcept {
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
      return "The arm moves. Wait until it is at rest, then ask again.";
    case Refusal::kCauseRemains:
      return "A cause of a trip is still present: see `flexarm status`. Remove it, then ask again.";
    case Refusal::kNoReset:
      return "The reset button has not been pressed since the trip. Press it at the rig, then ask "
             "again.";
    case Refusal::kUnhealthy:
      return "A cause of a trip is present, or a task has not reported yet: see `flexarm status`.";
    case Refusal::kCancelled:
      return "A stop, a disarm or a trip came before this planned request. Ask again.";
  }
  return "The daemon gave a refusal that is not known here.";
}

}  // namespace flexarm
