#!/usr/bin/env bash
# The same seed twice leaves the same log_hash and the same trajectory; another seed does not. The
# files of a run are all there.
. "$(dirname "$0")/support.sh"

run() {
  (cd "$work" && "$sim" run hall-small --max-frames 40 --seed "$1" --out "$2" $3 >"$2.txt" 2>&1 </dev/null)
}
log_hash() { grep -o '"log_hash": "[0-9a-f]*"' "$work/$1/summary.json"; }
check() {
  "${@:2}" && return
  fail "$1"
}

run 1 a "" || failures=1
run 1 b --no-video || failures=1
run 2 c --no-video || failures=1
check "same seed, same log_hash" [ "$(log_hash a)" = "$(log_hash b)" ]
check "same seed, same trajectory" cmp -s "$work/a/trajectory.tum" "$work/b/trajectory.tum"
check "another seed, another log_hash" [ "$(log_hash a)" != "$(log_hash c)" ]
for file in manifest.json frames.csv tracking.csv trajectory.tum truth.tum landmarks.csv summary.json; do
  check "$file is there" [ -s "$work/a/$file" ]
done
check "40 frames and a header" [ "$(wc -l <"$work/a/frames.csv")" -eq 41 ]
check "the overlay video" [ -s "$work/a/overlay.mp4" -o -s "$work/a/overlay.avi" ]
check "no video when it is not wanted" [ ! -e "$work/b/overlay.mp4" ]
check "the table of stages" grep -q "camera pose calculation" "$work/a.txt"
grep -q "report.html not made" "$work/a.txt" || check "the report" [ -s "$work/a/report.html" ]
finish
