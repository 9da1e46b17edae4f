#!/usr/bin/env bash
# A camera that is watched: here a stream of JPEGs from this machine, as phones' camera apps serve it.
. "$(dirname "$0")/support.sh"

expect 2 "source camera|--camera|--hfov" run camera:0 --out none
expect 2 "--first-frame: source 'camera'" run camera:0 --hfov 60 --first-frame 3 --out none
expect 2 "--max-frames" timing camera:0 --hfov 60 --out none
[ -e /dev/video77 ] || expect 3 "camera:77: no camera: there is no /dev/video77" run camera:77 --hfov 60 --out none
expect 3 "camera:/dev/video78: no camera" run camera:/dev/video78 --hfov 60 --out none
expect 3 "camera:nowhere|/dev/video0|address" run camera:nowhere --hfov 60 --out none
expect 3 "no stream with pictures" run camera:http://127.0.0.1:9/x --hfov 60 --out none
expect 2 "source 'camera:': expected camera:DEVICE" run camera: --hfov 60 --out none

expect 0 "log hash" run hall-small --max-frames 12 --no-video --out pictures
cat >"$work/serve.py" <<'PYTHON'
import glob, http.server, sys, time

pictures = [open(name, "rb").read() for name in sorted(glob.glob(sys.argv[1] + "/overlay-*.jpg"))]

class Stream(http.server.BaseHTTPRequestHandler):
    def log_message(self, *_):
        pass
    def do_GET(self):
        self.send_response(200)
        self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=frame")
        self.end_headers()
        for n in range(40):
            jpeg = pictures[n % len(pictures)]
            try:
                self.wfile.write(b"--frame\r\nContent-Type: image/jpeg\r\nContent-Length: %d\r\n\r\n" % len(jpeg) + jpeg + b"\r\n")
            except OSError:  # who watches has seen enough
                return
            time.sleep(0.02)

with http.server.HTTPServer(("127.0.0.1", 0), Stream) as server:
    print(server.server_port, flush=True)
    server.serve_forever()
PYTHON
command -v python3 >/dev/null || skip "no python3"
exec {number}< <(exec python3 "$work/serve.py" "$work/pictures")
server=$!
trap 'kill "$server"; rm -rf "$work"' EXIT
read -r -t 20 -u "$number" port || skip "no server"
address=http://127.0.0.1:$port/
expect 0 "frames 10|no calibration" run "camera:$address" --hfov 60 --max-frames 10 --no-video --out watched
grep -q "times of arrival" "$work/watched/manifest.json" || fail "the manifest does not say where the times are from"
# a stream that ends: the run's files are complete, and it is said
expect 0 "frames 4|gave no more pictures after" run "camera:$address" --hfov 60 --no-video --out ended
[ -s "$work/ended/summary.json" ] || fail "no summary after the stream's end"
printf 'fx: 900\nfy: 900\ncx: 320\ncy: 240\nwidth: 640\nheight: 480\n' >"$work/other.yaml"
expect 3 "expected 640x480|found 320x240|does not offer" run "camera:$address" --camera other.yaml --out none
finish
