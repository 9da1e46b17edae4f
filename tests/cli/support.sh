# Sourced by the tests here: sim = the program, work = a folder of the test's own.
set -uo pipefail
sim=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
environment=() # NAME=VALUE of the program's environment

fail() {
  echo "FAIL: $1"
  failures=$((failures + 1))
}

# expect CODE "TEXT|TEXT..." ARGUMENTS...: the program ends with CODE and says every TEXT. What it
# said is in `output`.
expect() {
  local code=$1 texts=$2 result text
  shift 2
  output=$(cd "$work" && env "${environment[@]}" "$sim" "$@" 2>&1 </dev/null)
  result=$?
  if [ "$result" -ne "$code" ]; then
    fail "cairn_sim $*: exit code $result, expected $code: $output"
  fi
  while IFS= read -r text; do
    if ! grep -qF -- "$text" <<<"$output"; then
      fail "cairn_sim $*: '$text' is not in: $output"
    fi
  done < <(tr '|' '\n' <<<"$texts")
}

# skip REASON: ends as skipped, unless something failed before.
skip() {
  [ "$failures" -eq 0 ] || finish
  echo "skipped: $1"
  exit 77
}

finish() {
  [ "$failures" -eq 0 ] && echo "passed"
  exit $((failures > 0))
}
