#!/usr/bin/env bash
# The lanes of tools/run-tests, which runs `tools/lanes.sh NAME` for each and stores its output.
# docs/testing.md describes each lane; tools/lint/check_docs.py compares the two.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# Cheap lanes first. Lanes run one after the other: hil, e2e and guest measure time.
# shellcheck disable=SC2034  # tools/run-tests reads them
{
  quick_lanes=(format layers guards)
  ci_lanes=(format layers release step-cost install hil bench e2e docs headers tsan asan clang-tidy guest)
  only_all_lanes=(guards unit campaigns soak soak-days slowest mutation mutants fuzz docs-all build-cost headers-all
                  python-types browser separate clang-tidy-all asan-all tsan-all guest-long package cluster debian13 arm64)
}

logs=build/logs
passes=build/lanes
jobs=$(nproc)
export CTEST_PARALLEL_LEVEL=$jobs PYTHONDONTWRITEBYTECODE=1

# A hash of the tree that a lane passed on: the commit, all differences from it, and the installed
# packages. Empty without git: then no lane counts as passed.
tree_state() {
  git rev-parse --quiet --verify HEAD >/dev/null 2>&1 || return 0
  {
    git rev-parse HEAD
    git diff --binary HEAD
    git ls-files -z --others --exclude-standard | xargs -0 -r sha256sum
    dpkg-query -W 2>/dev/null || true
  } | sha256sum | cut -d' ' -f1
}

has_passed() {  # has_passed NAME STATE: on this tree, and --resume was given
  [[ ${FLEXARM_RESUME:-no} == yes && -n $2 && $(cat "$passes/$1.passed" 2>/dev/null) == "$2" ]]
}

record_pass() {  # record_pass NAME STATE: stores the state if the run has not changed it
  rm -f "$passes/$1.passed"
  if [[ -n $2 && $(tree_state) == "$2" ]]; then
    mkdir -p "$passes"
    echo "$2" >"$passes/$1.passed"
  fi
}

part() {  # part NAME COMMAND..: a part of a long lane; --resume skips a part that passed
  local name=$lane.$1 state
  state=$(tree_state)
  if has_passed "$name" "$state"; then
    echo "$name: passed before on this tree"
    return
  fi
  "${@:2}"
  record_pass "$name" "$state"
}

# A lane may leave one line for the summary.
note() { printf '%s\n' "$*" >"$logs/$lane.note"; }

configure() {  # configure PRESET: once per run of run-tests; later ninja detects changes
  local mark=$passes/$1.configured
  if [[ -n ${FLEXARM_RUN:-} && $(cat "$mark" 2>/dev/null) == "$FLEXARM_RUN" ]]; then return; fi
  local options=()
  # A user's build never fails because a newer compiler warns; this one does.
  if [[ $1 == release ]]; then options=(-DFLEXARM_WERROR=ON); fi
  cmake --preset "$1" "${options[@]}"
  mkdir -p "$passes"
  echo "${FLEXARM_RUN:-}" >"$mark"
}

build() {  # build PRESET [TARGET..]
  configure "$1"
  if (($# > 1)); then
    cmake --build --preset "$1" -j "$jobs" --target "${@:2}"
  else
    cmake --build --preset "$1" -j "$jobs"
  fi
}

test_folder() {  # test_folder PRESET FOLDER LABELS: fails without tests, or if a program is missing
  local listed
  listed=$(ctest --test-dir "build/$1/$2" -N)
  # CMake lists a program that was not built as one test without a label: a filter would hide it.
  if grep '_NOT_BUILT$' <<<"$listed"; then
    echo "error: $2 has tests whose programs were not built" >&2
    return 1
  fi
  ctest --test-dir "build/$1/$2" -L "$3" --output-on-failure --no-tests=error "${@:4}"
}

preset_tests() {  # preset_tests PRESET: notes the tests that this machine does not permit
  local said=$logs/$lane.ctest status=0 skipped
  mkdir -p "$logs"
  ctest --preset "$1" | tee "$said" || status=$?
  skipped=$(sed -n 's/^.*Test *#[0-9]*: \([^ ]*\) .*\*\*\*Skipped.*/\1/p' "$said" | paste -sd' ')
  if [[ -n $skipped ]]; then note "SKIPPED here: $skipped"; fi
  return $status
}

# ctest accepts no folder beside a preset: the environment of the preset is set here.
use_environment_of() {  # use_environment_of TEST_PRESET
  local assignments
  assignments=$(python3 -c '
import json, shlex, sys
presets = json.load(open("CMakePresets.json", encoding="utf-8"))["testPresets"]
preset = next(p for p in presets if p["name"] == sys.argv[1])
for name, value in preset["environment"].items():
    print(f"export {name}={shlex.quote(value)}")
' "$1")
  eval "$assignments"
}

sources() { git ls-files -z -- '*.h' '*.cpp'; }

lane_format() {  # clang-format 19 changes nothing
  sources | xargs -0 -P "$jobs" -n 40 clang-format-19 --dry-run -Werror
  note "$(sources | tr -cd '\0' | wc -c) files"
}

lane_layers() {  # includes, documents, words and other rules of tools/lint; shellcheck
  python3 tools/lint/check_layers.py
  python3 tools/lint/check_docs.py
  python3 tools/lint/check_words.py
  git ls-files -z -- tools/install-deps tools/run-hil tools/run-tests .ci/run package/p{ostinst,rerm,ostrm} '*.sh' '*.sbatch' |
    xargs -0 shellcheck --severity=warning
}

# The code between the outside world and the arm.
guards=(tests/hal tests/controller/safety tests/config)

lane_guards() {  # unit tests of drivers, safety logic and configs, release build (part of release)
  local folder
  build release "${guards[@]/%//all}"
  for folder in "${guards[@]}"; do test_folder release "$folder" '^unit$'; done
}

lane_unit() {  # tests labelled unit, release build (part of release)
  configure release
  local list programs
  # The name of a program ends with the label of its tests if that is not `unit`.
  list=$(ninja -C build/release -t targets all | sed -n 's/^\([a-z_]*_test\): phony$/\1/p' |
         grep -vE '^cmake_|_(loop|long|rt)_test$')
  mapfile -t programs <<<"$list"
  build release flexarm flexarm-study flexarm-web "${programs[@]}"
  preset_tests unit
}

lane_release() {  # all tests but those of whole programs, release build
  build release
  preset_tests release
}

campaign() {  # campaign FILTER PROGRAM: the matching tests of a program, at their whole size
  FLEXARM_CAMPAIGN=whole FLEXARM_CAMPAIGN_JOBS=$jobs "build/release/tests/$2" --gtest_filter="$1"
}

killed_runs() {
  FLEXARM_CAMPAIGN=whole FLEXARM_BIN="$PWD/build/release/bin" python3 tests/e2e/killed_run_test.py
}

started_rigs() (  # a shell of its own: the environment of tsan is not for the other parts
  use_environment_of tsan
  FLEXARM_CAMPAIGN=whole build/tsan/tests/controller/wired_threads/wired_threads_test
)

lane_campaigns() {  # random campaigns at their whole size; `release` runs a sample of each
  local programs=(controller/{operator/operator_loop,loop/loop_loop,loop/sensor_loss_loop}_test
                  controller/{loop/shipped_runs_loop,wired/wired_loop}_test)
  local torture=tools/torture/tools_torture_long_test program
  build release operator_loop_test loop_loop_test sensor_loss_loop_test shipped_runs_loop_test \
    wired_loop_test tools_bound_long_test tools_torture_long_test tools_health_long_test \
    flexarm flexarm-study flexarm-web flexarmd
  for program in "${programs[@]}"; do
    part "${program##*/}" campaign '*.Campaign*' "$program"
  done
  part bound campaign '*' tools/bound/tools_bound_long_test
  # The days of `Soak` are lane soak-days.
  part torture-sessions campaign Torture.CampaignBreaksNoRule "$torture"
  part torture-matrix campaign 'GuardedMatrix*' "$torture"
  part torture-rest campaign '*-Soak.*:Torture.CampaignBreaksNoRule:GuardedMatrix*' "$torture"
  part health campaign '*' tools/health/tools_health_long_test
  part fault-matrix tests/e2e/fault_matrix_check.sh build/release/bin/flexarm
  part killed-runs killed_runs
  build tsan wired_threads_test
  part started-rigs started_rigs
}

lane_soak-days() {  # three days of the daemon in lock step
  build release tools_torture_long_test
  campaign 'Soak.*' tools/torture/tools_torture_long_test
}

lane_soak() {  # the daemon in real time on the simulated arm for 50 minutes (FLEXARM_SOAK_S=N)
  build release flexarm flexarm-study flexarm-web flexarmd
  FLEXARM_SOAK_S=${FLEXARM_SOAK_S:-3000} FLEXARM_BIN="$PWD/build/release/bin" \
    python3 tests/soak/real_time.py
}

lane_step-cost() {  # instructions of one control step and of each phase are within their limits
  build release step_instructions slowest_step
  python3 tests/bench/step_cost.py --program build/release/tests/bench/step_instructions \
    --note "$logs/$lane.note"
  python3 tests/bench/slowest.py --program build/release/tests/bench/slowest_step
}

lane_slowest() {  # searches the slowest control step, safety tick and plan (FLEXARM_SEED=N)
  build release slowest_step
  python3 tests/bench/slowest.py --program build/release/tests/bench/slowest_step --search 300 \
    --seed "${FLEXARM_SEED:-1}" --jobs "$jobs" --names safety plan step-sobel step-l step-pd \
    step-gain step-receding step-difference step-polynomial step-T16 step-ekf \
    --note "$logs/$lane.note"
}

lane_e2e() {  # whole programs: simulate, replay, determinism, kill -9, wrong input
  build release flexarm flexarm-study flexarm-web flexarmd unfit_program
  # Twice as many as processors: most of them wait for a daemon.
  CTEST_PARALLEL_LEVEL=$((2 * jobs)) ctest --preset e2e
}

lane_docs() {  # command blocks `ci` of the pages, from a clean clone and with the installed programs
  build release flexarm flexarm-study flexarm-web flexarmd
  tests/docs/run_blocks.py ci --build build/release --note "$logs/$lane.note"
}

lane_docs-all() {  # command blocks `all` of the pages, which take minutes
  build release flexarm flexarm-study flexarm-web flexarmd
  local pages page
  pages=$(tests/docs/run_blocks.py all --build build/release --list)
  for page in $pages; do
    part "${page//\//-}" tests/docs/run_blocks.py all --build build/release --page "$page"
  done
  note "$(wc -w <<<"$pages") pages"
}

lane_mutation() {  # 20,000 changed inputs of every kind to the programs (part of e2e: 1,000)
  build release flexarm flexarm-study flexarm-web flexarmd
  tests/mutation/mutation_test.py --inputs 20000 --seed "${FLEXARM_SEED:-1}" --note "$logs/$lane.note"
}

lane_mutants() {  # changes of safety code that changed recently: a test notices each
  # Ends before run-tests would stop it; it fails if mutants are left, and goes on where it was.
  nice python3 tests/code_mutation/mutants.py --changed --within "${FLEXARM_MUTANTS_S:-3000}" \
    --jobs "$jobs" --note "$logs/$lane.note"
}

fuzz() {  # fuzz TARGET DICTIONARY: for a minute, from the stored inputs and those of earlier runs
  local own=build/fuzz/inputs/$1 log=$logs/$lane-$1.log folders
  mkdir -p "$own" "$logs"
  mapfile -t folders < <(find "tests/fuzz/corpus/$1" "tests/fuzz/found/$1" -maxdepth 0 2>/dev/null)
  # The limit of an input is a second; sanitizers and a busy machine take ten times as long.
  nice "build/fuzz/tests/fuzz/fuzz_$1" -max_total_time="${FLEXARM_FUZZ_S:-60}" -timeout=10 \
    -max_len=32768 -rss_limit_mb=2048 -malloc_limit_mb=1024 -print_final_stats=1 \
    -artifact_prefix="$logs/$lane-$1-" ${2:+-dict="tests/fuzz/dictionaries/$2.dict"} \
    "$own" "${folders[@]}" >"$log" 2>&1 || { tail -n 60 "$log" && return 1; }
  grep -E '^#[0-9]+.DONE' "$log"
}

lane_fuzz() {  # libFuzzer on every reader of outside input, a minute each (FLEXARM_FUZZ_S=N)
  build fuzz fuzz_programs
  export ASAN_SYMBOLIZER_PATH=${ASAN_SYMBOLIZER_PATH:-/usr/lib/llvm-19/bin/llvm-symbolizer}
  local targets=(calibration:json can: client:json comedi: config:toml csv:csv experiment:toml gains:json
                 log:log modbus: socket:json telemetry:) target
  for target in "${targets[@]}"; do
    part "${target%:*}" fuzz "${target%:*}" "${target#*:}"
  done
  note "$(cat "$logs/$lane"-*.log |
          awk '/^stat::number_of_executed_units/ { sum += $2 } END { print sum " inputs" }')"
}

lane_hil() {  # tools/run-hil, in real time where that is permitted
  if ! chrt -f 90 true 2>/dev/null; then
    note "SCHED_FIFO is not permitted here: ran without it"
  fi
  python3 tests/e2e/hil_check.py
}

build_for_guest() {
  build release flexarm flexarmd guest_daq_test guest_gpio_test hal_canopen_socketcan_test \
    wired_threads_test rtguard
}

lane_guest() {  # programs and service on an emulated PREEMPT_RT kernel
  build_for_guest
  tests/guest/run_all.sh build/release --note "$logs/$lane.note"
}

lane_guest-long() {  # the same kernel: what takes minutes more, and changes seldom
  build_for_guest
  part pairs tests/guest/run_all.sh build/release --note "$logs/$lane.pairs.note" \
    guard_pairs.{0..3}
  part scripts tests/guest/run_all.sh build/release --note "$logs/$lane.scripts.note" \
    guard_faults.{tcp,can,serial,readings,power} guarded wire_more commission load wakeup fast_loop \
    hardened refusal
  build release flexarm-study
  part newcomer tests/guest/newcomer.sh build/release --note "$logs/$lane.newcomer.note"
  note "$(cat "$logs/$lane".{pairs,scripts,newcomer}.note | paste -sd';')"
}

lane_bench() {  # benchmarks; the default experiment runs 100 times faster than real time
  build release control_benchmark model_benchmark planner_benchmark
  python3 tests/bench/bench_report.py --build build/release --note "$logs/$lane.note"
}

lane_headers() {  # public headers that changed recently compile on their own
  build release flexarm_build_info
  tools/lint/headers.py --changed --within 25 --jobs "$jobs" --note "$logs/$lane.note"
}

lane_headers-all() {  # every public header compiles on its own
  build release all_verify_interface_header_sets
}

lane_install() {  # cmake --install leaves a complete tree, and systemd accepts the unit
  build release flexarm flexarm-study flexarm-web flexarmd
  tests/e2e/install_check.sh build/release
}

lane_build-cost() {  # the compile time of the product is within the committed figures
  build release flexarm_build_info
  tools/lint/build_cost.py --jobs "$jobs" --note "$logs/$lane.note"
}

asan_labels='^(unit|loop|hostile)$'

# The stored inputs of tests/fuzz reach every reader: configs, logs, frames of the buses, lines of
# the socket.
lane_asan() {  # address, undefined behaviour: code that parses input
  build asan tests/fuzz/all
  use_environment_of asan
  test_folder asan tests/fuzz "$asan_labels"
}

lane_asan-all() {  # address, undefined behaviour: all tests labelled unit, loop or hostile
  local folders folder
  build asan
  use_environment_of asan
  # All folders that have tests; the folders in hal run with it. Left out: figures of whole
  # simulations, which the release build checks.
  mapfile -t folders < <(git ls-files 'tests/*/CMakeLists.txt' | xargs -n 1 dirname |
                         grep -vxE 'tests/(bench|guest|controller|hal/.*)')
  for folder in "${folders[@]}"; do
    part "${folder//\//-}" test_folder asan "$folder" "$asan_labels" -E 'Grams[0-9]+Stiffened'
  done
}

# Queues, executors and the bodies of the threads.
threaded_tests=(tests/controller/{exchange,realtime,tasks,operator,host,wired_threads})

lane_tsan() {  # thread sanitizer: queues, executors, tasks, all threads of a wired rig
  build tsan "${threaded_tests[@]/%//all}"
  use_environment_of tsan
  local folder
  for folder in "${threaded_tests[@]}"; do test_folder tsan "$folder" .; done
}

lane_tsan-all() {  # thread sanitizer: the programs, from outside (its tests: see tsan)
  build tsan flexarm flexarmd
  use_environment_of tsan
  test_folder tsan tests/e2e '^threads$'
}

lane_python-types() {  # mypy --strict of the Python client and its example
  mypy --cache-dir build/mypy --strict --config-file tools/python/mypy.ini tools/python
}

lane_browser() {  # the page of `flexarm dashboard` in headless Chromium; pictures in build/browser
  build release flexarm flexarm-web flexarmd
  # Debian's Python, which has Debian's selenium.
  FLEXARM_BIN="$PWD/build/release/bin" /usr/bin/python3 tests/browser/dashboard_page_test.py
  note "$(find build/browser -name '*.png' | wc -l) pictures"
}

lane_separate() {  # every source compiles by itself, without batches
  build separate
}

product=(model hal estimator controller config tools)

tidy() {  # tidy OPTION.. FOLDER..: a finding is an error (WarningsAsErrors)
  # Uses the compile commands of single files: the release build compiles batches.
  build separate flexarm_build_info
  tools/lint/tidy.py --jobs "$jobs" --note "$logs/$lane.note" "$@"
}

# In CI the time is limited; the files left out are named, and clang-tidy-all checks them.
lane_clang-tidy() {  # .clang-tidy on files of the product that changed recently
  tidy --changed --within 40 "${product[@]}"
}

lane_clang-tidy-all() {  # .clang-tidy on product and tests; unchanged files are skipped
  tidy "${product[@]}" tests
}

lane_package() {  # the Debian package: same bytes twice, lintian, and dpkg in a bare Debian
  build release flexarm flexarm-study flexarm-web flexarmd
  tests/package/package_check.sh build/release
}

lane_cluster() {  # a campaign under Slurm, of which a task is killed
  build release flexarm flexarm-study flexarmd
  tests/cluster/slurm_test.sh build/release
}

lane_debian13() {  # both commands of the README in a bare Debian 13; not the slowest lanes
  tests/clean_root.sh trixie './tools/run-hil && ./tools/run-tests --lane format --lane layers \
    --lane release --lane install --lane hil --lane e2e --lane guest'
}

lane_arm64() {  # 64-bit ARM under qemu-user: tests labelled unit or loop, replay across processors
  build release flexarm
  local share
  share=$(mktemp -d)
  python3 tests/arm64/replays.py record build/release/bin/flexarm amd64 "$share"
  tests/clean_root.sh --share "$share" bookworm 'tests/arm64/cross.sh ../share'
  python3 tests/arm64/replays.py replay build/release/bin/flexarm amd64 "$share" |
    tee >(tail -n 1 >"$logs/$lane.note")
  rm -r "$share"
}

if [[ ${BASH_SOURCE[0]} == "$0" ]]; then
  lane=$1
  "lane_$lane"
fi
