#!/usr/bin/env bash
# Makes the API reference with Doxygen, from the public headers; a warning is an error.
# scripts/docs.sh [FOLDER]: FOLDER/html/index.html, by default build/docs.
set -euo pipefail
cd "$(dirname "$0")/.."

command -v doxygen >/dev/null || scripts/setup.sh doxygen
out=${1:-build/docs}
mkdir -p "$out"
part() { sed -n "s/^#define CAIRN_VERSION_$1 //p" core/include/cairn/version.h; }
CAIRN_VERSION="$(part MAJOR).$(part MINOR).$(part PATCH)" CAIRN_DOCS_OUT="$out" doxygen Doxyfile
echo "API reference: $out/html/index.html"
