#!/usr/bin/env bash
# Installs what is missing, builds, runs the main job and says where the report is.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh
cmake --preset host
cmake --build --preset host --target cairn_sim
build/host/bin/cairn_sim run hall --out out/hall --force "$@"
