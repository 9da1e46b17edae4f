#!/usr/bin/env bash
# What setup.sh would install on a machine that has nothing: for the demo no tools of boards, tests or linters, and all of it
# without --demo. usage: setup_packages.sh SETUP
set -uo pipefail
setup=$1
stub=$(mktemp -d)
trap 'rm -rf "$stub"' EXIT
failures=0
fail() {
  echo "FAIL: $1"
  failures=$((failures + 1))
}
printf '#!/bin/sh\nexit 1\n' | tee "$stub/dpkg-query" "$stub/sudo" "$stub/apt-get" >/dev/null
printf '#!/bin/sh\necho 1000\n' >"$stub/id"
chmod +x "$stub"/*

wanted() { PATH="$stub:$PATH" "$setup" "$@" 2>&1; }
demo=$(wanted --demo) && fail "ends well without rights"
all=$(wanted)
grep -q "apt-get install build-essential cmake" <<<"$demo" || fail "does not say what to install: $demo"
for package in gcc-arm-none-eabi qemu-system-arm clang-tidy libgtest-dev valgrind; do
  [[ " $demo " != *" $package "* ]] || fail "the demo wants $package"
  [[ " $all " == *" $package "* || $all == *" $package"$'\n'* ]] || fail "the tests do not want $package: $all"
done
[[ $(wanted --demo extra) == *" extra"* ]] || fail "a package that is named is left out"
exit $((failures > 0))
