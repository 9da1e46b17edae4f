#!/usr/bin/env python3
"""Opens the reports of three short runs in headless Chromium as a person would, at desktop and phone width, light and
dark: every chart holds data and ink, nothing is cut off, hovering, dragging and clicking do what the page says, and
the page asks for nothing from elsewhere. Pictures of the page go to OUT.

usage: page_test.py CAIRN_SIM OUT [REPORT.html...]     (further reports of your own)
"""
import math
import pathlib
import re
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from chromium import Chromium, find_chromium  # noqa: E402

SKIPPED = 77
WIDTHS = {"desktop": dict(width=1280, height=900), "phone": dict(width=390, height=844, phone=True, dark=True)}
VEHICLE = {"latency", "path", "error", "registration", "map", "consistency", "health"}
HANDHELD = {"latency", "path", "map", "health"}
LANDMARKS = {"latency", "path", "error", "map", "consistency"}
# Pixels of a chart's canvas that are not the background, and how many values its data hold.
CHARTS = """Object.entries(charts).map(([name, {u}]) => {
  const c = u.ctx.canvas, pixels = u.ctx.getImageData(0, 0, c.width, c.height).data;
  let ink = 0;
  for (let i = 3; i < pixels.length; i += 4) ink += pixels[i] > 0;
  const columns = name === "path" ? u.data[1] : u.data.slice(1);
  const values = columns.map((column) => column.filter((v) => v !== null).length);
  const box = u.root.getBoundingClientRect();
  return {name, ink: ink / (c.width * c.height), values, left: box.left, right: box.right};
})"""

failures = 0


def check(good, what):
    global failures
    print("good" if good else "BAD ", what)
    failures += not good


def centre(page, chart):
    page.value(f"document.querySelector('[data-chart={chart}]').scrollIntoView({{block: 'center'}})")
    box = page.value(f"(({{left, top, width, height}}) => [left, top, width, height])"
                     f"(charts.{chart}.u.over.getBoundingClientRect())")
    return box[0] + box[2] / 2, box[1] + box[3] / 2, box[2]


def use(page, name):
    """Hover, zoom and seek on the latency chart."""
    x, y, width = centre(page, "latency")
    page.mouse("mouseMoved", x, y)
    legend = page.value("charts.latency.u.root.querySelector('.u-legend').textContent")
    check(re.search(r"frame:?\s*[0-9.]+ ms", legend), f"{name}: hovering shows the frame's time: {legend[-60:]}")
    check(page.value("charts.map.u.cursor.left") > 0, f"{name}: the cursor is at the same time in every chart")
    page.mouse("mousePressed", x, y, button="left", clickCount=1)
    page.mouse("mouseReleased", x, y, button="left", clickCount=1)
    frames = page.value("run.t.length")
    check(0.3 * frames < page.value("present") < 0.7 * frames, f"{name}: a click goes to the frame")
    if page.value("video !== null"):
        off = page.value("Math.abs(video.currentTime * run.video_rate - present - 0.5)")
        check(off < 0.6, f"{name}: and the video with it")
    page.drag(x - width / 4, y, x + width / 4, y)
    spans = page.value("['latency', 'map'].map((n) => charts[n].u.scales.x.max - charts[n].u.scales.x.min)")
    whole = page.value("run.t[run.t.length - 1]")
    check(all(0.4 * whole < s < 0.6 * whole for s in spans), f"{name}: dragging zooms every chart: {spans} of {whole}")
    page.value("document.getElementById('all').click()")
    page.value("document.getElementById('scrubber').value = 3;"
               "document.getElementById('scrubber').dispatchEvent(new Event('input'))")
    check(page.value("present") == 3, f"{name}: the scrubber goes to a frame")
    check("frame" in page.value("document.getElementById('readout').textContent"), f"{name}: which is said")


def look(page, report, expected, out, name):
    for width, options in WIDTHS.items():
        title = f"{name}, {width}"
        page.open(report.as_uri(), **options)
        charts = {c["name"]: c for c in page.value(CHARTS)}
        check(expected <= set(charts), f"{title}: charts {sorted(charts)}")
        for chart in charts.values():
            full = all(v > 2 for v in chart["values"]) or chart["name"] == "health"
            check(full and chart["ink"] > 0.002, f"{title}: {chart['name']} holds {chart['values']}, ink {chart['ink']:.3f}")
            check(chart["left"] >= 0 and chart["right"] <= options["width"], f"{title}: {chart['name']} is not cut off")
        check(page.value("document.scrollingElement.scrollWidth <= window.innerWidth"), f"{title}: no wider than the page")
        dark = page.value("getComputedStyle(document.body).backgroundColor") != "rgb(255, 255, 255)"
        check(dark == bool(options.get("dark")), f"{title}: dark where it is wanted")
        check(page.value("performance.getEntriesByType('resource').filter((e) => !e.name.startsWith('data:')"
                         " && !e.name.startsWith('file:')).length") == 0, f"{title}: nothing from elsewhere")
        if page.value("video !== null"):
            page.value("new Promise((done) => video.readyState > 1 ? done() : "
                       "['loadeddata', 'error'].forEach((e) => video.addEventListener(e, done)))")
            check(page.value("video.videoWidth") > 0, f"{title}: the video plays")
        page.screenshot(out / f"{name}-{width}.png")
        use(page, title)
    check(not page.errors, f"{name}: no error on the page: {page.errors}")


def write_recording(folder):
    """A robot that drives past three posts, in the layout of lost-in-the-woods."""
    folder.mkdir(parents=True, exist_ok=True)
    odometry = [f"{k / 10},0.5,0,{k / 20},0,0,1" for k in range(60)]
    (folder / "odom_gt.csv").write_text("\n".join(
        ["t_s,v_mps,om_radps,x_true_m,y_true_m,th_true_rad,true_valid", *odometry, ""]))
    seen = [(k / 10, i, 2 * i - k / 20 - 0.219, i - 2) for k in range(60) for i in (1, 2, 3)]
    (folder / "obs.csv").write_text("\n".join(
        ["t_s,landmark_id(1..17),range_m,bearing_rad",
         *(f"{t},{i},{math.hypot(x, y):.6f},{math.atan2(y, x):.6f}" for t, i, x, y in seen), ""]))
    (folder / "landmarks.csv").write_text("landmark_id,x_m,y_m\n1,2,-1\n2,4,0\n3,6,1\n")


def main():
    program = find_chromium()
    if program is None:
        print("skipped: no Chromium (Debian: chromium)")
        return SKIPPED
    sim, out, *own = sys.argv[1:]
    out = pathlib.Path(out)
    runs = {"vehicle": ["hall-small", "--max-frames", "60"],
            "handheld": ["hall-small", "--mode", "handheld", "--max-frames", "60", "--no-video"],
            "landmarks": [f"lost-in-the-woods:{out / 'recording'}"]}
    write_recording(out / "recording")
    for name, arguments in runs.items():
        shutil.rmtree(out / name, ignore_errors=True)
        subprocess.run([sim, "run", *arguments, "--out", str(out / name)], check=True, stdout=subprocess.DEVNULL)
    with Chromium(program) as page:
        look(page, (out / "vehicle/report.html").resolve(), VEHICLE, out, "vehicle")
        look(page, (out / "handheld/report.html").resolve(), HANDHELD, out, "handheld")
        look(page, (out / "landmarks/report.html").resolve(), LANDMARKS, out, "landmarks")
        for report in own:
            look(page, pathlib.Path(report).resolve(), {"latency", "map"}, out, pathlib.Path(report).parent.name)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
