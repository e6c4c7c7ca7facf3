#include "controller/types/trip_cause.h"

#include <array>

namespace flexarm {
namespace {

struct Texts {
  const char* name;
  const char* text;
};

constexpr std::array<Texts, kTripCauses> kTexts{{
    {"none", "No trip has occurred."},
    {"limit-switch-1-low",
     "The low limit switch of joint 1 is open: the joint has reached it, or its wire is cut. Move "
     "the joint back by hand or repair the wire; then press the reset button and run `flexarm "
     "reset`."},
    {"limit-switch-1-high",
     "The high limit switch of joint 1 is open: the joint has reached it, or its wire is cut. Move "
     "the joint back by hand or repair the wire; then press the reset button and run `flexarm "
     "reset`."},
    {"limit-switch-2-low",
     "The low limit switch of joint 2 is open: the joint has reached it, or its wire is cut. Move "
     "the joint back by hand or repair the wire; then press the reset button and run `flexarm "
     "reset`."},
    {"limit-switch-2-high",
     "The high limit switch of joint 2 is open: the joint has reached it, or its wire is cut. Move "
     "the joint back by hand or repair the wire; then press the reset button and run `flexarm "
     "reset`."},
    {"emergency-stop",
     "The emergency stop was pressed, or its wire is cut. Make the arm safe and release the "
     "emergency stop; then press the reset button and run `flexarm reset`."},
    {"soft-limit-1",
     "The angle of joint 1 is beyond limits.soft_angle_deg. Move the joint back by hand; check the "
     "experiment and the zero of the encoder."},
    {"soft-limit-2",
     "The angle of joint 2 is beyond limits.soft_angle_deg. Move the joint back by hand; check the "
     "experiment and the zero of the encoder."},
    {"hub-rate-1",
     "Hub 1 turned faster than limits.hub_rate_rad_s on two ticks. Check the experiment, the "
     "payload and the gains."},
    {"hub-rate-2",
     "Hub 2 turned faster than limits.hub_rate_rad_s on two ticks. Check the experiment, the "
     "payload and the gains."},
    {"bending-strain-1",
     "The strain at the root of link 1 exceeded limits.strain_limit. Check the arm for a "
     "collision; check the experiment and the payload."},
    {"bending-strain-2",
     "The strain at the root of link 2 exceeded limits.strain_limit. Check the arm for a "
     "collision; check the experiment and the payload."},
    {"encoder-jump",
     "An encoder moved further in one sample than the arm can. Its angle is unreliable. Check its "
     "cable and its coupling."},
    {"hub-against-rotor",
     "The hub encoder and the rotor encoder of one joint differ by more than the joint spring can "
     "twist. Check the coupling, the gearbox and both encoders."},
    {"strain-stuck",
     "A strain channel repeats the same value. Check its amplifier and its cable, or remove the "
     "channel from the configuration."},
    {"strain-saturated",
     "A strain channel is at the end of its range. Check its gain, its balance and its cable."},
    {"strain-out-of-family",
     "A strain channel disagrees with the other channels of its link. Check the gauge and its "
     "cable, or run `flexarm tare`."},
    {"no-counter-reading",
     "No valid encoder reading arrived for two periods. Check the counter board and its bus."},
    {"stale-frame",
     "The measurements are too old: the drive side or the simulated plant has stopped. Check the "
     "bus and the load of the computer."},
    {"bus-lost",
     "A bus to the rig does not answer. Check its cable, its power supply and its interface."},
    {"drive-fault",
     "A drive reports a fault or has left operation. Read its fault code, remove the cause and "
     "acknowledge the fault at the drive."},
    {"missed-deadlines",
     "The controller missed several deadlines in a row: the computer ran it too late. Check that "
     "the kernel is PREEMPT_RT and that the cores are isolated, and remove other load from the "
     "computer; see docs/timing.md."},
    {"control-heartbeat-lost",
     "The control thread stopped reporting. A reset is possible only while it runs: restart the "
     "daemon and report the log."},
    {"state-not-finite",
     "The state of the controller is not a finite number, or the safety state is corrupted. "
     "Restart the daemon and report the log."},
    {"estimator-residual",
     "The measurements do not fit the model of the arm. Check the payload, the gauges and the "
     "configuration."},
    {"stop-timeout",
     "The arm did not come to rest within safety.stop_timeout_s. Wait until it is at rest; check "
     "the gains and the rest limits."},
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
             : "The number of the trip cause is corrupted. Restart the daemon and report the log.";
}

}  // namespace flexarm
