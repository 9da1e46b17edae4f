#!/usr/bin/env bash
# `timing` leaves its files and its table; a limit that is missed ends with 1.
. "$(dirname "$0")/support.sh"

expect 0 "whole frame|camera pose calculation|41.57|times below" \
  timing hall-small --max-frames 10 --counted-frames 0 --out a
for file in frame_times.csv timing.json timing.md; do
  [ -s "$work/a/$file" ] || fail "no $file"
done
[ "$(wc -l <"$work/a/frame_times.csv")" -eq 11 ] || fail "not ten frames"
expect 1 "above the limit" \
  timing stress:noise,handheld=1 --max-frames 3 --counted-frames 0 --p99-below 0.0001 --out c
expect 2 "no pictures" timing lost-in-the-woods:here --out d
expect 2 "stress field 'cell=3'|cell_px=1..64" run stress:cell=3 --out e
finish
