#!/usr/bin/env bash
# Builds the page of web/ into build/web, with a clip of the hall's drive, and compares its module with the host's
# programs; installs what is missing. Where the Cortex-M7's build lies in build/cortex-m7 (scripts/test.sh makes it), the
# emulated board replays the clip as well and its hashes are shown.
# scripts/web.sh [FRAMES [QUALITY]]: frames of the clip, 300; quality of its JPEGs, 65.
set -euo pipefail
cd "$(dirname "$0")/.."

frames=${1:-300}
quality=${2:-65}
most_bytes=$((400 * 1024)) # gzipped, the clip apart
host=build/host
wasm=build/wasm
work=build/web-clip
page=build/web
python=/usr/bin/python3 # Debian's, which has the packages that are installed below
export NODE_PATH=/usr/share/nodejs # where Debian keeps acorn, which the compiler loads

scripts/setup.sh emscripten nodejs node-acorn libstb-dev python3-pil
[ -f "$host/CMakeCache.txt" ] && grep -q '^CAIRN_STB_INCLUDE_DIR:PATH=/' "$host/CMakeCache.txt" || cmake --preset host
cmake --build "$host" --target cairn_sim exercise replay_vehicle replay_handheld unpack_clip
cmake --preset web
cmake --build "$wasm" --target engine exercise replay_vehicle replay_handheld

mkdir -p "$work" "$page"
"$host/bin/cairn_sim" run hall --max-frames "$frames" --no-video --force --out "$work/hall" --record "$work/recorded.log"
"$python" web/make_clip.py "$work/recorded.log" "$page/hall.clip" "$quality"
rm "$work/recorded.log"
"$host/bin/unpack_clip" "$page/hall.clip" "$work/hall.log"
"$host/bin/replay_vehicle" "$work/hall.log" --overlay yes >"$work/host.txt"
targets=("$(uname -m), native=$work/host.txt")
board=build/cortex-m7
if [ -f "$board/CMakeCache.txt" ] && cmake --build "$board" --target replay_vehicle; then
  toolchains/run_qemu_system.sh mps2-an500 "$board/bin/replay_vehicle.elf" "$work/hall.log" --overlay yes \
    >"$work/cortex-m7.txt"
  targets+=("Cortex-M7, emulated=$work/cortex-m7.txt")
fi
about="The first $frames frames of the built-in hall, 640x480 at 30 Hz, as JPEG of quality $quality, with odometry."
web/make_hashes.py "$page/hall.json" "$about" "${targets[@]}"

cp web/page/*.html web/page/*.css web/page/*.js "$wasm/bin/engine.wasm" "$page/"
bytes=0
for file in "$page"/*.html "$page"/*.css "$page"/*.js "$page"/*.wasm "$page"/*.json; do
  bytes=$((bytes + $(gzip -9 -c "$file" | wc -c)))
done
echo "web: $bytes bytes gzipped, and a clip of $(wc -c <"$page/hall.clip")"
if [ "$bytes" -gt "$most_bytes" ]; then
  echo "web: more than $most_bytes" >&2
  exit 1
fi

"$python" tests/web/equals_native.py "$host" "$wasm" "$work/hall.log"
"$python" tests/target/compare_texts.py "$host/bin/replay_vehicle" "$work/hall.log" --overlay yes -- \
  node --no-experimental-fetch tests/web/replay_clip.js "$page/engine.wasm" "$page/hall.clip"
echo "web: $page; to look at it: python3 -m http.server --directory $page"
