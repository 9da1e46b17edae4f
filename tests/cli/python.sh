#!/usr/bin/env bash
# The Python that draws: one without what a script needs is passed over, one that fails is quoted, and files of
# the working folder are no modules of it.
. "$(dirname "$0")/support.sh"

mkdir "$work/stub"
stub() {
  printf '#!/bin/sh\n%s\n' "$1" >"$work/stub/python3"
  chmod +x "$work/stub/python3"
}
drive=(run hall-small --max-frames 3 --no-video --out)

environment=("PATH=$work/stub:$PATH")
stub "echo 'first' >&2; echo 'boom' >&2; exit 3"
expect 0 "log hash|report.html not made: python3 ended with code 3: boom" "${drive[@]}" failing
[ -s "$work/failing/summary.json" ] || fail "no summary without a report"
[ ! -e "$work/failing/report.html" ] || fail "a report that was not made"

if [ -x /usr/bin/python3 ]; then
  drawn="report: debian/report.html" # which needs no matplotlib
else
  drawn="report.html not made: python3 has no matplotlib"
fi
stub "exit 4"
expect 0 "$drawn" "${drive[@]}" debian

environment=()
for module in csv json matplotlib numpy; do
  echo "open('ran', 'w')" >"$work/$module.py"
done
expect 0 "log hash" "${drive[@]}" modules
[ ! -e "$work/ran" ] || fail "a file of the working folder was run as a module"
finish
