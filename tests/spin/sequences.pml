/* SEQUENCES random sequences of TICKS inputs, each through the machine in Promela and through the
   product's, each on its own state from Starting on. docs/safety.md, "Model". */

#include "tests/spin/numbers.h"
#include "tests/spin/tick_facts.pml"

byte state, cause;
byte product_state, product_cause, product_refusal;
int sequence, tick;
bool visited[11];

init {
  do
  :: sequence < SEQUENCES ->
       d_step {
         state = Starting; cause = None; product_state = Starting; product_cause = None; tick = 0;
         do
         :: tick < TICKS ->
              c_code {
                const unsigned long long present = sequence_present(now.sequence, now.tick);
                const unsigned flags = sequence_flags(now.sequence, now.tick);
                now.request = sequence_request(now.sequence, now.tick);
                now.cause_present = present != 0;
                now.all_damped = all_of_category_1(present);
                now.lowest = lowest_cause(present);
                now.all_reported = (flags & kFactReported) != 0;
                now.at_rest = (flags & kFactAtRest) != 0;
                now.experiment_done = (flags & kFactDone) != 0;
                now.stop_expired = (flags & kFactExpired) != 0;
                now.reset_pressed = (flags & kFactPressed) != 0;
                now.shutting_down = (flags & kFactShuttingDown) != 0;
                now.may_damp = (flags & kFactMayDamp) != 0;
                now.drives_on = (flags & kFactDrivesOn) != 0;
                now.drives_off = (flags & kFactDrivesOff) != 0;
                now.tests_power = (flags & kFactTestsPower) != 0;
                now.power_follows = (flags & kFactPowerFollows) != 0;
                const unsigned next = product_next(now.product_state, now.product_cause, present,
                                                   flags, now.request);
                now.product_state = next & 255;
                now.product_cause = next >> 8 & 255;
                now.product_refusal = next >> 16;
              };
              drives_on = drives_on || c_expr { built_in == 1 }; /* another row: must be found */
#include "tests/spin/machine.pml"
              state = new_state; cause = new_cause;
              assert(state == product_state);
              assert(cause == product_cause);
              assert(new_refusal == product_refusal);
              visited[state] = true;
              tick++
         :: else -> break
         od;
         forget_tick(); tick = 0; state = 0; cause = 0;
         product_state = 0; product_cause = 0; product_refusal = 0;
         sequence++
       }
  :: else -> break
  od;
  assert(visited[0] && visited[1] && visited[2] && visited[3] && visited[4] && visited[5] &&
         visited[6] && visited[7] && visited[8] && visited[9] && visited[10])
}
