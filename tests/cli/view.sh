#!/usr/bin/env bash
# The window of `run --view`: refused without a display, and under Xvfb paused, stepped, ended and closed by keys.
. "$(dirname "$0")/support.sh"

environment=(-u DISPLAY -u WAYLAND_DISPLAY)
expect 2 "--view|no display" run hall-small --view --out none
[ ! -e "$work/none" ] || fail "a refused view leaves a folder"
[ -x "$(dirname "$sim")/cairn_view" ] || skip "this build has no viewer: OpenCV's highgui was missing"
environment=(-u WAYLAND_DISPLAY DISPLAY=:99999)
expect 2 "--view: source 'lost-in-the-woods' does not use it" run lost-in-the-woods:x --view --out none
expect 2 "--view: no window could be opened" run hall-small --max-frames 3 --no-video --view --out none --force
command -v Xvfb >/dev/null || skip "no Xvfb (Debian: xvfb)"
command -v xdotool >/dev/null || skip "no xdotool"

exec {number}<> <(:)
Xvfb -displayfd "$number" -screen 0 1024x900x24 >/dev/null 2>&1 &
server=$!
trap 'kill "$server"; rm -rf "$work"' EXIT
read -r -t 20 -u "$number" display || skip "Xvfb does not start"
export DISPLAY=:$display

begin() { # FOLDER: a run of 60 frames, 2 s, in a window
  (cd "$work" && exec "$sim" run hall-small --no-video --view --out "$1" >"$1.txt" 2>&1) &
  run=$!
  window=$(timeout 60 xdotool search --sync --onlyvisible --name "Cairn: hall" 2>/dev/null | tail -1)
  [ -n "$window" ] || fail "no window: $(cat "$work/$1.txt")"
}
press() { xdotool key --window "$window" "$@" 2>/dev/null; }
ends() { # CODE FOLDER TEXT
  wait "$run"
  local code=$?
  [ "$code" -eq "$1" ] || fail "exit code $code, expected $1: $(cat "$work/$2.txt")"
  grep -qF -- "$3" "$work/$2.txt" || fail "'$3' is not in: $(cat "$work/$2.txt")"
  [ -s "$work/$2/summary.json" ] || fail "$2: no summary"
}

begin whole
ends 0 whole "frames 60"

# paused, it does not end by itself; stepped, it stays paused; then it is ended
begin paused
press space
sleep 4
kill -0 "$run" 2>/dev/null || fail "the pause does not hold"
press period
press s
sleep 0.5
kill -0 "$run" 2>/dev/null || fail "it runs on after a step"
press q
ends 0 paused "ended in the window after"
frames=$(sed -n 's/^frames \([0-9]*\) .*/\1/p' "$work/paused.txt")
[ "${frames:-60}" -lt 60 ] || fail "ended after all $frames frames"

# Ctrl-C is taken during a pause
begin interrupted
press space
sleep 0.5
kill -INT "$run"
ends 130 interrupted "interrupted after"
finish
