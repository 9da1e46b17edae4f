# Sourced by the tests here: sim = the program, work = a folder of the test's own.
set -uo pipefail
sim=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

# expect CODE "TEXT|TEXT..." ARGUMENTS...: the program ends with CODE and says every TEXT.
expect() {
  local code=$1 texts=$2 output result text
  shift 2
  output=$(cd "$work" && "$sim" "$@" 2>&1 </dev/null)
  result=$?
  if [ "$result" -ne "$code" ]; then
    echo "FAIL: cairn_sim $*: exit code $result, expected $code: $output"
    failures=$((failures + 1))
  fi
  while IFS= read -r text; do
    if ! grep -qF -- "$text" <<<"$output"; then
      echo "FAIL: cairn_sim $*: '$text' is not in: $output"
      failures=$((failures + 1))
    fi
  done < <(tr '|' '\n' <<<"$texts")
}

finish() {
  [ "$failures" -eq 0 ] && echo "passed"
  exit $((failures > 0))
}
