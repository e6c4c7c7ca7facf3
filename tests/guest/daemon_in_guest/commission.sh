#!/usr/bin/env bash
# Inside the guest, on virtual time: the unchanged daemon commissions `flexarm rig` over the real
# protocols. Wrongly wired amplifiers are named before the arm moves under control.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"

# shellcheck source=tests/guest/daemon_in_guest/rig.sh
. "$(dirname "$0")/rig.sh"
# The values of link 2 have two registers each, whose order matters.
row='strain = %d, table = "input_register", address = %d, type = "%s"'
for i in {0..9}; do
  # shellcheck disable=SC2059
  sed -i "s/$(printf "$row" $((10 + i)) $((100 + i)) int16)/$(printf "$row" $((10 + i)) \
    $((200 + 2 * i)) int32)/" wire.toml
done
printf '\n[commissioning]\nprove_before_run = true\n' >>wire.toml

amplifier() { echo "amplifier strain-amplifier-$1 $2" >&3; sleep 0.2; }
says() { flexarm "${@:2}" 2>&1 | tee said.txt | grep -q -- "$1"; }
plucked() {  # plucked AMPLIFIER FAULT FINDING: with the fault the pluck test reports the finding
  amplifier "$1" "$2"
  check "a pluck test names: $3" says "$3" pluck
  amplifier "$1" well
  sleep 0.5
}

start_rig
start_daemon

echo "== at rest"
check "tare" flexarm tare
check "zero" flexarm zero
check "link 1 has no load, so it cannot be calibrated" \
  refused flexarm calibrate --link 1 --force-n 5 --at-m 0.8

amplifier 2 wrong-word-order
check "words in the wrong order are out of range and trip" \
  within 5 grep -q -- '-> Tripped: strain-saturated: strain_2_' daemon.log
check "then tare is refused" refused flexarm tare
amplifier 2 well
check "reset" press_and_reset
sleep 1

echo "== plucked"
check "armed" arm_rig
check "no run before the wiring is proven" says 'flexarm pluck' run $experiment
plucked 1 "inverted 3" "strain_1_04: is inverted"
plucked 1 "swapped 1 5" "strain_1_02, strain_1_06: are exchanged"
plucked 2 "scaled 14 1.5" "strain_2_05: reads 1."
plucked 2 "stuck 10" "strain_2_01: does not move"
check "with correct wiring pluck passes" flexarm pluck
check "no run before the switches are proved" says 'flexarm prove-switches' run $experiment
check "then a run is allowed" flexarm run --override-switches "emulated machine" $experiment
armed() { [[ $(state) == Armed ]]; }
within 30 armed
check "disarmed" flexarm disarm
check "the hardware has no power after it" equal "$(hardware)" "$dead"
kill -TERM $daemon
wait $daemon
check "flexarmd ends with 0: its trip was reset" equal $? 0
for run in runs/*.flexarm; do
  check "replay is bit exact" equal \
    "$(flexarm replay "$run" --json | jq -c '[.bit_exact, .safety_exact]')" "[true,true]"
done

echo "== after a restart the calibration is read again"
stop_rig
start_rig
start_daemon
check "zeros come from the file" test -s runs/calibration.json
check "armed, with the wiring not yet proven" arm_rig
check "no run before that" says 'flexarm pluck' run $experiment
kill -TERM $daemon
wait $daemon
stop_rig
conclude
