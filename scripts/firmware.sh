#!/usr/bin/env bash
# Builds the firmware of every emulated target, runs self-test and replays on it and compares each
# frame's hash with the host's:
#
#   scripts/firmware.sh [--timing] [--growth] [--all] [--targets LIST]
#
#   --timing         also instructions per stage and modelled cycles on the M7 and the M4F
#   --growth         also how a frame's cost grows with its capacities, on the M7
#   --all            also the host with g++ and clang++ at -O0, -O2 and -O3, and the unit tests on
#                    every target (long)
#   --targets LIST   these presets alone, comma-separated; renews no page of the reference
#
# Leaves build/firmware/summary.json and renews docs/reference/footprint.md, targets.md, timing.md.
set -euo pipefail
cd "$(dirname "$0")/.."

boards=(cortex-m7 cortex-m4f cortex-m33 cortex-m55 cortex-m7-clang)
linux=(aarch64-linux armhf-linux riscv64-linux)
targets=("${boards[@]}" "${linux[@]}")
all=no
timing=no
growth=no
pages=(--write-pages)
while [ $# -gt 0 ]; do
  case $1 in
    --timing) timing=yes ;;
    --growth) growth=yes ;;
    --all) all=yes ;;
    --targets)
      [ $# -ge 2 ] || { echo "firmware: --targets needs a list" >&2; exit 2; }
      IFS=, read -ra targets <<<"$2"; pages=(); shift ;;
    *) sed -n '2,15p' "$0" >&2; exit 2 ;;
  esac
  shift
done
if [ $all = yes ]; then
  targets+=(host-gcc-O0 host-gcc-O2 host-gcc-O3 host-clang-O0 host-clang-O2 host-clang-O3)
fi

scripts/setup.sh clang qemu-user googletest \
  g++-aarch64-linux-gnu g++-arm-linux-gnueabihf g++-riscv64-linux-gnu

programs=(port_selftest exercise footprint replay_vehicle replay_handheld replay_vehicle_tiny
  replay_handheld_tiny)
large=(replay_vehicle_large replay_handheld_large)
cmake --preset host
cmake --build --preset host --target cairn_sim "${programs[@]}" "${large[@]}"
timed=()
for target in "${targets[@]}"; do
  cmake --preset "$target"
  case $target in
    cortex-m7) cmake --build --preset "$target" --target "${programs[@]}" "${large[@]}" ;;
    host-*) cmake --build --preset "$target" --target "${programs[@]:0:5}" ;;
    *) cmake --build --preset "$target" --target "${programs[@]}" ;;
  esac
  case $timing,$target in yes,cortex-m7 | yes,cortex-m4f) timed+=("$target") ;; esac
done

status=0
python3 tests/footprint/firmware_report.py --targets "$(IFS=,; echo "${targets[*]}")" \
  --timing "$(IFS=,; echo "${timed[*]}")" "${pages[@]}" || status=1
if [ $growth = yes ]; then
  python3 tests/timing/growth.py || status=1
fi
if [ $all = yes ]; then
  for target in "${targets[@]}"; do
    case $target in host-*) continue ;; esac
    cmake --preset "$target" -DCAIRN_ALL_UNIT_TESTS=ON
    cmake --build --preset "$target"
    ctest --preset "$target" --parallel "$(nproc)" || status=1
  done
fi
exit $status
