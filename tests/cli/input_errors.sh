#!/usr/bin/env bash
# Inputs that are unreadable or invalid: exit code 3, and a message that names file, line or key and
# says what was expected. Nothing is left in the output folder.
. "$(dirname "$0")/support.sh"

# A 32x24 grey picture without any tool: binary PGM.
picture() {
  { printf 'P5\n32 24\n255\n'; head -c 768 /dev/zero | tr '\0' 'd'; } >"$1"
}
mkdir -p "$work/pictures"
for n in 3 4 5; do picture "$work/pictures/$n.pgm"; done
cat >"$work/camera.yaml" <<'YAML'
fx: 30
fy: 30
cx: 16
cy: 12
width: 32
height: 24
YAML

# wrong paths
expect 3 "nowhere: no such folder" run seven-scenes:nowhere --out out
expect 3 "nowhere: no such folder" run tag-board:nowhere --out out
expect 3 "nowhere: no such folder" run kitti:nowhere --out out
expect 3 "nowhere: no such folder" run tum-rgbd:nowhere --out out
expect 3 "nowhere|no such file|expected a video file or a folder" \
  run video:nowhere --camera camera.yaml --out out
expect 3 "none.yaml: no such file" run video:pictures --camera none.yaml --out out

# a camera file without focal length, and one that is no YAML
grep -v fx "$work/camera.yaml" >"$work/no_focal.yaml"
expect 3 "no_focal.yaml|'fx'|missing|focal length" \
  run video:pictures --camera no_focal.yaml --out out
printf '%%YAML:1.0\nimage_width: 32\nimage_height: 24\n' >"$work/no_matrix.yaml"
expect 3 "no_matrix.yaml|'camera_matrix'|missing|focal length" \
  run video:pictures --camera no_matrix.yaml --out out
printf 'a: [1, 2\n' >"$work/broken.yaml"
expect 3 "broken.yaml:|expected YAML" run video:pictures --camera broken.yaml --out out

# a CSV with a bad line
printf 't_s,speed_mps,yaw_rate_radps\n0.0,1,0\n0.1,fast,0\n' >"$work/odometry.csv"
expect 3 "odometry.csv:3|speed_mps|expected a number, found 'fast'" \
  run video:pictures --camera camera.yaml --odometry odometry.csv --out out
digits=$(printf '9%.0s' $(seq 309))
printf 't_s,speed_mps,yaw_rate_radps\n0.0,1,0\n0.1,%s,0\n' "$digits" >"$work/odometry.csv"
expect 3 "odometry.csv:3|speed_mps|expected a number of 2.3e-308 to 1.7e308|'99999999... (309 digits)'" \
  run video:pictures --camera camera.yaml --odometry odometry.csv --out out
sed "s/^fx: .*/fx: $digits/" "$work/camera.yaml" >"$work/long.yaml"
expect 3 "long.yaml|'fx'|2.3e-308 to 1.7e308|'99999999... (309 digits)'" \
  run video:pictures --camera long.yaml --out out
printf 'frame,t_us\n3,100\n4,90\n' >"$work/times.csv"
expect 3 "times.csv:3|increasing" \
  run video:pictures --camera camera.yaml --times times.csv --out out
printf 'frame,when\n3,100\n' >"$work/times.csv"
expect 3 "times.csv:1|column 't_s'" \
  run video:pictures --camera camera.yaml --times times.csv --out out
printf '0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0\n' >"$work/truth.tum"
expect 3 "truth.tum:2|expected 8 numbers" \
  run video:pictures --camera camera.yaml --truth truth.tum --out out

# recordings of another clock, and samples outside the domain
odometry() { printf 't_s,speed_mps,%s\n' "$1"; for i in 0 1 2 3; do printf '%s.%s,1,%s\n' "$2" "$i" "$3"; done; }
odometry yaw_rate_radps 1700000000 0 >"$work/epoch.csv"
expect 3 "epoch.csv|0.100 s to 0.167 s|1700000000.000 s to 1700000000.300 s" \
  run video:pictures --camera camera.yaml --odometry epoch.csv --out out
odometry yaw_rate_radps 0 200 >"$work/degrees.csv"
expect 3 "degrees.csv:2|yaw_rate_radps|rad/s|found 200" \
  run video:pictures --camera camera.yaml --odometry degrees.csv --out out
printf '1700000000 0 0 0 0 0 0 1\n1700000001 0 0 0 0 0 0 1\n' >"$work/epoch.tum"
expect 3 "epoch.tum|0.100 s to 0.167 s|1700000000.000 s" \
  run video:pictures --camera camera.yaml --truth epoch.tum --out out

# a drive that would not end
mkdir -p "$work/woods"
printf 't_s,v_mps,om_radps,x_true_m,y_true_m,th_true_rad,true_valid\n0,0,0,0,0,0,1\n1e15,0,0,0,0,0,1\n' \
  >"$work/woods/odom_gt.csv"
printf 't_s,landmark_id(1..17),range_m,bearing_rad\n0,1,1,0\n' >"$work/woods/obs.csv"
printf 'landmark_id,x_m,y_m\n1,1,1\n' >"$work/woods/landmarks.csv"
expect 3 "odom_gt.csv|604800 s|1e+15 s" run lost-in-the-woods:woods --out out

# a list that names files outside of its folder
mkdir -p "$work/tum"
printf '0 0 0 0 0 0 0 1\n' >"$work/tum/groundtruth.txt"
for file in ../pictures/3.pgm /etc/hostname rgb/../../x.png; do
  printf '1.0 %s\n' "$file" >"$work/tum/rgb.txt"
  expect 3 "rgb.txt:1|inside the list's folder|$file" \
    run tum-rgbd:tum --camera camera.yaml --out out
done

# images: cut short, of another size, no image at all
mkdir -p "$work/cut" "$work/text" "$work/scenes"
printf '\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x20\0\0\0\x18\x08\0\0\0\0' >"$work/cut/1.png"
expect 3 "cut/1.png|cut short" run video:cut --camera camera.yaml --out out
echo "no picture" >"$work/text/1.png"
expect 3 "text/1.png|expected an image" run video:text --camera camera.yaml --out out
sed 's/width: 32/width: 64/; s/cx: 16/cx: 32/' "$work/camera.yaml" >"$work/wide.yaml"
expect 3 "pictures/3.pgm|expected 64x24|found 32x24" \
  run video:pictures --camera wide.yaml --out out
cp "$work/cut/1.png" "$work/scenes/frame-000000.color.png"
expect 3 "frame-000000.pose.txt: no such file" run seven-scenes:scenes --out out
printf '1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n' >"$work/scenes/frame-000000.pose.txt"
expect 3 "frame-000000.color.png|cut short" run seven-scenes:scenes --out out
printf '1 0 0 0\n0 1 0\n0 0 1 0\n0 0 0 1\n' >"$work/scenes/frame-000000.pose.txt"
expect 3 "frame-000000.pose.txt:2|expected 4 numbers" run seven-scenes:scenes --out out

# no frame where frames were asked for
expect 3 "pictures|number 90 on" run video:pictures --camera camera.yaml --first-frame 90 --out out

# names that cannot be ordered
mkdir -p "$work/dates"
for n in 235958 235959; do picture "$work/dates/IMG_20240131_$n.pgm"; done
expect 3 "IMG_20240131_235958.pgm|date|rename" run video:dates --camera camera.yaml --out out

if [ -e "$work/out" ]; then
  fail "a refused run left files in --out"
fi
finish
