#!/usr/bin/env bash
# Shards of every experiment that is short enough, joined: equal to the whole run, whatever the order of the folders, and what
# does not belong together is refused.
. "$(dirname "$0")/support.sh"

# joins NAME "FILE|FILE..." CODE ARGUMENTS...: two shards and the whole end with CODE, and the files are equal.
joins() {
  local name=$1 files=$2 code=$3 file
  shift 3
  expect 0 "results in" "$@" --shard 1/2 --out "$name/1"
  expect 0 "results in" "$@" --shard 2/2 --out "$name/2"
  expect "$code" "" merge "$name/2" "$name/1" --no-pictures --out "$name/joined"
  expect "$code" "" "$@" --out "$name/whole"
  while IFS= read -r file; do
    cmp "$work/$name/joined/$file" "$work/$name/whole/$file" || fail "$name: $file is not that of the whole"
  done < <(tr '|' '\n' <<<"$files")
}

joins consistency "consistency.csv|sample.csv" 0 \
  consistency --runs 3 --heading-variance 0.01 --filters group-iekf --no-pictures
joins turntable "runs.csv|frames.csv" 0 \
  turntable --experiment yaw10 --points --seeds 2 --condition "on axis, clean" --fading 1.000 --no-pictures
joins relocalisation "kidnapped.csv" 0 relocalisation --trials 1 --lengths 2 --first-frame 12 --last-frame 12
[ "$(wc -l <"$work/relocalisation/joined/kidnapped.csv")" -eq 3 ] || fail "not two trials"
grep -q '"holds": true' "$work/relocalisation/joined/summary.json" || fail "no summary of relocalisation"
joins miscalibration "miscalibration.csv|miscalibration.md" 0 miscalibration hall-small --seeds 2 --max-frames 20
[ "$(wc -l <"$work/miscalibration/joined/miscalibration.csv")" -eq 27 ] || fail "not 13 rows of two seeds"
joins robustness "windows.csv|robustness.md" 0 \
  robustness hall-small --windows 16,8 --max-frames 24 --filter mono

for shard in 1 2; do
  expect 0 "results in" inject --brief --fault F21,F24 --frames 95 --shard $shard/2 --out "faults/$shard"
done
expect 0 "F21|F24|0 fail" merge faults/1 faults/2 --out faults/joined
[ -s "$work/faults/joined/faults.csv" ] || fail "no faults.csv"

expect 2 "shards are missing: 2/2" merge consistency/1 --out bad
expect 3 "shard 1 is there twice" merge consistency/1 consistency/1 --out bad
expect 3 "expected a shard of 'consistency'" merge consistency/1 turntable/2 --out bad
expect 0 "" consistency --runs 3 --heading-variance 0.02 --filters group-iekf --shard 2/2 --out other
expect 3 "not of the same experiment" merge consistency/1 other --out bad
expect 3 "cannot be read" merge nowhere --out bad
mkdir "$work/broken"
head -c 100 "$work/consistency/1/partial.cbor" >"$work/broken/partial.cbor"
expect 3 "not the shard of an experiment" merge broken --out bad
for text in 0/2 3/2 1 1/ /2 a/b 1/2x -1/2; do
  expect 2 "expected i/n" turntable --experiment yaw10 --shard=$text --out bad
done
expect 2 "--worst-case alone" timing hall-small --shard 1/2 --out bad
expect 2 "needs --out" inject --shard 1/2
finish
