#!/usr/bin/env bash
# A gyroscope beside a video: on its clock, on another, in another unit; and samples made from true poses.
. "$(dirname "$0")/support.sh"

# Pictures that differ, 30 a second, and a gyroscope's samples over their time.
mkdir "$work/pictures"
for n in $(seq 0 29); do
  { printf 'P5\n64 48\n255\n'; head -c 3072 /dev/zero | tr '\0' "\\$(printf %o $((64 + n)))"; } >"$work/pictures/$n.pgm"
done
printf 'fx: 60\nfy: 60\ncx: 32\ncy: 24\nwidth: 64\nheight: 48\n' >"$work/camera.yaml"
samples() { # FILE HEADER FIRST STEP: 240 rows, the time of each times STEP after FIRST
  { echo "$2"; for k in $(seq 0 239); do echo "$(($3 + k * $4)),0,0,0.1"; done; } >"$work/$1"
}
header=t_us,wx_radps,wy_radps,wz_radps
samples own.csv $header -100000 5000
samples epoch.csv t,wx,wy,wz 1700000000000000 5000
samples milliseconds.csv t,wx,wy,wz 0 5
samples half.csv $header -700000 5000
run() { run_code=$1 run_texts=$2; shift 2; expect "$run_code" "$run_texts" run video:pictures --camera camera.yaml --gyro-rotation 1,0,0,0 --no-video --force --out out "$@"; }

run 0 "frames 30|gyroscope: 213 samples" --gyro own.csv
run 3 "epoch.csv: expected times on the clock of the frames|0.000 s to 0.967 s|1700000000.000 s" --gyro epoch.csv
run 3 "milliseconds.csv: expected steps of 0.0001 s to 0.05 s in the gyroscope, found 5 s|unit" --gyro milliseconds.csv
run 0 "warning: half.csv: covers 53 % of the frames' time" --gyro half.csv
for bad in "--gyro-noise nan" "--gyro-bias inf" "--gyro-time-sigma 2" "--focal-sigma nan" "--scale nan" "--hfov nan"; do
  expect 2 "${bad% *}: expected a number from " run video:pictures --gyro own.csv $bad --out out
done

for k in $(seq 0 30); do echo "$((k / 10)).$((k % 10)) 0 0 0 0 0 0 1"; done >"$work/truth.tum"
expect 0 "601 samples in made.csv" simulate-gyro truth.tum --out made.csv
cp "$work/made.csv" "$work/before.csv"
expect 2 "--out made.csv: is there already|--force" simulate-gyro truth.tum --seed 2 --out made.csv
cmp -s "$work/made.csv" "$work/before.csv" || fail "a refused run changed the file"
expect 0 "601 samples" simulate-gyro truth.tum --seed 2 --force --out made.csv
expect 2 "--out: expected another file than TRUTH" simulate-gyro truth.tum --force --out truth.tum
expect 2 "--noise: expected a number from 0 to 1, found 'nan'" simulate-gyro truth.tum --noise nan --out other.csv
printf '0 0 0 0 0 0 0 1\n5 0 0 0 0 0 0 1\n' >"$work/slow.tum"
expect 3 "slow.tum: expected poses that follow one another in at most 0.2 s" simulate-gyro slow.tum --out slow.csv
[ ! -e "$work/slow.csv" ] || fail "a file without samples"
expect 0 "t_us,wx_radps" simulate-gyro truth.tum --out /dev/stdout
if [ -c /dev/full ]; then
  expect 4 "/dev/full: cannot be written" simulate-gyro truth.tum --out /dev/full
  [ -c /dev/full ] || fail "/dev/full is a file now"
fi
finish
