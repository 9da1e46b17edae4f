#!/usr/bin/env bash
# Checks the format of every source and runs clang-tidy over all that the host builds: scripts/lint.sh [--fix-format]
# [--analyzer] [PATH...]. What passed before is left out until it changes. --analyzer: clang's analyzer in place of the
# other checks. PATH: only sources below it are checked by clang-tidy.
set -euo pipefail
cd "$(dirname "$0")/.."

write_format=no
checks='-clang-analyzer-*'
paths=()
for option in "$@"; do
  case $option in
    --fix-format) write_format=yes ;;
    --analyzer) checks='-*,clang-analyzer-*' ;;
    -*) echo "lint.sh: unknown option '$option', expected --fix-format or --analyzer" >&2; exit 2 ;;
    *) paths+=("$option") ;;
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
python3 scripts/clang_tidy.py build/lint --checks="$checks" "${paths[@]}"
