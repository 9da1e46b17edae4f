#!/usr/bin/env bash
# Builds the fuzz targets and runs them: fuzz.sh [SECONDS [TARGET...]]
# SECONDS for each target, 30 by default. What breaks a promise is left in build/fuzz/findings/; run
# build/fuzz/bin/fuzz_TARGET FILE to see it again. Exit code 1 where there is a finding.
set -uo pipefail
cd "$(dirname "$0")/.."

seconds=${1:-30}
shift || true
targets=("$@")
list=tests/fuzz/targets.txt
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(sed -n 's/^\([a-z]\S*\) .*/\1/p' "$list")
if ! [[ "$seconds" =~ ^[0-9]+$ ]] || [ "$seconds" -eq 0 ]; then
  echo "fuzz.sh: expected a number of seconds, found '$seconds'" >&2
  exit 2
fi
for target in "${targets[@]}"; do
  if ! grep -q "^$target " "$list"; then
    echo "fuzz.sh: no target '$target' in $list" >&2
    exit 2
  fi
done

cmake --preset fuzz >/dev/null || exit 1
cmake --build --preset fuzz --target "${targets[@]/#/fuzz_}" || exit 1
mkdir -p build/fuzz/findings build/fuzz/logs

export UBSAN_OPTIONS=print_stacktrace=1
# Libraries of the system are not instrumented, so containers that cross them look overflown. A short quarantine and short
# stacks of allocations: memory stays in the cache, and readers allocate a lot. Below: no entropic schedule, whose counts
# took a third of a tracker's time, and no names of functions, whose look-up took minutes.
export ASAN_OPTIONS=detect_container_overflow=0:malloc_context_size=4:quarantine_size_mb=16
failed=0
printf '%-13s %12s %8s %9s  %s\n' target executions edges "a second" result
for target in "${targets[@]}"; do
  corpus=build/fuzz/corpus/$target
  start=tests/fuzz/corpus/$target
  log=build/fuzz/logs/$target.txt
  mkdir -p "$corpus" "$start"
  longest=$(sed -n "s/^$target //p" "$list")
  words=()
  [ ! -e "tests/fuzz/$target.dict" ] || words=("-dict=tests/fuzz/$target.dict")
  "build/fuzz/bin/fuzz_$target" -max_total_time="$seconds" -max_len="$longest" "${words[@]}" -timeout=60 \
    -rss_limit_mb=3000 -entropic=0 -print_funcs=0 -print_final_stats=1 -artifact_prefix="build/fuzz/findings/$target-" \
    "$corpus" "$start" >"$log" 2>&1
  code=$?
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log" | tail -1)
  rate=$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log" | tail -1)
  edges=$(grep -o 'cov: [0-9]*' "$log" | tail -1 | cut -d' ' -f2)
  result=clean
  if [ "$code" -ne 0 ]; then
    failed=1
    result=$(grep -m1 -E 'promise [0-9]+ is broken|runtime error|ERROR: (Address|lib)' "$log" || echo "ended with $code, see $log")
  fi
  printf '%-13s %12s %8s %9s  %s\n' "$target" "${executions:--}" "${edges:--}" "${rate:--}" "$result"
done
exit "$failed"
