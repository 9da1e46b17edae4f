#!/usr/bin/env bash
# What takes too long for CI, at low priority: nightly.sh [STEP...]
#   sanitize   the whole host suite with AddressSanitizer and UndefinedBehaviorSanitizer
#   threads    the tests of two tasks with ThreadSanitizer
#   fuzz       every fuzz target for ten minutes (FUZZ_SECONDS)
#   faults     the fault classes on a drive of 600 frames
#   laps       50 laps of one hall (LAPS)
#   web        the page as WebAssembly against the host, and in headless Chromium
# Prints a line a step with its result and time, which docs/results/robustness.md keeps; logs lie in
# build/nightly/. Exit code 1 where a step failed.
set -uo pipefail
cd "$(dirname "$0")/.."
renice -n 19 $$ >/dev/null

steps=("$@")
[ ${#steps[@]} -gt 0 ] || steps=(sanitize threads fuzz faults laps web)
logs=build/nightly
mkdir -p "$logs"

sanitize() {
  # OpenCV's GPhoto2 backend, which is asked about videos that FFmpeg refuses, leaks.
  export OPENCV_VIDEOIO_PRIORITY_GPHOTO2=0
  cmake --preset sanitize -DCAIRN_BUILD_HOST_SIM=ON -DCAIRN_UNITY_BUILD=ON &&
    cmake --build --preset sanitize &&
    ctest --preset sanitize --parallel "$(nproc)"
}
host() { cmake --preset host -DCAIRN_FIRMWARE_BOARDS= && cmake --build --preset host --target "$@"; }
threads() { host two_tasks map_exchange_test && ctest --preset host -R '^(two_tasks|map_exchange_test)$'; }
fuzz() { scripts/fuzz.sh "${FUZZ_SECONDS:-600}"; }
faults() { host cairn_sim && build/host/bin/cairn_sim inject --out "$logs/faults.csv"; }
laps() { host cairn_sim && build/host/bin/cairn_sim laps --laps "${LAPS:-50}" --out "$logs/laps"; }
web() { scripts/web.sh && scripts/web_browser.sh; }

failed=0
echo "$(date -u +%F) $(git describe --always --dirty 2>/dev/null)"
for step in "${steps[@]}"; do
  case "$step" in
    sanitize | threads | fuzz | faults | laps | web) ;;
    *)
      echo "nightly.sh: no step '$step'" >&2
      exit 2
      ;;
  esac
  begin=$SECONDS
  if "$step" >"$logs/$step.txt" 2>&1; then
    result=passed
  else
    result="FAILED, see $logs/$step.txt"
    failed=1
  fi
  printf '%-9s %6d s  %s\n' "$step" $((SECONDS - begin)) "$result"
done
exit "$failed"
