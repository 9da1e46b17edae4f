#!/usr/bin/env bash
# check-mount: a right mount is not suspect, a source without odometry has none, nothing is written.
. "$(dirname "$0")/support.sh"

expect 0 "frames 200   tracked|yaw|pitch|roll|focal length|not contradicted" \
  check-mount hall-small --max-frames 200
if grep -q suspect <<<"$output"; then fail "a right mount is suspect: $output"; fi
if [ -n "$(ls -A "$work")" ]; then fail "check-mount wrote $(ls "$work")"; fi
expect 2 "--odometry: source 'hall-small' does not use it" check-mount hall-small --odometry o.csv
expect 2 "SOURCE" check-mount
finish
