#!/usr/bin/env bash
# Installs what is missing, builds, runs the main job and says where the report is.
set -euo pipefail
cd "$(dirname "$0")/.."

program=build/host/bin/cairn_sim
[ -x "$program" ] || echo "demo: compiling takes about 5 minutes on two cores, the run a minute"
scripts/setup.sh --demo
cmake --preset host -DCAIRN_UNITY_BUILD=ON -DCAIRN_BUILD_TESTS=OFF -DCAIRN_BUILD_EXAMPLES=OFF
cmake --build --preset host --target cairn_sim
"$program" run hall --out out/hall --force "$@"
