#!/usr/bin/env bash
# `timing` leaves its files and its table; instructions are the same in every run; a limit that is
# missed ends with 1.
. "$(dirname "$0")/support.sh"

files="frame_times.csv timing.json timing.md"
expect 0 "whole frame|camera pose calculation|41.57|times below" \
  timing hall-small --max-frames 10 --counted-frames 3 --out a
for file in $files; do
  [ -s "$work/a/$file" ] || { echo "FAIL: no $file"; failures=$((failures + 1)); }
done
[ "$(wc -l <"$work/a/frame_times.csv")" -eq 11 ] || { echo "FAIL: not ten frames"; failures=$((failures + 1)); }
if valgrind --version >/dev/null 2>&1; then
  expect 0 "whole frame" timing hall-small --max-frames 3 --counted-frames 3 --out b
  cmp "$work/a/frame_instructions.csv" "$work/b/frame_instructions.csv" || failures=$((failures + 1))
  [ "$(wc -l <"$work/a/frame_instructions.csv")" -eq 4 ] ||
    { echo "FAIL: not three frames counted"; failures=$((failures + 1)); }
fi
expect 1 "above the limit" \
  timing stress:noise,handheld=1 --max-frames 3 --counted-frames 0 --p99-below 0.0001 --out c
expect 2 "no pictures" timing lost-in-the-woods:here --out d
expect 2 "stress field 'cell=3'|cell_px=1..64" run stress:cell=3 --out e
finish
