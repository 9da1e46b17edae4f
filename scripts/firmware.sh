#!/usr/bin/env bash
# Builds the firmware of every emulated board, runs self-test and replay on it and compares each
# frame's hash with the host's: scripts/firmware.sh [--timing] [--boards LIST]
#
#   --timing         also instructions per stage and modelled cycles (slower)
#   --boards         comma-separated presets; default cortex-m7,cortex-m4f,cortex-m33,cortex-m55
#
# Leaves build/firmware/summary.json and renews docs/reference/footprint.md.
set -euo pipefail
cd "$(dirname "$0")/.."

boards=cortex-m7,cortex-m4f,cortex-m33,cortex-m55
timing=()
while [ $# -gt 0 ]; do
  case $1 in
    --timing) timing=(--timing) ;;
    --boards) boards=$2; shift ;;
    *) sed -n '2,8p' "$0" >&2; exit 2 ;;
  esac
  shift
done

scripts/setup.sh
cmake --preset host
cmake --build --preset host --target cairn_sim replay_vehicle replay_handheld replay_vehicle_tiny \
  replay_handheld_tiny exercise
for board in ${boards//,/ }; do
  cmake --preset "$board"
  cmake --build --preset "$board"
done

logs=build/firmware/logs
mkdir -p "$logs"
record() {  # NAME SOURCE FRAMES
  [ -f "$logs/$1.log" ] || build/host/bin/cairn_sim run "$2" --out "build/firmware/runs/$1" \
    --max-frames "$3" --no-video --record "$logs/$1.log"
}
record hall hall 60
record hall-small hall-small 60
if [ -d ../shared/data/seven_scenes_redkitchen ]; then
  record seven-scenes seven-scenes:../shared/data/seven_scenes_redkitchen 60
fi
exec python3 tests/footprint/firmware_report.py --boards "$boards" "${timing[@]}"
