#!/usr/bin/env bash
# Every command that draws, with folders whose names a shell, Python, HTML or valgrind could take for
# something else: nothing of a name is run, the pictures arrive, and a report shows the name as text.
# Skipped, once all else is checked, where Python has no matplotlib.
. "$(dirname "$0")/support.sh"

names=("o'; touch X; echo '" '<script>"$(touch Y)"' '-5%p [a]*`touch Z`&amp;')
missing=""

# draws "FILE|FILE..." ARGUMENTS...: the command succeeds and leaves the files.
draws() {
  local file
  expect 0 "" "${@:2}"
  [[ "$output" =~ not\ made:.*(missing|has\ no\ matplotlib).* ]] && { missing=${BASH_REMATCH[0]}; return; }
  while IFS= read -r file; do
    [ -s "$work/$file" ] || fail "cairn_sim ${*:2}: no $file: $output"
  done < <(tr '|' '\n' <<<"$1")
}

# shows FOLDER: the report shows the command line as text, and nobody's elements but its own.
shows() {
  [ -z "$missing" ] || return
  python3 - "$work/$1" <<'PYTHON' || fail "$1/report.html does not show its command line as text"
import html.parser
import json
import pathlib
import sys

class Page(html.parser.HTMLParser):
    text, scripts = "", 0
    def handle_data(self, data):
        self.text += data
    def handle_starttag(self, tag, attrs):
        self.scripts += tag == "script"

folder, page = pathlib.Path(sys.argv[1]), Page()
text = (folder / "report.html").read_text(encoding="utf-8")
page.feed(text)
command = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))["command"]
own = 4 if 'id="data"' in text or "id='data'" in text else 0  # the data, and the charts' code
sys.exit(page.scripts != own or command not in page.text)
PYTHON
}

# A recording of a minute past three posts.
recording() {
  mkdir -p "$1"
  awk 'BEGIN { print "t_s,v_mps,om_radps,x_true_m,y_true_m,th_true_rad,true_valid"
    for (k = 0; k < 60; ++k) printf "%.1f,0.5,0,%.3f,0,0,1\n", k / 10, k / 20 }' >"$1/odom_gt.csv"
  awk 'BEGIN { print "t_s,landmark_id(1..17),range_m,bearing_rad"
    for (k = 0; k < 60; ++k) for (i = 1; i <= 3; ++i) {
      x = 2 * i - k / 20 - 0.219; y = i - 2
      printf "%.1f,%d,%.6f,%.6f\n", k / 10, i, sqrt(x * x + y * y), atan2(y, x) } }' >"$1/obs.csv"
  printf 'landmark_id,x_m,y_m\n1,2,-1\n2,4,0\n3,6,1\n' >"$1/landmarks.csv"
}

for name in "${names[@]}"; do
  draws "$name/report.html" run hall-small --max-frames 3 --no-video "--out=$name"
  # The manifest's command line is one that can be pasted: a shell finds the name in it again.
  command=$(python3 -c 'import json, shlex, sys
print(shlex.split(json.load(open(sys.argv[1]))["command"])[-1])' "$work/$name/manifest.json")
  [ "$command" = "--out=$name" ] || fail "the manifest's command has $command for --out=$name"
  shows "$name"
  draws "$name/timing.png" timing hall-small --max-frames 3 --counted-frames 2 "--out=$name"
  grep -q "callgrind wrote no counts" <<<"$output" && fail "no counts in $name"
  draws "$name/nees.png|$name/error.png|$name/field.png" \
    consistency --runs 1 --heading-variance 0 --filters group-iekf "--out=$name"
  draws "$name/yaw_error.png|$name/pitch_error.png|$name/angles.png|$name/fading.png" turntable \
    --experiment yaw10 --points --seeds 1 --condition "on axis, clean" --fading 1.000 "--out=$name"
  recording "$work/$name/recording"
  draws "$name/recorded/report.html" \
    run "lost-in-the-woods:$name/recording" "--out=$name/recorded"
  shows "$name/recorded"
  for shard in 1 2; do
    expect 0 "results in" consistency --runs 2 --heading-variance 0 --filters group-iekf \
      --shard $shard/2 "--out=./$name/$shard"
  done
  draws "$name/nees.png" merge "./$name/1" "./$name/2" "--out=$name"
done

# Names that were run would have left files, in the working folder or below.
for left in X Y Z; do
  [ -z "$(find "$work" -name $left)" ] || fail "a name was run: $(find "$work" -name $left)"
done
[ -z "$missing" ] || skip "$missing"
finish
