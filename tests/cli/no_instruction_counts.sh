#!/usr/bin/env bash
# Where valgrind is missing or fails, `timing` says why, does the rest and leaves no counts, not even
# those of an earlier run.
. "$(dirname "$0")/support.sh"

# times_without "TEXT|TEXT...": as said above, with `environment` as it is.
times_without() {
  mkdir -p "$work/out"
  echo "old" >"$work/out/frame_instructions.csv"
  expect 0 "instructions not counted: $1|times below" \
    timing hall-small --max-frames 3 --counted-frames 3 --out out
  grep -q '"instructions": null' "$work/out/timing.json" || fail "$1: counts in timing.json"
  for left in frame_instructions.csv callgrind.out counted.log; do
    [ ! -e "$work/out/$left" ] || fail "$1: $left is left"
  done
  rm -r "$work/out"
}

# replace_valgrind LINE: a program of its name that does this.
mkdir "$work/bin" "$work/empty"
replace_valgrind() {
  printf '#!/bin/sh\n%s\n' "$1" >"$work/bin/valgrind"
  chmod +x "$work/bin/valgrind"
}

environment=("PATH=$work/bin:$PATH")
replace_valgrind "exit 132"
times_without "valgrind ended with code 132 (Illegal instruction)|does not know an instruction of this processor"
replace_valgrind "kill -ILL \$\$"
times_without "valgrind was ended by signal 4 (Illegal instruction)|does not know an instruction of this processor"
replace_valgrind "echo \"valgrind: failed to start tool 'callgrind'\" >&2; exit 1"
times_without "valgrind ended with code 1: valgrind: failed to start tool 'callgrind'"
replace_valgrind "exit 0"
times_without "callgrind wrote no counts of frames"
environment=("PATH=$work/empty")
times_without "valgrind is not installed"
finish
