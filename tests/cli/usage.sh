#!/usr/bin/env bash
# Wrong command lines: exit code 2 and a message; help and info: 0.
. "$(dirname "$0")/support.sh"

expect 2 "subcommand" # nothing asked for
expect 2 "SOURCE" run --out out
expect 2 "--out" run hall
expect 2 "source 'castle'|hall-small|seven-scenes" run castle --out out
expect 2 "expected seven-scenes:DIR" run seven-scenes --out out
expect 2 "expected hall" run hall:here --out out
expect 2 "--filter" run hall --filter kalman --out out
expect 2 "--fading '0.5'" run hall-small --fading 0.5 --out out
expect 2 "--fading 'fast'" run hall-small --fading fast --out out
expect 2 "--max-frames" run hall-small --max-frames 0 --out out
expect 2 "camera file by --camera" run video:. --out out
expect 2 "--experiment 'yaw45'" turntable --experiment yaw45 --out out
expect 2 "--fading '0.9'" turntable --experiment yaw10 --fading 0.9 --out out
expect 2 "--condition 'fog'" turntable --experiment yaw10 --condition fog --out out
expect 2 "--seeds" turntable --experiment yaw10 --seeds 0 --out out
expect 2 "--corner-score" run starry-night:. --corner-score 20 --out out
expect 3 "gt_imu.csv" run starry-night:nowhere --out out
expect 3 "nowhere" run tum-rgbd:nowhere --out out
expect 0 "cairn|capacities|landmarks" info
expect 0 "--first-frame" run --help
finish
