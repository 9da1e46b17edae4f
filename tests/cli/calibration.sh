#!/usr/bin/env bash
# Calibration on the command line: boards to print, what is refused, and a video without calibration.
. "$(dirname "$0")/support.sh"

expect 0 "board in board.png|--squares 9x6" calibrate --write-board board.png --squares 9x6
[ -s "$work/board.png" ] || fail "no board"
expect 2 "board.png|--force" calibrate --write-board board.png
expect 0 "board in marked.png" calibrate --write-board marked.png --board charuco --squares 9x6
mkdir "$work/pictures"
cp "$work/board.png" "$work/pictures/a.png"
expect 3 "boards in 1 of 1 pictures|of 4 or more that are needed" \
  calibrate pictures --squares 9x6 --out camera.yaml
expect 3 "expected a chessboard of 10x7 squares, found none in 1 pictures|not the corners between them" \
  calibrate pictures --out camera.yaml
expect 3 "expected a charuco of 9x6 squares, found none in 1 pictures|--dictionary 4X4_50|--marker-ratio 0.75" \
  calibrate pictures --board charuco --squares 9x6 --dictionary 4X4_50 --out camera.yaml
expect 3 "nowhere" calibrate nowhere --out camera.yaml
[ ! -e "$work/camera.yaml" ] || fail "a camera file without boards"
expect 2 "MEDIA" calibrate --out camera.yaml
expect 2 "--out" calibrate pictures
expect 2 "--squares '9by6'|10x7" calibrate pictures --squares 9by6 --out camera.yaml
expect 2 "3 to 60" calibrate pictures --squares 2x9 --out camera.yaml
expect 2 "--dictionary" calibrate pictures --board charuco --dictionary 9X9 --out camera.yaml
expect 2 "50|markers" calibrate pictures --board charuco --squares 20x20 --dictionary 4X4_50 --out camera.yaml
touch "$work/there.yaml"
expect 2 "there.yaml|--force" calibrate pictures --out there.yaml

# without a calibration: a guess, said on standard error, in the summary and in the manifest
mkdir "$work/frames"
for n in 0 1 2; do
  { printf 'P5\n320 240\n255\n'; head -c 76800 /dev/zero | tr '\0' 'd'; } >"$work/frames/$n.pgm"
done
expect 0 "warning: no calibration|277 px|guess|--hfov 60" run video:frames --hfov 60 --no-video --out guessed
grep -q "guess by --hfov 60" "$work/guessed/summary.json" || fail "the summary does not say that the camera is guessed"
grep -q "guess by --hfov 60" "$work/guessed/manifest.json" || fail "the manifest does not say it"
grep -q '"told_sigma": 0.2' "$work/guessed/summary.json" || fail "the tracker does not know that the camera is guessed"
expect 2 "--camera|--hfov" run video:frames --out none
printf 'fx: 277\nfy: 277\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\nfocal_sigma: 0.0125\n' >"$work/known.yaml"
expect 0 "log hash" run video:frames --camera known.yaml --no-video --out known
grep -q '"told_sigma": 0.0125' "$work/known/summary.json" || fail "the tracker does not know the file's focal_sigma"
expect 2 "--hfov" run video:frames --hfov 170 --out none
expect 2 "--hfov: source 'hall'" run hall --hfov 60 --out none

# a part of the pictures
expect 0 "log hash" run video:frames --hfov 60 --crop 200x100 --no-video --out cropped
grep -q "cropped to 200x100+60+70" "$work/cropped/manifest.json" || fail "the manifest does not name the crop"
expect 0 "per frame, ms" timing video:frames --hfov 60 --crop 200x100 --counted-frames 0 --out timed
expect 3 "expected more than the 90 frames" inject video:frames --hfov 60 --crop 200x100 --brief
expect 2 "no odometry" check-mount video:frames --hfov 60 --crop 200x100
expect 0 "results in" robustness video:frames --hfov 60 --crop 200x100 --windows 3,3 --out windows
expect 2 "--hfov: source 'hall-small'" timing hall-small --hfov 60 --out none
expect 2 "--crop '200'" run video:frames --hfov 60 --crop 200 --out none
expect 2 "--crop 400x100|320x240" run video:frames --hfov 60 --crop 400x100 --out none
finish
