#!/usr/bin/env bash
# Builds the firmware of every emulated target, runs self-test and replays on it and compares each
# frame's hash with the host's:
#
#   scripts/firmware.sh [--timing] [--growth] [--loops TRIES] [--all] [--targets LIST]
#
#   --timing         also instructions per stage and modelled cycles on the M7 and the M4F
#   --growth         also how a frame's cost grows with its capacities, on the M7
#   --loops TRIES    also every loop's bound against its counts, in the inputs and in so many
#                    evolved stress scenes, on the host
#   --all            also the host with g++ and clang++ at -O0, -O2 and -O3, and the unit tests on
#                    every target (long)
#   --targets LIST   these presets alone, comma-separated; what was measured of the others stays
#
# Leaves build/firmware/summary.json and renews docs/reference/footprint.md and targets.md, and with --timing
# timing.md. Rows of targets that this build folder has not measured stay as they were.
set -euo pipefail
cd "$(dirname "$0")/.."

boards=(cortex-m7 cortex-m4f cortex-m33 cortex-m55 cortex-m7-clang)
linux=(aarch64-linux armhf-linux riscv64-linux)
hosts=(host-gcc-O0 host-gcc-O2 host-gcc-O3 host-clang-O0 host-clang-O2 host-clang-O3)
targets=()
all=no
timing=no
growth=no
tries=0
while [ $# -gt 0 ]; do
  case $1 in
    --timing) timing=yes ;;
    --growth) growth=yes ;;
    --loops)
      [ $# -ge 2 ] || { echo "firmware: --loops needs a number" >&2; exit 2; }
      tries=$2; shift ;;
    --all) all=yes ;;
    --targets)
      [ $# -ge 2 ] || { echo "firmware: --targets needs a list" >&2; exit 2; }
      IFS=, read -ra targets <<<"$2"; shift ;;
    *) sed -n '2,16p' "$0" >&2; exit 2 ;;
  esac
  shift
done
fixed=()
if [ ${#targets[@]} -eq 0 ]; then
  fixed=(cortex-m3 cortex-m0plus rv32imc)
  targets=("${boards[@]}" "${linux[@]}")
  [ $all = no ] || targets+=("${hosts[@]}")
fi

scripts/setup.sh
clang_release=$(clang -dumpversion | cut -d. -f1)
scripts/setup.sh qemu-user googletest "libclang-rt-$clang_release-dev" \
  g++-aarch64-linux-gnu g++-arm-linux-gnueabihf g++-riscv64-linux-gnu

programs=(port_selftest exercise footprint replay_vehicle replay_handheld replay_vehicle_tiny
  replay_handheld_tiny)
large=(replay_vehicle_large replay_handheld_large)
report=(python3 tests/footprint/firmware_report.py)

build() {
  cmake --preset "$1" -DCAIRN_ALL_UNIT_TESTS="$2" || return
  case $1 in
    cortex-m7) cmake --build --preset "$1" --target "${programs[@]}" "${large[@]}" ;;
    host-*) cmake --build --preset "$1" --target "${programs[@]:0:5}" ;;
    *) cmake --build --preset "$1" --target "${programs[@]}" ;;
  esac || return
  if [ "$2" = ON ]; then cmake --build --preset "$1"; fi
}

cmake --preset host
cmake --build --preset host --target cairn_sim fixed_replay "${programs[@]}" "${large[@]}"
"${report[@]}" --record

status=0
for target in "${targets[@]}"; do
  options=()
  units=OFF
  case $timing,$target in yes,cortex-m7 | yes,cortex-m4f) options+=(--timing) ;; esac
  case $all,$target in yes,host-*) ;; yes,*) units=ON; options+=(--unit-tests) ;; esac
  # One target that does not build must not hide what the others do.
  if ! build "$target" $units; then
    echo "firmware: $target does not build" >&2
    status=1
    continue
  fi
  "${report[@]}" --target "$target" "${options[@]}" || status=1
done
# Without a floating-point unit: what works in fixed point, all of its tests.
for board in ${fixed[@]+"${fixed[@]}"}; do
  cmake --preset "$board" -DCAIRN_ALL_UNIT_TESTS=ON && cmake --build --preset "$board" &&
    ctest --preset "$board" &&
    python3 tests/target/compare_runs.py "build/$board" fixed_replay build/host/bin/fixed_replay || status=1
done
if [ $growth = yes ]; then
  cmake --preset cortex-m7
  cmake --build --preset cortex-m7 --target "${large[@]}" library_cost
  python3 tests/timing/growth.py || status=1
fi
if [ "$tries" -gt 0 ]; then
  cmake --preset host-loops
  cmake --build --preset host-loops --target loop_count
  tests/timing/count_loops.sh "$tries" || status=1
fi
"${report[@]}" --write-pages || status=1
exit $status
