#!/usr/bin/env bash
# Counts every loop in the inputs of 640x480 and in TRIES evolved stress scenes, checks the bounds and
# renews docs/reference/loop-bounds.md. Called by scripts/firmware.sh --loops, which builds first.
set -euo pipefail
cd "$(dirname "$0")/../.."
tries=$1
out=build/firmware/loops
mkdir -p "$out"
logs=()
for log in build/firmware/logs/*.log; do
  case $log in *hall-small*) ;; *) logs+=(--log "$log") ;; esac
done
build/host-loops/bin/loop_count --profile "$out/loops.profraw" "${logs[@]}" --search "$tries" |
  tee "$out/search.txt"
python3 tests/timing/loop_bounds.py build/host-loops/bin/loop_count "$out/loops.profraw" \
  --page docs/reference/loop-bounds.md --tries "$tries"
