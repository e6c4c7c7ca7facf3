/* The interlock: operator, button, safety task, control task, bus thread and drive, with relay,
   charge pump, time-out of the drive, numbers of runs, and a daemon that is killed and started
   again. What it proves, and what it leaves out: docs/safety.md, "Model".

   Clock counts ticks of the safety task. In each of them every other process runs at most once, in
   any order, or not at all; a thread that hangs does not run again before the next start.
   One part may be broken from the beginning (broken): the rules hold all the same.
   TESTS_POWER: the drives' voltage is a witness, and arming tests the power path.
   BREAK_..: an error that is built in; Spin must find it (interlock_test.py). The environment of
   the verifier says which one is, so one verifier serves for all (product.h). */

#include "tests/spin/numbers.h"
#include "tests/spin/tick_facts.pml"

#define NO_FILE 0
#define FILE_ARMED 1
#define FILE_TRIPPED 2

/* Which one run a command belongs to, for all numbers at once: that of the last grant, or another. */
#define NO_RUN 0
#define GRANTED 1
#define OTHER 2

#define WELDED 1      /* the relay does not open */
#define PUMP_STUCK 2  /* the output of the charge pump does not fall */
#define NO_TIMEOUT 3  /* the drive keeps its torque without an exchange */

#define PERMIT_TIMEOUT 1  /* ticks, as all that follow; then the gate passes nothing */
#define ASK_TIMEOUT 1     /* the same of a command */
#define PUMP_TIMEOUT 1    /* without a level change; then the pump's output falls */
#define DRIVE_TIMEOUT 1   /* without an exchange; then the drive switches itself off */
#define SILENCE 2         /* of a bus or of the control task: it trips */
#define STATE_LIMIT 2     /* of Stopping, FaultStopping, Disarming and a test of the power path */
#define RISE 1            /* from a test's begin until the drives can report its voltage */
#define LATEST 2          /* longest time with torque after the permission ended */
#define CAP 3             /* ages are counted up to it */

#define TESTS_POWER c_expr { has_witness == 1 }
#define BREAK_GATE c_expr { built_in == 1 }        /* the gate does not look at the state */
#define BREAK_PERMIT_AGE c_expr { built_in == 2 }  /* nor at the age of the permit */
#define BREAK_COMMAND_AGE c_expr { built_in == 3 } /* nor at that of the command */
#define BREAK_PUMP c_expr { built_in == 4 }        /* the charge pump toggles without the safety task */
#define BREAK_DRIVE c_expr { built_in == 5 }       /* the drive has no time-out */
#define BREAK_RELAY c_expr { built_in == 6 }       /* a trip leaves the relay closed */
#define BREAK_BUTTON c_expr { built_in == 7 }      /* a reset without the button */
#define BREAK_LATCH c_expr { built_in == 8 }       /* a start does not read the file */
#define BREAK_FILE c_expr { built_in == 9 }        /* the arm is armed before the file is written */
#define BREAK_NUMBER c_expr { built_in == 10 }     /* what was asked for last runs, not what was granted */
#define BREAK_REST c_expr { built_in == 11 }       /* a report from before the stop ends Stopping */
#define BREAK_LIMIT c_expr { built_in == 12 }      /* no state has a time limit */
#define BREAK_AWAIT c_expr { built_in == 13 }      /* the safety task waits for the bus */
#define BREAK_TABLE c_expr { built_in == 14 }      /* a row of the table is another */
#define BREAK_WITNESS c_expr { built_in == 15 }    /* a test of the power path passes without a report */

byte broken;

/* Safety task. Its permit is state, with permit_age; the number in it is GRANTED. */
byte state = Starting, cause = None, since, permit_age;
bool alive = true, ticked, hangs;
bool relay;  /* as told */
byte pump_age = CAP;

/* Operator task and its file; arm_waits: a request to arm is on its way. */
byte file;
bool arm_waits;

/* Control task: the run that it follows, and of the torque that it asks for. */
bool control_ran, control_hangs, stepped; /* stepped: since Stopping or FaultStopping began */
byte followed, ask_run, ask_age;
bool ask;
bool asked_later; /* BREAK_NUMBER: a run was asked for after the last grant */

/* Bus thread, and the drive behind it. */
bool bus_ran, bus_hangs, torque;
byte torque_run, drive_age;

/* What the rules are about. */
bool button;            /* pressed since the trip */
bool must_press;        /* the arm tripped, or the daemon ended, with power: not pressed since */
byte unpermitted;       /* ticks since torque was permitted */

#define TORQUE_STATE (state == Running || state == Stopping || state == FaultStopping)
#define TESTING (state == TestingPump || state == TestingRelay || state == TestingPower)
#define PUMP_ALIVE (pump_age <= PUMP_TIMEOUT || broken == PUMP_STUCK || BREAK_PUMP)
#define POWER ((relay || broken == WELDED) && PUMP_ALIVE)
#define FORCE                                                                                  \
  (torque && POWER && (drive_age <= DRIVE_TIMEOUT || broken == NO_TIMEOUT || BREAK_DRIVE))

/* A silent bus or control task, and a test without a report that ends it, are causes. */
#define MUST_TRIP                                                                             \
  (drive_age >= SILENCE || ask_age >= SILENCE || (TESTING && since > STATE_LIMIT))

inline maybe(fact) {
  if
  :: skip
  :: fact = true
  fi
}

inline grow(age) {
  if
  :: age < CAP -> age++
  :: else
  fi
}

/* What the safety monitor finds, and what the operator asks for. */
inline draw_facts() {
  all_reported = true; tests_power = TESTS_POWER;
  if
  :: state == Starting -> maybe(shutting_down); all_reported = false
  :: skip
  fi;
  if
  :: true -> cause_present = true; lowest = EmergencyStop
  :: TORQUE_STATE && !MUST_TRIP -> cause_present = true; all_damped = true; lowest = SoftLimit1
  :: !MUST_TRIP
  fi;
  if
  :: TORQUE_STATE -> maybe(may_damp)
  :: else
  fi;
  if
  :: (state == Stopping || state == FaultStopping) && !stepped && !BREAK_REST
  :: state == Starting || state == Armed || state == Running || state == Disarming
  :: else -> maybe(at_rest)
  fi;
  if
  :: state == Running -> maybe(experiment_done); maybe(shutting_down)
  :: state == Armed -> maybe(drives_on); maybe(shutting_down)
  :: state == Idle || TESTING -> maybe(shutting_down)
  :: state == Disarming -> maybe(drives_off)
  :: else
  fi;
  if
  :: (state == Stopping || state == FaultStopping || state == Disarming) &&
       since >= STATE_LIMIT && !BREAK_LIMIT -> stop_expired = true
  :: else
  fi;
  if
  :: state == Tripped && (button || BREAK_BUTTON) -> reset_pressed = true
  :: else
  fi;
  /* The witness: the drives report what their voltage should be, after the time that it takes. */
  if
  :: TESTING && BREAK_WITNESS -> power_follows = true
  :: TESTING && since < RISE
  :: TESTING && since >= RISE && (POWER == (state == TestingPower)) -> maybe(power_follows)
  :: state == Idle && TESTS_POWER && !POWER -> maybe(power_follows)
  :: state == Idle && !TESTS_POWER -> maybe(power_follows)
  :: else
  fi;
  if
  :: request = AsksNothing
  :: request = AsksRun
  :: request = AsksStop
  :: request = AsksDisarm
  :: request = AsksReset
  :: state == Running -> request = AsksChange
  :: arm_waits -> request = AsksArm; arm_waits = false
  fi
}

active proctype Operator() {
  do
  :: atomic { alive && !arm_waits && state != Tripped && file != FILE_TRIPPED ->
       file = (BREAK_FILE -> file : FILE_ARMED); arm_waits = true }
  :: atomic { alive && !arm_waits && state == Idle && file != NO_FILE -> file = NO_FILE }
  :: atomic { alive && state == Tripped && file != FILE_TRIPPED -> file = FILE_TRIPPED }
  od
}

active proctype Button() {
  do
  :: atomic { alive && state == Tripped && !button -> button = true; must_press = false }
  od
}

active proctype Safety() {
  bool had_power, broken_row;
  do
  :: atomic { alive && !ticked && !hangs && (bus_ran || !BREAK_AWAIT) ->
       draw_facts();
       broken_row = (BREAK_TABLE -> !drives_on : false); drives_on = drives_on || broken_row;
#include "tests/spin/machine.pml"
       drives_on = drives_on && !broken_row; broken_row = false;
       /* The machine in Promela is the product's. */
       c_code {
         const unsigned flags =
             kFactReported * now.all_reported + kFactAtRest * now.at_rest +
             kFactDone * now.experiment_done + kFactExpired * now.stop_expired +
             kFactPressed * now.reset_pressed + kFactShuttingDown * now.shutting_down +
             kFactMayDamp * now.may_damp + kFactDrivesOn * now.drives_on +
             kFactDrivesOff * now.drives_off + kFactTestsPower * now.tests_power +
             kFactPowerFollows * now.power_follows;
         const unsigned next =
             product_next(now.state, now.cause, now.cause_present ? 1ULL << now.lowest : 0, flags,
                          now.request);
         now.product_agrees = next == now.new_state + 256 * now.new_cause + 65536 * now.new_refusal;
       };
       assert(product_agrees);
       product_agrees = false;

       had_power = relay;
       if
       :: state == Running || new_state != Running -> /* no run begins */
            asked_later = (asked_later || asks_run) && BREAK_NUMBER
       :: else -> /* the run is granted: all that was before is of another */
            followed = (followed == NO_RUN -> NO_RUN : OTHER);
            ask_run = (ask_run == NO_RUN -> NO_RUN : OTHER);
            torque_run = (torque_run == NO_RUN -> NO_RUN : OTHER);
            asked_later = false
       fi;
       /* Stopping ends in Armed only after a step that was due after the stop. */
       assert(!(state == Stopping && new_state == Armed) || stepped);
       if
       :: new_state == state -> since = (since > STATE_LIMIT -> since : since + 1)
       :: else -> since = 0
       fi;
       if
       :: new_state != state && (new_state == Stopping || new_state == FaultStopping) ->
            stepped = false
       :: new_state == Stopping || new_state == FaultStopping
       :: else -> stepped = false; since = (new_state >= Disarming -> since : 0)
       fi;
       if
       :: new_state == Tripped && state != Tripped -> button = false;
            must_press = must_press || had_power
       :: else
       fi;
       state = new_state; cause = new_cause;
       c_code {
         now.relay = product_relay(now.state);
         now.new_state = product_pump(now.state);
         now.new_cause = product_torque(now.state);
       };
       assert(new_cause == TORQUE_STATE);
       if
       :: state == TestingRelay && pump_age <= PUMP_TIMEOUT -> relay = false /* it dies away first */
       :: state == Tripped && had_power && BREAK_RELAY -> relay = true
       :: else
       fi;
       if
       :: new_state -> pump_age = 0
       :: else
       fi;
       if
       :: state == Tripped -> button = button
       :: else -> button = false
       fi;
       /* A trip opens the relay in its tick, and stays until the button was pressed. */
       assert(state != Tripped || !relay);
       assert(!relay || !must_press);
       /* No state that waits for something lasts longer than its limit. */
       assert(!(state == Stopping || state == FaultStopping || state == Disarming || TESTING) ||
              since <= STATE_LIMIT + TESTING);
       /* With a witness, an arm is armed only with a relay and a pump that open. */
       assert(!TESTS_POWER || state != Armed || (broken != WELDED && broken != PUMP_STUCK));
       forget_tick(); had_power = false; permit_age = 0; ticked = true }
  od
}

active proctype Control() {
  do
  :: atomic { alive && !control_ran && !control_hangs ->
       if
       :: state == Running -> followed = (asked_later -> OTHER : GRANTED)
       :: state == Stopping || state == FaultStopping /* damps, as of that run */
       :: else -> followed = NO_RUN
       fi;
       ask = TORQUE_STATE; ask_run = (state == Running -> followed : NO_RUN);
       ask_age = 0; control_ran = true;
       stepped = (state == Stopping || state == FaultStopping) }
  od
}

/* The gate is the last act before the drive. */
active proctype Bus() {
  do
  :: atomic { alive && !bus_ran && !bus_hangs ->
       torque = ask && (TORQUE_STATE || BREAK_GATE) &&
                (permit_age <= PERMIT_TIMEOUT || BREAK_PERMIT_AGE) &&
                (ask_age <= ASK_TIMEOUT || BREAK_COMMAND_AGE);
       torque_run = (torque -> ask_run : NO_RUN);
       drive_age = 0; bus_ran = true }
  od
}

active proctype Clock() {
  atomic {
    if
    :: broken = 0
    :: broken = WELDED
    :: broken = PUMP_STUCK
    :: broken = NO_TIMEOUT
    fi
  };
  do
  :: atomic { ticked || hangs || !alive ->
       ticked = false; control_ran = false; bus_ran = false;
       grow(permit_age); grow(ask_age); grow(drive_age); grow(pump_age);
       if
       :: alive && TORQUE_STATE && permit_age <= PERMIT_TIMEOUT -> unpermitted = 0
       :: else -> grow(unpermitted)
       fi;
       /* Torque only while it is permitted, and for a moment after. */
       assert(!FORCE || unpermitted <= LATEST);
       /* A control task that stands still is an arm without torque. */
       assert(!FORCE || ask_age <= SILENCE);
       /* What runs was granted. A drive without time-out keeps the torque before until its silent
          bus trips, in the next tick. */
       assert(!FORCE || state != Running || torque_run != OTHER || drive_age >= SILENCE);
       /* What is over leaves no trace. */
       if
       :: !torque -> unpermitted = 0
       :: else
       fi }
  :: atomic { alive && ticked && !hangs -> hangs = true }
  :: atomic { alive && ticked && !control_hangs -> control_hangs = true }
  :: atomic { alive && ticked && !bus_hangs -> bus_hangs = true }
  :: atomic { alive && ticked -> /* killed */
       alive = false; must_press = must_press || relay; hangs = false; control_hangs = false;
       bus_hangs = false; control_ran = false; bus_ran = false; ticked = false; arm_waits = false;
       ask = false; ask_run = NO_RUN; ask_age = 0; followed = NO_RUN; stepped = false; since = 0;
       button = false }
  :: atomic { !alive -> /* started: before the first tick the drives are configured, and off */
       alive = true; permit_age = 0; relay = false; pump_age = CAP; unpermitted = 0;
       torque = false; torque_run = NO_RUN; drive_age = 0;
       if
       :: file != NO_FILE && !BREAK_LATCH -> state = Tripped; cause = EndedWhileArmed
       :: else -> state = Starting; cause = None
       fi }
  od
}
