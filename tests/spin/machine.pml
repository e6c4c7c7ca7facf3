/* The state machine of the safety task in Promela: the rows of transition_table.def as guarded
   commands, in the place where this file is included. It reads state, cause, lowest and the facts
   of tick_facts.pml, and writes new_state, new_cause and new_refusal. Rows that exclude each other
   leave nothing to choose; two that hold at once would be tried both. */

new_state = state;
new_cause = cause;
new_refusal = (asks_any -> WrongState : None);

#define Kept cause
#define Lowest lowest

if
#define TRANSITION(from, when, to, why) :: (state == from && (when)) -> new_state = to; new_cause = why; c_code { row_held(__COUNTER__); };
#include "controller/safety/transition_table.def"
:: else
fi;

if
#define REFUSAL(in, when, why) :: (state == in && (when)) -> new_refusal = why;
#include "controller/safety/transition_table.def"
:: else
fi;
