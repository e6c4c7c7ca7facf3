#include "controller/types/trip_cause.h"

#include <array>

namespace flexarm {
namespace {

struct Texts {
  const char* name;
  const char* text;
};

constexpr std::array<Texts, kTripCauses> kTexts{{
    {"none", "Nothing tripped."},
    {"limit-switch-1-low",
     "The low limit switch of joint 1 opened, or its wire is cut. Move joint 1 back by hand, or "
     "check the wire; then press the reset button and reset."},
    {"limit-switch-1-high",
     "The high limit switch of joint 1 opened, or its wire is cut. Move joint 1 back by hand, or "
     "check the wire; then press the reset button and reset."},
    {"limit-switch-2-low",
     "The low limit switch of joint 2 opened, or its wire is cut. Move joint 2 back by hand, or "
     "check the wire; then press the reset button and reset."},
    {"limit-switch-2-high",
     "The high limit switch of joint 2 opened, or its wire is cut. Move joint 2 back by hand, or "
     "check the wire; then press the reset button and reset."},
    {"emergency-stop",
     "The emergency stop was pressed, or its wire is cut. Make the arm safe, release it; then "
     "press "
     "the reset button and reset."},
    {"soft-limit-1",
     "Joint 1 left its permitted angles. Move it back by hand; check the experiment and the zero "
     "of "
     "its encoder."},
    {"soft-limit-2",
     "Joint 2 left its permitted angles. Move it back by hand; check the experiment and the zero "
     "of "
     "its encoder."},
    {"hub-rate-1",
     "Hub 1 turned faster than permitted on two ticks. Check the experiment, the payload and the "
     "gains."},
    {"hub-rate-2",
     "Hub 2 turned faster than permitted on two ticks. Check the experiment, the payload and the "
     "gains."},
    {"bending-strain-1",
     "Link 1 bent more than permitted. Look for a collision; check the experiment and the "
     "payload."},
    {"bending-strain-2",
     "Link 2 bent more than permitted. Look for a collision; check the experiment and the "
     "payload."},
    {"encoder-jump",
     "An encoder moved further in one sample than the arm can. Check its cable and its coupling."},
    {"hub-against-rotor",
     "Hub and rotor encoder of one joint disagree by more than its spring can wind. Check "
     "coupling, "
     "gearbox and both encoders."},
    {"strain-stuck",
     "A strain channel repeats the same value. Check its amplifier and its cable, or take it out "
     "of "
     "the configuration."},
    {"strain-saturated",
     "A strain channel is at the end of its range. Check its gain, its balance and its cable."},
    {"strain-out-of-family",
     "A strain channel disagrees with the others of its link. Check the gauge and its cable, or "
     "tare "
     "again."},
    {"no-counter-reading",
     "No good encoder reading for two periods. Check the counter board and its bus."},
    {"stale-frame",
     "The measurements stopped coming: the drive side or the simulated plant stands still. Check "
     "the "
     "bus and the load of the machine."},
    {"bus-lost", "A bus to the rig does not answer. Check its cable, its power and its interface."},
    {"drive-fault",
     "A drive reports a fault. Read its fault code, remove the reason and acknowledge it there."},
    {"missed-deadlines",
     "The controller missed too many deadlines in a row. Run `flexarm check-host`; take load off "
     "the "
     "machine."},
    {"control-heartbeat-lost",
     "The control thread stopped reporting. Reset works only when it runs again: restart the "
     "daemon "
     "and report the log."},
    {"state-not-finite",
     "The controller's state is not a finite number, or the safety state was corrupted. Restart "
     "the "
     "daemon and report the log."},
    {"estimator-residual",
     "The measurements do not fit the model of the arm. Check payload, gauges and configuration."},
    {"stop-timeout",
     "The arm did not come to rest in the time allowed for stopping. Let it come to rest; check "
     "the "
     "gains and the rest limits."},
}};

static_assert(kTexts.back().name != nullptr, "every cause has its texts");

}  // namespace

const char* Name(TripCause cause) noexcept {
  const auto index = static_cast<std::size_t>(cause);
  return index < kTexts.size() ? kTexts[index].name : "corrupted";
}

const char* OperatorText(TripCause cause) noexcept {
  const auto index = static_cast<std::size_t>(cause);
  return index < kTexts.size()
             ? kTexts[index].text
             : "The number of the cause is corrupted. Restart the daemon and report the log.";
}

}  // namespace flexarm
