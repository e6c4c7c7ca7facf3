#include "controller/operator/refusal_list.h"

#include <array>

namespace flexarm {
namespace {

constexpr const char* kMoving = "arm, run, pluck, home, pause, resume, speed, retarget";
constexpr const char* kChanges = "pause, resume, speed, retarget";
constexpr const char* kAll = "all but status";

// tests/e2e/explain_test.py compares the names with those that the code answers.
constexpr std::array kRefusals = {
    RefusalAdvice{"too-many-clients", "all",
                  "The socket has as many clients as it serves, and this one has been quiet the "
                  "longest, so it was closed.",
                  "Look for programs that keep a connection open.", "Connect again.", ""},
    RefusalAdvice{"line-too-long", "all",
                  "A client sent a line that is longer than any command, so it was closed.",
                  "Check what the program sends: one JSON object a line.", "Connect again.", ""},
    RefusalAdvice{"bad-request", "all",
                  "The command is malformed: it is unknown, a value is missing, is of another type "
                  "or is out of its range. The text says which.",
                  "Compare it with docs/protocol.md.", "Correct it, or use the program `flexarm`.",
                  ""},
    RefusalAdvice{"not-permitted", kAll, "Your user may not give this command.",
                  "`id` shows your groups: flexarm may operate, flexarm-view may look and stop.",
                  "Become a member of the group (`adduser USER flexarm`) and log in again.", ""},
    RefusalAdvice{"held-by", "all but status, stop, sim",
                  "Another user has the arm: from arming it until a while after it was disarmed.",
                  "`flexarm status` names the user.",
                  "Ask the user to disarm it. While it does not move you may take it over.",
                  "--take-over"},
    RefusalAdvice{"shutting-down", "all but status, stop, disarm", "The daemon is ending.",
                  "Read its journal: `journalctl -u flexarmd`.", "Start it again first.", ""},
    RefusalAdvice{"busy", "arm, run, pluck, home, tare, zero, calibrate, prove-switches, reset",
                  "Another command is under way: an arm that is being judged, a run that is being "
                  "planned, or a measurement.",
                  "`flexarm status` shows it.",
                  "Repeat the command after its end, or end it with `flexarm stop`.", ""},
    RefusalAdvice{"wrong-state",
                  "arm, run, pluck, home, pause, resume, speed, retarget, tare, zero, calibrate, "
                  "prove-switches, limits, stop, disarm, reset",
                  "The state does not allow the command: run, pluck and home need Armed; "
                  "pause, resume, speed and retarget Running; tare, zero, prove-switches and "
                  "limits Idle or Tripped; arm and calibrate Idle; reset Tripped.",
                  "`flexarm status` shows the state.",
                  "Run what leads to that state: `flexarm arm`, `flexarm stop`, `flexarm disarm` "
                  "or `flexarm reset`.",
                  ""},
    RefusalAdvice{"host-checking", "arm",
                  "Whether this machine is good enough for a real rig is not known yet.",
                  "`flexarm check-host` shows what takes long.", "Repeat the command.",
                  "--override-host REASON"},
    RefusalAdvice{"host-not-ready", "arm",
                  "This machine is not good enough for a real rig: its kernel, scheduling or "
                  "interfaces would let the loop run late.",
                  "`flexarm check-host` lists each finding with its remedy.",
                  "Follow the remedies; docs/hardware.md.", "--override-host REASON"},
    RefusalAdvice{"design-rejected", "arm",
                  "The design of the controller failed a check: the loop would not be stable with "
                  "every payload of controller.payload_range_kg.",
                  "`flexarm design -c RIG.toml` explains the check and names the keys.",
                  "Change the config; `flexarm design --tune` searches for better values.", ""},
    RefusalAdvice{"design-forced", "arm",
                  "The gains failed checks and were written with `flexarm design --force`; a "
                  "simulated arm accepts them.",
                  "`flexarm status` lists the checks that failed.",
                  "Design gains that pass every check.", "--override-design REASON"},
    RefusalAdvice{"no-log", kMoving,
                  "There is no file for the log of the next run: the disk is full, or cannot be "
                  "written.",
                  "`flexarm status` shows the file and the error under `log`.",
                  "Make room or mend the disk; log.required = false in the config does without.",
                  ""},
    RefusalAdvice{"not-kept", "arm",
                  "The daemon cannot write to its state folder, so a trip would not survive a "
                  "restart.",
                  "The text names the file and the error of the system.",
                  "Make room or give permission in daemon.state_directory.", ""},
    RefusalAdvice{"unhealthy", "arm",
                  "A cause of a trip is present, or a task has not reported yet.",
                  "`flexarm status` names the causes that are present.",
                  "Remove them; after a start, wait a second.", ""},
    RefusalAdvice{"relay-closed", "arm",
                  "Relay and charge pump are off, but the relay's mirror contact or the drives' "
                  "voltage does not say that the power is off.",
                  "A relay needs 0.1 s, the voltage hal.gpiod.drive_voltage.fall_ms: repeat the "
                  "command then.",
                  "If it is refused again, the relay is welded or the wire of its contact is cut: "
                  "switch the power off and repair it.",
                  ""},
    RefusalAdvice{"not-at-rest", "arm, reset", "The arm is moving.",
                  "Look whether something moves it; `flexarm status` shows its rates.",
                  "Wait until it is at rest, then repeat the command.", ""},
    RefusalAdvice{"drives-off", "run, pluck, home",
                  "The drives have not confirmed that they are on.",
                  "Check their supply and their display.", "Repeat the command.", ""},
    RefusalAdvice{"not-plucked", "run, home",
                  "The wiring has not been tested since the daemon started, which "
                  "commissioning.prove_before_run demands.",
                  "docs/commissioning.md says what the test shows.", "Run `flexarm pluck` first.",
                  ""},
    RefusalAdvice{"angle-unknown", "run",
                  "The angle of a joint is not known: its encoder may have lost its count, or "
                  "commissioning.angles_at_start is \"lost\".",
                  "The text and `flexarm status` name the joint and the reason.",
                  "Run `flexarm zero` with the arm at its zero, or `flexarm home`.", ""},
    RefusalAdvice{"switches-not-proved", "run",
                  "The limit switches, the emergency stop and the reset button of this rig have "
                  "not been proved, or too long ago (safety.prove_days).",
                  "`flexarm status` shows the last proof.",
                  "Run `flexarm prove-switches` and press each of them.",
                  "--override-switches REASON"},
    RefusalAdvice{"experiment-refused", "run",
                  "The experiment cannot be read, or it would leave the limits of the rig. The "
                  "text names row, joint, value and limit.",
                  "`flexarm simulate --experiment FILE` finds the same without the arm.",
                  "Change the experiment as the text says; docs/experiments.md.", ""},
    RefusalAdvice{"arm-moved", "run",
                  "The arm was moved while its run was planned, so the plan does not begin where "
                  "it stands.",
                  "Look whether something moves it.", "Repeat the command.", ""},
    RefusalAdvice{"no-path", kChanges,
                  "The motion that goes on follows no path, or one whose durations are chosen "
                  "while it runs.",
                  "`flexarm status` shows the law; docs/experiments.md, \"While it runs\".",
                  "Let it end, or end it with `flexarm stop`.", ""},
    RefusalAdvice{"paused", "pause, speed", "The run is paused.", "`flexarm status` shows it.",
                  "`flexarm resume`.", ""},
    RefusalAdvice{"not-paused", "resume", "The run is not paused.", "`flexarm status` shows it.",
                  "Nothing is to be done.", ""},
    RefusalAdvice{"change-refused", kChanges,
                  "The changed path would leave a limit, or cannot be planned. The text says which "
                  "limit and where. The run goes on as it was.",
                  "`flexarm status` shows where the arm is.",
                  "Ask for another goal, speed or instant.", ""},
    RefusalAdvice{"too-late", kChanges,
                  "The change was ready after the sample from which it should hold, or its run had "
                  "ended.",
                  "`flexarm status` shows the run, and how late the threads are.",
                  "Repeat the command.", ""},
    RefusalAdvice{"cancelled", kMoving,
                  "A stop, a disarm or a trip came while the command was waiting.",
                  "`flexarm status` shows whether it was a trip.", "Repeat the command.", ""},
    RefusalAdvice{"cause-remains", "reset", "A cause of a trip is still present.",
                  "`flexarm status` names it.", "Remove it, then repeat the command.", ""},
    RefusalAdvice{"no-reset", "reset", "The reset button has not been pressed since the trip.",
                  "Check the button and its wire if it was.",
                  "Press it at the rig for 50 ms or longer, release it, then repeat the command.",
                  ""},
    RefusalAdvice{"not-simulated", "sim", "This daemon controls a real rig.",
                  "`flexarm status` shows the backend.", "Press the real switch.", ""},
};

}  // namespace

std::span<const RefusalAdvice> RefusalList() noexcept { return kRefusals; }

}  // namespace flexarm
