#!/usr/bin/env bash
# expect_status.sh STATUS PATTERN COMMAND...: passes when the command ends with STATUS and a line of
# its output matches PATTERN.
set -uo pipefail
expected=$1
pattern=$2
shift 2

output=$("$@" 2>&1)
status=$?
printf '%s\n' "$output"
if [ "$status" -ne "$expected" ]; then
  echo "exit status $status, expected $expected"
  exit 1
fi
grep -qE "$pattern" <<<"$output" || { echo "no line matches: $pattern"; exit 1; }
