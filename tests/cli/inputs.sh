#!/usr/bin/env bash
# Inputs as the field writes them run, and what was made of them is said.
. "$(dirname "$0")/support.sh"

# picture FILE WIDTH HEIGHT: a grey picture without any tool.
picture() {
  { printf 'P5\n%s %s\n255\n' "$2" "$3"; head -c $(($2 * $3)) /dev/zero | tr '\0' 'd'; } >"$1"
}
camera() { # FILE WIDTH HEIGHT
  printf 'fx: 900\nfy: 900\ncx: %s\ncy: %s\nwidth: %s\nheight: %s\n' $(($2 / 2)) $(($3 / 2)) "$2" "$3" >"$1"
}
has() { # FILE TEXT
  grep -qF -- "$2" "$work/$1" || { echo "FAIL: '$2' is not in $1"; failures=$((failures + 1)); }
}

# pictures that are larger than the tracker holds, in width or height
for size in "1920 1080 1280x720" "1080 1920 540x960"; do
  set -- $size
  mkdir -p "$work/large"
  for n in 0 1; do picture "$work/large/$n.pgm" "$1" "$2"; done
  camera "$work/large.yaml" "$1" "$2"
  expect 0 "pictures scaled from $1x$2 to $3|1280x960" \
    run video:large --camera large.yaml --no-video --out "large-out-$1"
  has "large-out-$1/manifest.json" "scaled from $1x$2 to $3"
done
expect 0 "frames 2" run video:large --camera large.yaml --scale 0.25 --no-video --out small-out
has small-out/manifest.json "scaled from 1080x1920 to 270x480"

# a path without the kind of source
expect 0 "large: taken as video:large|frames 2" \
  run large --camera large.yaml --scale 0.25 --no-video --out path-out
mkdir -p "$work/sets"/{euroc/mav0,kitti/image_0,kitti-raw/oxts,tum,scenes,board}
touch "$work/sets/tum/rgb.txt" "$work/sets/scenes/frame-000000.pose.txt" "$work/sets/board/cMo_grid.csv"
for set in euroc=euroc kitti=kitti kitti-raw=kitti tum=tum-rgbd scenes=seven-scenes board=tag-board; do
  folder=sets/${set%=*}
  expect 3 "$folder: taken as ${set#*=}:$folder" run "$folder" --out set-out
done

# names in upper case that are times, and odometry from a spreadsheet on their clock
mkdir -p "$work/DCIM"
camera "$work/camera.yaml" 320 240
for n in 1700000000.10 1700000000.15 1700000000.20; do picture "$work/DCIM/$n.PGM" 320 240; done
printf '\xef\xbb\xbf"time [ms]";"Speed (km/h)";"yaw rate (deg/s)"\r\n1700000000050,0;3,6;0\r\n1700000000150,0;3,6;0\r\n1700000000200,0;3,6;0\r\n' \
  >"$work/odometry.csv"
expect 0 "frames 3" run video:DCIM --camera camera.yaml --odometry odometry.csv --no-video --out times-out
has times-out/frames.csv "2,1700000000200000,"
has times-out/manifest.json "times from the names of the pictures (s)"
has times-out/summary.json '"damaged": false'

# odometry that ends before the frames do: run, and said
mkdir -p "$work/pictures"
for n in $(seq 0 29); do picture "$work/pictures/$n.pgm" 320 240; done
printf 't_s,speed_mps,yaw_rate_radps\n0,1,0\n0.1,1,0\n0.2,1,0\n' >"$work/short.csv"
expect 0 "warning: short.csv: covers 31 %" \
  run video:pictures --camera camera.yaml --odometry short.csv --no-video --out short-out
has short-out/summary.json "covers 31 %"
finish
