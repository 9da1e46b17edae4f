#!/usr/bin/env bash
# Runs a program under ThreadSanitizer: run_sanitized.sh PROGRAM [ARGUMENT...]
# The sanitizer needs places in memory that a kernel may give to something else. The program then
# runs again without random places; exit status 77 where that does not help or is not allowed.
set -uo pipefail
refusal="FATAL: ThreadSanitizer: unexpected memory mapping"

output=$("$@" 2>&1)
status=$?
if grep -qF "$refusal" <<<"$output"; then
  first=$(grep -F "$refusal" <<<"$output" | head -1)
  output=$(setarch --addr-no-randomize "$@" 2>&1)
  status=$?
  if grep -qE "$refusal|setarch: " <<<"$output"; then
    echo "skipped: $first; without random places: $(tail -1 <<<"$output")"
    exit 77
  fi
fi
echo "$output"
exit "$status"
