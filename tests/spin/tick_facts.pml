/* The facts of a tick, by the names of the table of transitions; all false between ticks. */

bool cause_present, all_damped, all_reported, at_rest, experiment_done, stop_expired, reset_pressed;
bool shutting_down, may_damp, drives_on, drives_off, tests_power, power_follows;
byte lowest, request;
byte new_state, new_cause, new_refusal;
bool product_agrees;

#define cause_known (cause != None)
#define asks_any (request != AsksNothing)
#define asks_arm (request == AsksArm)
#define asks_run (request == AsksRun)
#define asks_stop (request == AsksStop)
#define asks_disarm (request == AsksDisarm)
#define asks_reset (request == AsksReset)
#define asks_change (request == AsksChange)

c_decl { \#include "tests/spin/product.h" }

/* A state that counts only what it should: what is over leaves no trace. */
inline forget_tick() {
  cause_present = false; all_damped = false; all_reported = false; at_rest = false;
  experiment_done = false; stop_expired = false; reset_pressed = false; shutting_down = false;
  may_damp = false; drives_on = false; drives_off = false; tests_power = false;
  power_follows = false; lowest = 0; request = AsksNothing; new_state = 0; new_cause = 0;
  new_refusal = 0
}
