#include "controller/types/trip_cause.h"

#include <array>
#include <string>

#include "controller/types/trip_advice.h"

namespace flexarm {
namespace {

struct Row {
  TripCause cause;
  const char* name;
  TripChannel channel;
  TripAdvice advice;
};

using enum TripCause;
constexpr TripChannel kJoint = TripChannel::kJoint, kStrain = TripChannel::kStrain,
                      kCounter = TripChannel::kCounter, kBus = TripChannel::kBus,
                      kLineTrouble = TripChannel::kLineTrouble;

// All that is said of a cause, in the order of their numbers. A new cause has its number in the
// header, its row here, and the code that detects it.
constexpr std::array<Row, kTripCauses> kRows{{
    {TripCause::kNone, "none", TripChannel::kNone, {"No trip has occurred.", "", ""}},
    {kLimitSwitch1Low,
     "limit-switch-1-low",
     kJoint,
     {"The low limit switch of joint 1 is open: the joint has reached it, or its wire is cut.",
      "Look where the joint stands: if it is not at the switch, measure the switch and its wire.",
      "Move the joint back by hand or repair the wire; then press the reset button and run "
      "`flexarm reset`."}},
    {kLimitSwitch1High,
     "limit-switch-1-high",
     kJoint,
     {"The high limit switch of joint 1 is open: the joint has reached it, or its wire is cut.",
      "Look where the joint stands: if it is not at the switch, measure the switch and its wire.",
      "Move the joint back by hand or repair the wire; then press the reset button and run "
      "`flexarm reset`."}},
    {kLimitSwitch2Low,
     "limit-switch-2-low",
     kJoint,
     {"The low limit switch of joint 2 is open: the joint has reached it, or its wire is cut.",
      "Look where the joint stands: if it is not at the switch, measure the switch and its wire.",
      "Move the joint back by hand or repair the wire; then press the reset button and run "
      "`flexarm reset`."}},
    {kLimitSwitch2High,
     "limit-switch-2-high",
     kJoint,
     {"The high limit switch of joint 2 is open: the joint has reached it, or its wire is cut.",
      "Look where the joint stands: if it is not at the switch, measure the switch and its wire.",
      "Move the joint back by hand or repair the wire; then press the reset button and run "
      "`flexarm reset`."}},
    {kEmergencyStop,
     "emergency-stop",
     kJoint,
     {"The emergency stop was pressed, or its wire is cut.",
      "Look whether it is pressed: if it is not, measure its contact and its wire.",
      "Make the arm safe and release the emergency stop; then press the reset button and run "
      "`flexarm reset`."}},
    {kSoftLimit1,
     "soft-limit-1",
     kJoint,
     {"The angle of joint 1 is beyond limits.soft_angle_deg.",
      "Check the experiment and the zero of the encoder.",
      "Move the joint back by hand; if the zero is wrong, run `flexarm zero` first."}},
    {kSoftLimit2,
     "soft-limit-2",
     kJoint,
     {"The angle of joint 2 is beyond limits.soft_angle_deg.",
      "Check the experiment and the zero of the encoder.",
      "Move the joint back by hand; if the zero is wrong, run `flexarm zero` first."}},
    {kHubRate1,
     "hub-rate-1",
     kJoint,
     {"Hub 1 turned faster than limits.hub_rate_rad_s on two ticks.",
      "Check the experiment, the payload and the gains: `flexarm plot` shows the run.",
      "Run slower moves, or design for this payload with `flexarm design`."}},
    {kHubRate2,
     "hub-rate-2",
     kJoint,
     {"Hub 2 turned faster than limits.hub_rate_rad_s on two ticks.",
      "Check the experiment, the payload and the gains: `flexarm plot` shows the run.",
      "Run slower moves, or design for this payload with `flexarm design`."}},
    {kBendingStrain1,
     "bending-strain-1",
     kJoint,
     {"The strain at the root of link 1 exceeded limits.strain_limit.",
      "Check the arm for a collision and for damage; check the experiment and the payload.",
      "Remove the obstacle, or run slower moves with this payload."}},
    {kBendingStrain2,
     "bending-strain-2",
     kJoint,
     {"The strain at the root of link 2 exceeded limits.strain_limit.",
      "Check the arm for a collision and for damage; check the experiment and the payload.",
      "Remove the obstacle, or run slower moves with this payload."}},
    {kEncoderJump,
     "encoder-jump",
     kCounter,
     {"An encoder moved further in one sample than the arm can. Its angle is unreliable.",
      "Check its cable and its coupling.",
      "Repair them, and measure the angle again with `flexarm zero` or `flexarm home`."}},
    {kHubAgainstRotor,
     "hub-against-rotor",
     kJoint,
     {"The hub encoder and the rotor encoder of one joint differ by more than the joint spring can "
      "twist.",
      "Check the coupling, the gearbox and both encoders.",
      "Repair what has slipped, and run `flexarm zero` with the arm at its zero."}},
    {kStrainStuck,
     "strain-stuck",
     kStrain,
     {"A strain channel repeats the same value.", "Check its amplifier and its cable.",
      "Repair them, or remove the channel from the configuration."}},
    {kStrainSaturated,
     "strain-saturated",
     kStrain,
     {"A strain channel is at the end of its range.", "Check its gain, its balance and its cable.",
      "Balance the bridge or lower its gain, and run `flexarm tare`."}},
    {kStrainOutOfFamily,
     "strain-out-of-family",
     kStrain,
     {"A strain channel disagrees with the other channels of its link.",
      "Check the gauge and its cable.",
      "Repair them, or run `flexarm tare` if its zero has drifted."}},
    {kNoCounterReading,
     "no-counter-reading",
     kCounter,
     {"No valid encoder reading arrived for two periods.", "Check the counter board and its bus.",
      "Repair the connection, and repeat the run."}},
    {kStaleFrame,
     "stale-frame",
     kJoint,
     {"The measurements are too old: the drive side or the simulated plant has stopped.",
      "Check the bus and the load of the computer: `flexarm status` shows how late each thread "
      "was.",
      "Repair the bus or remove the load; restart the daemon if the thread has stopped."}},
    {kBusLost,
     "bus-lost",
     kBus,
     {"A bus to the rig does not answer.", "Check its cable, its power supply and its interface.",
      "Restore them; the daemon reconnects while the arm is disarmed."}},
    {kDriveFault,
     "drive-fault",
     kBus,
     {"A drive reports a fault or has left operation.", "Read its fault code.",
      "Remove the cause; `flexarm reset` acknowledges the fault at the drive."}},
    {kMissedDeadlines,
     "missed-deadlines",
     kJoint,
     {"The controller missed several deadlines in a row: the computer ran it too late.",
      "Run `flexarm check-host`; check that the kernel is PREEMPT_RT and that the cores are "
      "isolated.",
      "Remove other load from the computer; see docs/timing.md."}},
    {kControlHeartbeatLost,
     "control-heartbeat-lost",
     kJoint,
     {"The control thread stopped reporting.", "Read the journal of the daemon.",
      "A reset is possible only while it runs: restart the daemon and report the log."}},
    {kStateNotFinite,
     "state-not-finite",
     kJoint,
     {"The state of the controller is not a finite number, or the safety state is corrupted.",
      "Read the journal of the daemon, and replay the log with `flexarm replay`.",
      "Restart the daemon and report the log."}},
    {kEstimatorResidual,
     "estimator-residual",
     kJoint,
     {"The measurements do not fit the model of the arm, or the reading of a hub encoder stands "
      "still or jumps where the model says that the hub turns.",
      "Check the encoder, its cable and its coupling; then the payload, the gauges and the "
      "configuration.",
      "Repair or correct them, or fit the model to a run with `flexarm identify`."}},
    {kStopTimeout,
     "stop-timeout",
     kJoint,
     {"The arm did not come to rest within safety.stop_timeout_s.",
      "Check the gains and the rest limits.", "Wait until it is at rest."}},
    {kEndedWhileArmed,
     "ended-while-armed",
     TripChannel::kNone,
     {"The daemon before this one ended while the arm was armed: it crashed, was killed, or the "
      "computer lost its power.",
      "Check the arm and the journal.", "Then press the reset button and run `flexarm reset`."}},
    {kTripRecordUnreadable,
     "trip-record-unreadable",
     TripChannel::kNone,
     {"The file that keeps a trip over a restart, safety-latch.json in daemon.state_directory, "
      "cannot be read, so the arm may have tripped before.",
      "Check the arm, the disk and the file's permissions.",
      "Then press the reset button and run `flexarm reset`, which removes the file."}},
    {kSafetyLines,
     "safety-lines",
     kLineTrouble,
     {"The lines of the switches, the relay and the charge pump cannot be relied upon: a read or a "
      "write failed or took longer than 0.2 ms, or relay, pump and drive voltage do not agree.",
      "A call: check that the GPIO chip of hal.gpiod is still there (`gpiodetect`), that it is "
      "part of the processor or of a PCI card, and that the kernel is PREEMPT_RT. The rest: switch "
      "the power off; check the relay's contacts, its coil, the wire of its mirror contact, the "
      "charge pump's monostable and the mains.",
      "Repair what failed before the power comes back; see docs/hardware.md."}},
    {kSafetyOverrun,
     "safety-overrun",
     TripChannel::kNone,
     {"The safety thread ran later than safety.overrun_to_trip_ms and did not watch the arm.",
      "Run `flexarm check-host`; check that the kernel is PREEMPT_RT and that the cores are "
      "isolated.",
      "Remove other load from the computer; see docs/timing.md."}},
    {kDeadlinesOftenMissed,
     "deadlines-often-missed",
     TripChannel::kNone,
     {"The controller missed safety.missed_deadlines_in_window of its last deadlines, not in a "
      "row: the computer is too busy.",
      "Run `flexarm check-host`.", "Remove other load from the computer; see docs/timing.md."}},
    {kBusUnreliable,
     "bus-unreliable",
     kBus,
     {"A bus to the rig fails again and again, without being lost.",
      "Check its plugs, its termination, its shielding and its power supply.",
      "Repair them. A reset is possible after good exchanges: see `flexarm status`."}},
    {kBusTooSlow,
     "bus-too-slow",
     kBus,
     {"Exchanges with a bus take longer than its driver declares, so the loop gets its readings "
      "too late.",
      "Check the bus, its interface and the load of the computer.",
      "Remove what delays it; see docs/timing.md."}},
    {kShutdownTimeout,
     "shutdown-timeout",
     TripChannel::kNone,
     {"The arm did not come to rest in time while the daemon was shutting down, so its power was "
      "switched off.",
      "Check the gains and the rest limits.", "Wait until it is at rest."}},
    {kNoStrainReading1,
     "no-strain-reading-1",
     kJoint,
     {"The bending of link 1 is not known: for two samples too few of its gauges gave a good "
      "reading, or those that did are too close together.",
      "Check the amplifier of link 1, its cables and its bus.",
      "Repair them; docs/safety.md says how many gauges may be missing."}},
    {kNoStrainReading2,
     "no-strain-reading-2",
     kJoint,
     {"The bending of link 2 is not known: for two samples too few of its gauges gave a good "
      "reading, or those that did are too close together.",
      "Check the amplifier of link 2, its cables and its bus.",
      "Repair them; docs/safety.md says how many gauges may be missing."}},
    {kFollowingError1,
     "following-error-1",
     kJoint,
     {"Joint 1 is farther from its reference than limits.following_error_deg: the torque does not "
      "act as commanded, or something holds the arm.",
      "Check for an obstacle, then the drive's supply and enable, its torque scale and the motor's "
      "cable; check the payload: `flexarm plot` shows when the joint left its reference.",
      "Remove what holds the arm, or repair the drive."}},
    {kFollowingError2,
     "following-error-2",
     kJoint,
     {"Joint 2 is farther from its reference than limits.following_error_deg: the torque does not "
      "act as commanded, or something holds the arm.",
      "Check for an obstacle, then the drive's supply and enable, its torque scale and the motor's "
      "cable; check the payload: `flexarm plot` shows when the joint left its reference.",
      "Remove what holds the arm, or repair the drive."}},
}};

static_assert(
    [] {
      for (std::size_t i = 0; i < kRows.size(); ++i) {
        if (static_cast<std::size_t>(kRows[i].cause) != i || kRows[i].advice.remedy == nullptr)
          return false;
      }
      return true;
    }(),
    "every cause has its row, in the order of the numbers");

// The parts of each advice in one text. Joined when the program starts, so that OperatorText
// allocates nothing.
const std::array<std::string, kTripCauses> kTexts = [] {
  std::array<std::string, kTripCauses> texts;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const TripAdvice& advice = kRows[i].advice;
    texts[i] = advice.happened;
    for (const char* part : {advice.check, advice.remedy}) {
      if (*part != '\0') texts[i].append(" ").append(part);
    }
  }
  return texts;
}();

}  // namespace

const char* ToString(TripCause cause) noexcept {
  const auto index = static_cast<std::size_t>(cause);
  return index < kRows.size() ? kRows[index].name : "corrupted";
}

TripChannel ChannelOf(TripCause cause) noexcept {
  const auto index = static_cast<std::size_t>(cause);
  return index < kRows.size() ? kRows[index].channel : TripChannel::kNone;
}

const char* OperatorText(TripCause cause) noexcept {
  const auto index = static_cast<std::size_t>(cause);
  return index < kTexts.size()
             ? kTexts[index].c_str()
             : "The number of the trip cause is corrupted. Restart the daemon and report the log.";
}

const char* EvidenceUnit(TripCause cause) noexcept {
  switch (cause) {
    case kLimitSwitch1Low:
    case kLimitSwitch1High:
    case kLimitSwitch2Low:
    case kLimitSwitch2High:
    case kEmergencyStop:
      return "level";
    case kSoftLimit1:
    case kSoftLimit2:
    case kHubAgainstRotor:
    case kEstimatorResidual:
    case kFollowingError1:
    case kFollowingError2:
      return "rad";
    case kHubRate1:
    case kHubRate2:
    case kEncoderJump:
      return "rad/s";
    case kBendingStrain1:
    case kBendingStrain2:
    case kStrainStuck:
    case kStrainOutOfFamily:
      return "strain";
    case kNoCounterReading:
      return "samples";
    case kStaleFrame:
    case kControlHeartbeatLost:
    case kStopTimeout:
    case kSafetyLines:
    case kSafetyOverrun:
    case kShutdownTimeout:
      return "s";
    case kMissedDeadlines:
    case kDeadlinesOftenMissed:
      return "deadlines";
    case kBusUnreliable:
    case kBusTooSlow:
      return "exchanges";
    case kNoStrainReading1:
    case kNoStrainReading2:
      return "gauges";
    case TripCause::kNone:
    case kStrainSaturated:
    case kBusLost:
    case kDriveFault:
    case kStateNotFinite:
    case kEndedWhileArmed:
    case kTripRecordUnreadable:
      return "";
  }
  return "";
}

TripAdvice AdviceOf(TripCause cause) noexcept {
  const auto index = static_cast<std::size_t>(cause);
  return index < kRows.size() ? kRows[index].advice : TripAdvice{"", "", ""};
}

}  // namespace flexarm
