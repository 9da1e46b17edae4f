#!/usr/bin/env bash
# Opens the page of build/web in headless Chromium and checks it as a visitor would; pictures of it go to
# build/web-browser. Installs Chromium and, by npm, playwright-core. The camera is a recording: the phone's desk of
# ../shared/data where it is there, else the hall, seen by a camera in the hand.
set -euo pipefail
cd "$(dirname "$0")/.."

out=build/web-browser
[ -f build/web/index.html ] || scripts/web.sh
command -v chromium chromium-browser google-chrome >/dev/null || scripts/setup.sh chromium
scripts/setup.sh nodejs
command -v npm >/dev/null || scripts/setup.sh npm # not where nodejs brings its own
mkdir -p "$out"
[ -d "$out/node_modules/playwright-core" ] || npm install --silent --no-save --prefix "$out" playwright-core

desk=../shared/data/phone_desk
if [ -d "$desk" ]; then
  video=("$desk/escritorio_traslacion.mp4")
  source=("video:${video[0]}" --camera "$desk/config.yml" --max-frames 240)
else
  video=()
  source=(hall --mode handheld --max-frames 240)
fi
if [ ! -f "$out/camera.y4m" ]; then
  build/host/bin/cairn_sim run "${source[@]}" --filter mono --no-video --force --out "$out/camera" --record "$out/camera.log"
  /usr/bin/python3 tests/web/make_y4m.py "$out/camera.log" "$out/camera.y4m"
  rm "$out/camera.log"
fi
NODE_PATH="$PWD/$out/node_modules" node tests/web/browser.js build/web "$out/camera.y4m" "$out" "${video[@]}"
