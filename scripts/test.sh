#!/usr/bin/env bash
# Installs what is missing, builds everything and runs every test that CI runs.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh
cmake --preset host
cmake --build --preset host
ctest --preset host
