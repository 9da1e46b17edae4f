#!/usr/bin/env bash
# Checks the format of every source and runs clang-tidy over all that the host builds: scripts/lint.sh [--fix-format]
# [--analyzer]. --analyzer: clang's analyzer over host_sim and tests too, not over core and port alone: four times as long.
set -euo pipefail
cd "$(dirname "$0")/.."

write_format=no
checks=()
for option in "$@"; do
  case $option in
    --fix-format) write_format=yes ;;
    --analyzer) checks=('-checks=clang-analyzer-*') ;;
    *) echo "lint.sh: unknown option '$option', expected --fix-format or --analyzer" >&2; exit 2 ;;
  esac
done

mapfile -t sources < <(git ls-files '*.hpp' '*.h' '*.cpp' '*.c')
if [ $write_format = yes ]; then
  clang-format -i "${sources[@]}"
else
  clang-format --dry-run --Werror "${sources[@]}"
fi

# A build folder of its own: one source each, whatever build/host is configured for.
cmake --preset host -B build/lint -DCAIRN_UNITY_BUILD=OFF >/dev/null
run-clang-tidy -quiet -p build/lint -j "$(nproc)" "${checks[@]}" "^$PWD/(core|examples|host_sim|port|tests|web)/"
