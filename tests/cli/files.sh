#!/usr/bin/env bash
# What a run leaves when it is interrupted, killed or has no room, and beside an earlier run's files:
# each file whole or not at all, and a word about it.
. "$(dirname "$0")/support.sh"

check() {
  "${@:2}" && return
  fail "$1"
}
whole_tables() {
  local file columns
  for file in "$work/$1"/*.csv; do
    [ -e "$file" ] || continue
    columns=$(head -1 "$file" | tr -cd , | wc -c)
    awk -F, -v n="$((columns + 1))" 'NF != n {exit 1}' "$file" || return 1
    [ -z "$(tail -c 1 "$file" | tr -d '\n')" ] || return 1
  done
}
no_parts() { [ -z "$(find "$work/$1" -name '*.part*')" ]; }

# start FOLDER: a run of minutes in the background, its id in `run`, waited for until it tracks.
start() {
  (cd "$work" && exec "$sim" run hall-small --max-frames 100000 --no-video --record "$1.log" --out "$1") \
    >"$work/$1.txt" 2>&1 </dev/null &
  run=$!
  for _ in $(seq 600); do
    [ -n "$(find "$work/$1" -name 'overlay-*.jpg' 2>/dev/null)" ] && return
    [ -s "$work/$1.log.part" ] && [ "$(stat -c %s "$work/$1.log.part")" -gt 1000000 ] && return
    sleep 0.1
  done
  fail "the run does not begin: $(cat "$work/$1.txt")"
}

# an interruption: the results of the frames so far, marked; exit code as shells give it
start term
kill -TERM "$run"
wait "$run"
code=$?
check "exit code after SIGTERM: $code" [ "$code" -eq 143 ]
check "the summary is marked" grep -q '"interrupted_by": 15' "$work/term/summary.json"
check "it says so" grep -q "interrupted after" "$work/term.txt"
check "whole tables after SIGTERM" whole_tables term
check "no parts after SIGTERM" no_parts term
picture=$(find "$work/term" -name 'overlay-*.jpg' -size +1k -printf '%f\n' | head -1)
check "a picture of the last frame after SIGTERM" [ -n "$picture" ]
check "the report shows it" grep -q "$picture" "$work/term/summary.json"
(cd "$work" && "$sim" replay term.log >/dev/null 2>&1 </dev/null) || fail "the log of an interrupted run replays"

# a terminal that closes, and one whose closing is ignored
start hung
kill -HUP "$run"
wait "$run"
code=$?
check "exit code after SIGHUP: $code" [ "$code" -eq 129 ]
check "the summary is marked" grep -qE '"interrupted_by": 1(,|$)' "$work/hung/summary.json"
check "whole tables after SIGHUP" whole_tables hung
trap '' HUP
start nohup
trap - HUP
kill -HUP "$run"
sleep 0.5
check "nohup holds" kill -0 "$run"
kill -TERM "$run"
wait "$run"
code=$?
check "exit code under nohup after SIGTERM: $code" [ "$code" -eq 143 ]

# a kill: nothing that looks like results
start kill
kill -KILL "$run"
wait "$run" 2>/dev/null
check "no summary after SIGKILL" [ ! -e "$work/kill/summary.json" ]
check "no log after SIGKILL" [ ! -e "$work/kill.log" ]
check "whole tables after SIGKILL" whole_tables kill

# a full disk, by the limit of a file's size
output=$(cd "$work" && ulimit -f 4 && "$sim" run hall-small --max-frames 60 --no-video --out full 2>&1 </dev/null)
code=$?
check "exit code on a full disk: $code, $output" [ "$code" -eq 4 ]
check "it names the file: $output" grep -q "full/.*cannot be written" <<<"$output"
# one that is full when the report is written, the last and largest file
output=$(cd "$work" && ulimit -f 180 && "$sim" run hall-small --max-frames 12 --no-video --out late 2>&1 </dev/null)
code=$?
if [ -e "$work/late/summary.json" ] && command -v python3 >/dev/null; then
  check "exit code where the report has no room: $code, $output" [ "$code" -eq 4 ]
  check "it names the report: $output" grep -q "late/report.html: .*cannot be written" <<<"$output"
  check "no half report" [ -z "$(find "$work/late" -name 'report.html*')" ]
fi
check "no summary on a full disk" [ ! -e "$work/full/summary.json" ]
check "whole tables on a full disk" whole_tables full
check "no parts on a full disk" no_parts full
touch "$work/a-file"
expect 4 "cannot be created" run hall-small --max-frames 2 --no-video --out a-file/x
output=$(cd "$work" && ulimit -f 60 && "$sim" run hall-small --max-frames 150 --out video 2>&1 </dev/null)
code=$?
check "exit code with no room for the video: $code, $output" [ "$code" -eq 4 ]
check "no video without room" [ -z "$(find "$work/video" -name 'overlay.*')" ]

# standard output on a full device
if [ -w /dev/full ]; then
  for words in info "run --help" "run hall-small --max-frames 2 --no-video --force --out device"; do
    said=$(cd "$work" && "$sim" $words 2>&1 >/dev/full </dev/null)
    code=$?
    check "exit code of '$words' on a full device: $code" [ "$code" -eq 4 ]
    check "it says so: $said" grep -q "standard output cannot be written" <<<"$said"
  done
fi

# an earlier run's files go, a user's own stay
expect 0 "log hash" run hall-small --max-frames 12 --out again
touch "$work/again/overlay-999999.jpg" "$work/again/overlay-mine.jpg" "$work/again/notes.txt" "$work/again/frames.csv.part"
expect 2 "--out again|holds files already|--force" run hall-small --max-frames 12 --no-video --out again
check "a refused run removes nothing" [ -s "$work/again/summary.json" ]
expect 0 "log hash" run hall-small --max-frames 12 --no-video --force --out again
check "an earlier picture is gone" [ ! -e "$work/again/overlay-999999.jpg" ]
check "an earlier part is gone" [ ! -e "$work/again/frames.csv.part" ]
check "an earlier video is gone" [ ! -e "$work/again/overlay.mp4" ]
check "the user's files stay" [ -e "$work/again/overlay-mine.jpg" -a -e "$work/again/notes.txt" ]

# a name with characters that shells and HTML know, and one that is no UTF-8
odd="o'\$(touch X);\"<b>&"$'\xfc'
expect 0 "log hash" run hall-small --max-frames 12 --no-video --out "$odd"
check "no command was run" [ ! -e "$work/X" ]
if [ -e "$work/$odd/report.html" ]; then
  check "no HTML of the name" bash -c '! grep -qF "<b>&" "$0"' "$work/$odd/report.html"
fi
finish
