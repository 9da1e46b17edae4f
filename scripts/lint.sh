#!/usr/bin/env bash
# Checks the format of every source and runs clang-tidy over all that the host builds: scripts/lint.sh [--fix-format]
set -euo pipefail
cd "$(dirname "$0")/.."

mapfile -t sources < <(git ls-files '*.hpp' '*.h' '*.cpp' '*.c')
if [ "${1:-}" = --fix-format ]; then
  clang-format -i "${sources[@]}"
else
  clang-format --dry-run --Werror "${sources[@]}"
fi

[ -f build/host/compile_commands.json ] || cmake --preset host
run-clang-tidy -quiet -p build/host -j "$(nproc)" "^$PWD/(core|examples|host_sim|port|tests|web)/"
