#ifndef FLEXARM_TESTS_SPIN_PRODUCT_H_
#define FLEXARM_TESTS_SPIN_PRODUCT_H_

/* The product's state machine for the C code that Spin makes of the models. */

#ifdef __cplusplus
extern "C" {
#endif

enum {
  kFactReported = 1,
  kFactAtRest = 2,
  kFactDone = 4,
  kFactExpired = 8,
  kFactPressed = 16,
  kFactShuttingDown = 32,
  kFactMayDamp = 64,
  kFactDrivesOn = 128,
  kFactDrivesOff = 256,
  kFactTestsPower = 512,
  kFactPowerFollows = 1024
};

/* NextSafetyState of controller/safety/safety_machine.h.
   state, cause, request: numbers of the product's enumerations; present: bit i is cause i; flags: a
   sum of the above. Returns state + 256 cause + 65536 refusal. */
unsigned product_next(unsigned state, unsigned cause, unsigned long long present, unsigned flags,
                      unsigned request);

/* RelayClosed, PumpRuns, TorqueAllowed of controller/types/safety_state.h. */
unsigned product_relay(unsigned state);
unsigned product_pump(unsigned state);
unsigned product_torque(unsigned state);

/* A set of causes: its lowest number, or that of StateNotFinite; whether all are of category 1. */
unsigned lowest_cause(unsigned long long present);
unsigned all_of_category_1(unsigned long long present);

/* FLEXARM_ERROR of the environment: the number of the error that is built in; 0: none. */
extern const int built_in;
/* FLEXARM_WITNESS of the environment. */
extern const int has_witness;

/* A row of the transitions has held, by its place in the table. A pan prints them all at its end.
 */
void row_held(unsigned row);

/* Inputs of sequence `sequence`, tick `tick`: the same on every machine. */
unsigned long long sequence_present(unsigned sequence, unsigned tick);
unsigned sequence_flags(unsigned sequence, unsigned tick);
unsigned sequence_request(unsigned sequence, unsigned tick);

#ifdef __cplusplus
}
#endif

#endif
