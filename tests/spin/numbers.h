/* Names of the table of transitions as numbers, for Promela: those of the product, which
   product.cpp checks. Corrupted: every number above the states. */

#define Starting 0
#define Idle 1
#define Armed 2
#define Running 3
#define Stopping 4
#define Tripped 5
#define FaultStopping 6
#define Disarming 7
#define TestingPump 8
#define TestingRelay 9
#define TestingPower 10
#define Corrupted 11

#define AsksNothing 0
#define AsksArm 1
#define AsksRun 2
#define AsksStop 3
#define AsksDisarm 4
#define AsksReset 5
#define AsksChange 6

/* Refusals, and None of the causes. */
#define None 0
#define WrongState 1
#define NotAtRest 2
#define CauseRemains 3
#define NoReset 4
#define Unhealthy 5
#define ShuttingDown 8
#define DrivesOff 9
#define RelayClosed 11

/* Causes that the model knows. */
#define EmergencyStop 5
#define SoftLimit1 6
#define StateNotFinite 23
#define StopTimeout 25
#define EndedWhileArmed 26
