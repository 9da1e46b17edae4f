#!/usr/bin/env bash
# Installs what is missing, builds everything and runs every test that CI runs: on the host, and on
# emulated boards.
set -euo pipefail
cd "$(dirname "$0")/.."

boards=(cortex-m7 cortex-m4f cortex-m7-clang)
# Without a floating-point unit: what works in fixed point.
fixed=(cortex-m3 cortex-m0plus rv32imc)

scripts/setup.sh
for board in "${boards[@]}"; do
  # The C interface and the examples are built for one board.
  options=(-DCAIRN_TARGET_DEBUG=-g1)
  [ "$board" = cortex-m7 ] || options+=(-DCAIRN_C_CONFIGS= -DCAIRN_BUILD_EXAMPLES=OFF)
  cmake --preset "$board" "${options[@]}"
  cmake --build --preset "$board"
done
for board in "${fixed[@]}"; do
  cmake --preset "$board" -DCAIRN_TARGET_DEBUG=-g1
  cmake --build --preset "$board"
done
cmake --preset host -DCAIRN_UNITY_BUILD=ON -DCAIRN_FIRMWARE_BOARDS="$(IFS=';'; echo "${boards[*]}")" \
  -DCAIRN_FIXED_POINT_BOARDS="$(IFS=';'; echo "${fixed[*]}")"
cmake --build --preset host
ctest --preset host --parallel "$(nproc)"
