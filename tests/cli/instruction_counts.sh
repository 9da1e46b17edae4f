#!/usr/bin/env bash
# `timing` counts the instructions of the first frames: the same in every run, in a program that
# links no library of the host's. Skipped where valgrind cannot run that program.
. "$(dirname "$0")/support.sh"

count=$(dirname "$sim")/cairn_count_frames
allowed='linux-vdso|ld-linux|libstdc\+\+\.|libgcc_s\.|libm\.|libc\.'
foreign=$(ldd "$count" | grep -vE "$allowed")
[ -z "$foreign" ] || fail "cairn_count_frames links $foreign"

expect 0 "log hash" run hall-small --max-frames 3 --no-video --record "$work/log" --out run
lines=$("$count" "$work/log") || fail "cairn_count_frames ended with $?"
[ "$(grep -c '^stages' <<<"$lines")" -eq 3 ] || fail "not a line for each frame: $lines"
[ "$("$count" 2>&1)" = "usage: cairn_count_frames LOG" ] || fail "cairn_count_frames: no usage"
head -c 1000 "$work/log" >"$work/cut"
cut=$("$count" "$work/cut" 2>&1)
result=$?
[ "$result" -eq 3 ] || fail "a log cut short ends with $result, expected 3"
grep -qF "expected a whole input log" <<<"$cut" || fail "a log cut short: $cut"

command -v valgrind >/dev/null || skip "valgrind is not installed"
why=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null "$count" "$work/log" 2>&1)
result=$?
[ "$result" -eq 0 ] ||
  skip "valgrind cannot run cairn_count_frames here, it ends with code $result: $(tail -1 <<<"$why")"

for out in a b; do
  expect 0 "whole frame" timing hall-small --max-frames 3 --counted-frames 3 --out $out
done
[ "$(wc -l <"$work/a/frame_instructions.csv")" -eq 4 ] || fail "not three frames counted"
# From the tenth frame on the hall is tracked: every stage works, and most of a frame is some stage's.
expect 0 "whole frame" timing hall-small --max-frames 12 --counted-frames 12 --out c
tail -n +12 "$work/c/frame_instructions.csv" | awk -F, '
  { sum = $2 + $3 + $4 + $5 + $6 }
  $2 == 0 || $3 == 0 || $4 == 0 || $5 == 0 || $6 == 0 || sum > $7 || sum < 0.95 * $7 { print; bad = 1 }
  END { exit bad || NR == 0 }' || fail "stages that are not the frame"
cmp "$work/a/frame_instructions.csv" "$work/b/frame_instructions.csv" || fail "counts differ"
for left in callgrind.out counted.log; do
  [ ! -e "$work/a/$left" ] || fail "$left is left"
done
finish
