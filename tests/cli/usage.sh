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
# options that the source would ignore, and numbers that are none
for option in "--camera c.yaml" "--odometry o.csv" "--times t.csv" "--truth t.tum" "--profile plain"; do
  expect 2 "${option%% *}: source 'hall-small' does not use it" run hall-small $option --out out
done
expect 2 "--odometry: source 'kitti' does not use it" run kitti:. --odometry o.csv --out out
expect 2 "--odometry-noise: source 'video'" run video:. --odometry-noise s1 --out out
expect 2 "--first-frame: source 'stress'" run stress:noise --first-frame 3 --out out
expect 2 "--record: source 'mrclam'" run mrclam:.:1 --record r.log --out out
expect 2 "--camera: source 'hall'" timing --camera c.yaml --out out
expect 2 "--fading: only for --filter mono" run hall-small --max-frames 2 --fading 1.01 --out out
expect 2 "--filter window: vehicle mode runs with" run hall-small --filter window --max-frames 2 --out out
expect 2 "--filter ekf-fixed: vehicle mode runs with" \
  run hall-small --filter ekf-fixed --max-frames 2 --out out
expect 2 "--scalar|half" consistency --runs 1 --heading-variance 0 --scalar half --out out
expect 2 "filter 'reduced-jacobian-fixed': expected one of" \
  consistency --runs 1 --heading-variance 0 --filters reduced-jacobian --scalar fixed --out out
for option in "--fading 1.01" "--measurement freak" "--estimate-focal-length"; do
  expect 2 "${option%% *}|--filter" \
    run hall-small --mode handheld --max-frames 2 $option --out out
done
expect 2 "--focal-sigma: only for --filter window" \
  run hall-small --mode handheld --filter mono --focal-sigma 0.1 --max-frames 2 --out out
for filter in group-iekf-fixed lifted-iekf ekf; do
  expect 2 "--travel-sigma: --filter $filter has no state of the direction of travel" \
    run hall-small --filter $filter --travel-sigma 0.01 --max-frames 2 --out out
done
expect 2 "--travel-sigma: only for --mode vehicle" \
  run hall-small --mode handheld --travel-sigma 0.01 --max-frames 2 --out out
expect 2 "--travel-sigma: not with --record|input log" \
  run hall-small --travel-sigma 0.01 --record r.log --max-frames 2 --out out
expect 2 "--travel-sigma: source 'mrclam'" run mrclam:.:1 --travel-sigma 0.01 --out out
for sigma in -0.001 0.11 nan; do
  expect 2 "--travel-sigma|'$sigma'" run hall-small --travel-sigma $sigma --max-frames 2 --out out
done
expect 2 "--focal-sigma" run hall-small --mode handheld --focal-sigma 0.7 --max-frames 2 --out out
expect 2 "--start-position-variance|--mode vehicle" \
  run hall-small --mode handheld --start-position-variance 1 --max-frames 2 --out out
# numbers that nothing holds, of 309 digits
digits=$(printf '9%.0s' $(seq 309))
for option in --max-frames --work-limit --seed --budget-ms --scale --start-heading-variance --crop; do
  expect 2 "$option|(309 digits)" run hall-small "$option" "$digits" --out out
done
for command in "run hall-small" "timing" "turntable --experiment yaw10" "faults" "consistency"; do
  expect 2 "--seed|whole number from 0|'-3'" $command --seed -3 --out out
done
expect 2 "--budget-ms|above zero|'-1'" run hall-small --budget-ms -1 --out out
expect 2 "--scale" run hall-small --scale 2 --out out
expect 0 "F01  frames dropped|F24" inject --list
expect 2 "--fault F25|F01 to F24" inject --fault F25
expect 2 "--from" inject --from 0
expect 3 "expected more than the 90 frames" inject --brief --frames 80
expect 2 "--laps" laps --laps 0 --out out
expect 2 "--width" laps --width 321 --out out
expect 2 "--seeds" miscalibration --seeds 0 --out out
expect 3 "gt_imu.csv" run starry-night:nowhere --out out
expect 3 "nowhere" run tum-rgbd:nowhere --out out
expect 0 "cairn|capacities|landmarks" info
expect 0 "--first-frame" run --help
finish
