#!/usr/bin/env bash
# `relocalisation` drives its trials, leaves a row for each and a summary, and refuses what it cannot run.
. "$(dirname "$0")/support.sh"

expect 0 "black|other place|results in" \
  relocalisation --trials 1 --lengths 2 --first-frame 12 --last-frame 12 --out a
[ "$(wc -l <"$work/a/kidnapped.csv")" -eq 3 ] || fail "not two trials"
grep -q '"holds": true' "$work/a/summary.json" || fail "no summary"
expect 2 "--last-frame lies before" relocalisation --first-frame 9 --last-frame 8 --out b
expect 2 "expected seven-scenes:DIR" relocalisation --source kitti:here --out b
expect 3 "nowhere" relocalisation --source seven-scenes:nowhere --out b
expect 2 "--last-frame lies before" faults --first-frame 9 --last-frame 8 --out b # its former name
finish
