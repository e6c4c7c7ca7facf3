#include "controller/operator/state_journal.h"

#include <utility>

#include "controller/operator/trip_channel.h"

namespace flexarm {

StateJournal::StateJournal(const LoopStack* stack, const SensorConfig* sensors, EventQueue* events,
                           JournalReport report)
    : stack_(stack), sensors_(sensors), events_(events), report_(std::move(report)) {}

void StateJournal::Follow(std::int64_t now_ns, const Permit& permit) {
  if (permit.state == state_) return;
  const bool tripped = CauseLatched(permit.state) && !CauseLatched(state_);
  std::string text = std::string(ToString(state_)) + " -> " + ToString(permit.state);
  state_ = permit.state;
  if (tripped) {
    const std::string of_bus = stack_->BusText(permit.cause, permit.evidence);
    text += TripText(permit, of_bus);
    if (!of_bus.empty()) {
      events_->Push({.time_ns = now_ns,
                     .kind = "bus",
                     .name = ToString(permit.cause),
                     .text = of_bus,
                     .value_json = {}});
    }
  }
  report_(tripped, text);
}

std::string StateJournal::TripText(const Permit& permit, const std::string& of_bus) const {
  const Evidence& evidence = permit.evidence;
  const std::string channel = TripChannelName(permit.cause, evidence.channel, *sensors_);
  const std::string details = of_bus.empty()
                                  ? " (value " + std::to_string(evidence.value) + ", limit " +
                                        std::to_string(evidence.limit) + "). "
                                  : ": " + of_bus + ". ";
  return std::string(": ") + ToString(permit.cause) + (channel.empty() ? "" : ": " + channel) +
         details + OperatorText(permit.cause);
}

}  // namespace flexarm
