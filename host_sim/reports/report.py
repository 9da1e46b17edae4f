"""Makes report.html of a run: python3 report.py FOLDER. Reads only the run's own files."""
import base64
import contextlib
import csv
import errno
import html
import json
import math
import os
import sys

PAGE = {"css": "page/report.css", "charts": "page/charts.js", "page": "page/report.js",
        "uplot_css": "../third_party/uPlot/uPlot.min.css",
        "uplot": "../third_party/uPlot/uPlot.iife.min.js", "uplot_licence": "../third_party/uPlot/LICENSE"}
STAGES = [
    ("preprocess", "image preprocessing", 1.20, 1.20),
    ("pose_prediction", "camera pose estimation", 23.05, 19.26),
    ("features", "feature extraction and matching", 6.40, 6.40),
    ("pose_update", "camera pose calculation", 9.70, 9.70),
    ("render", "rendering and registration", 1.22, 1.22),
]
MOST_INLINE_VIDEO = 16 * 1024 * 1024  # larger ones stay beside the page
MOST_ELLIPSES = 60
GRADES = {"Tracked well": "well", "Not tracked": "failed"}  # by headline; all others are in between
ALIGNED = {"start": "from the start", "sim3": "best similarity", "se2": "best fit"}
CANNOT_WRITE = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EACCES, errno.EPERM, errno.EIO}


@contextlib.contextmanager
def whole_file(path):
    """A text file that gets its name when it is complete."""
    part = path + ".part"
    try:
        with open(part, "w", encoding="utf-8") as file:
            yield file
        os.replace(part, path)
    except BaseException:
        if os.path.exists(part):
            os.remove(part)
        raise


def page_part(name):
    """A file of the page: carried along by cairn_sim (PARTS), else beside this script."""
    carried = globals().get("PARTS")
    if carried is not None:
        return carried[os.path.basename(PAGE[name])]
    here = os.path.dirname(os.path.abspath(__file__))
    with open(os.path.join(here, PAGE[name]), encoding="utf-8") as file:
        return file.read()


def read_csv(path):
    """Columns by name; {} where there are no rows."""
    if not os.path.exists(path):
        return {}
    with open(path, newline="") as file:
        rows = csv.reader(file)
        names = next(rows, [])
        columns = list(zip(*rows))
    return dict(zip(names, columns)) if columns else {}


def numbers(column, digits=4):
    return [rounded(float(v), digits) if v else None for v in column]


def rounded(value, digits=4):
    """So many significant digits: the page need not carry more than a screen shows."""
    if not math.isfinite(value):
        return None
    value = float(f"{value:.{digits}g}")
    return int(value) if value == int(value) and abs(value) < 1e15 else value


def read_tum(path):
    """{time in us: (x, y, z)} in order."""
    if not os.path.exists(path):
        return {}
    poses = {}
    with open(path) as file:
        for line in file:
            t, *pose = map(float, line.split())
            poses[round(1e6 * t)] = tuple(pose[:3])
    return poses


class Similarity:
    """Lays the estimate over the truth, as summary.json says; does nothing where it does not."""

    def __init__(self, trajectory):
        moved = trajectory.get("similarity") or {}
        self.scale = moved.get("scale", 1.0)
        self.shift = moved.get("translation", [0.0, 0.0, 0.0])
        w, x, y, z = moved.get("rotation", [1.0, 0.0, 0.0, 0.0])
        self.rotation = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]

    def point(self, p):
        return [self.scale * sum(r * v for r, v in zip(row, p)) + s for row, s in zip(self.rotation, self.shift)]

    def covariance(self, c):
        half = [[sum(row[k] * c[k][j] for k in range(3)) for j in range(3)] for row in self.rotation]
        return [[self.scale**2 * sum(half[i][k] * self.rotation[j][k] for k in range(3)) for j in range(3)]
                for i in range(3)]


def covariances(columns):
    """Of the position, by time in us; frames without one are left out."""
    result = {}
    names = [f"position_{axes}" for axes in ("xx", "xy", "xz", "yy", "yz", "zz")]
    if any(n not in columns for n in names):
        return result
    for t, *values in zip(columns["t_us"], *(columns[n] for n in names)):
        if values[0]:
            xx, xy, xz, yy, yz, zz = map(float, values)
            result[int(t)] = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    return result


def drawn_axes(points, planar):
    """The two axes in which the path is seen: from above, or those along which it is longest."""
    if planar:
        return 0, 1
    spread = [max(p[k] for p in points) - min(p[k] for p in points) for k in range(3)]
    return tuple(sorted(sorted(range(3), key=lambda k: -spread[k])[:2]))


def ellipse(c, a, b):
    """Half axes (3 sigma) and angle of the covariance in the plane of axes a and b."""
    mean, difference = (c[a][a] + c[b][b]) / 2, (c[a][a] - c[b][b]) / 2
    root = math.hypot(difference, c[a][b])
    angle = 0.5 * math.atan2(2 * c[a][b], c[a][a] - c[b][b])
    return [rounded(3 * math.sqrt(max(v, 0.0))) for v in (mean + root, mean - root)] + [rounded(angle)]


def trajectory_of(folder, summary, times):
    """What the page draws of the path; None where no pose was estimated."""
    estimate, truth = read_tum(folder + "/trajectory.tum"), read_tum(folder + "/truth.tum")
    if not estimate:
        return None
    planar = summary["trajectory"]["aligned"] == "start" or summary["config_mode"] == "vehicle"
    moved = Similarity(summary["trajectory"])
    points = {t: moved.point(p) for t, p in estimate.items()}
    a, b = drawn_axes(list((truth or points).values()), planar)
    spread = covariances(read_csv(folder + "/uncertainty.csv"))
    frame_of = {t: i for i, t in enumerate(times)}
    at, error, sigma = [], [None] * len(times), [None] * len(times)
    for t, p in points.items():
        i = frame_of.get(t)
        if i is None:
            continue
        at.append([i, rounded(p[a]), rounded(p[b])])
        if t in truth:
            error[i] = rounded(math.dist(p[:2], truth[t][:2]) if planar else math.dist(p, truth[t]))
        if t in spread:
            c = moved.covariance(spread[t])
            sigma[i] = rounded(math.sqrt(max(c[0][0] + c[1][1] + c[2][2], 0.0)))
    step = max(1, len(at) // MOST_ELLIPSES)
    ellipses = [[x, y] + ellipse(moved.covariance(spread[times[i]]), a, b)
                for i, x, y in at[::step] if times[i] in spread]
    landmarks = read_csv(folder + "/landmarks.csv")
    marks = [] if not landmarks else [
        moved.point([float(v) for v in p]) for p in zip(landmarks["x"], landmarks["y"], landmarks["z"])]
    return {
        "axes": ["xyz"[a], "xyz"[b]], "unit": "m" if planar or truth else "map units",
        "flip": not planar and not truth and (a, b) == (0, 1),  # the first camera's y points down
        "estimate": at,
        "truth": [[rounded(p[a]), rounded(p[b])] for p in truth.values()],
        "landmarks": [[rounded(p[a]), rounded(p[b])] for p in marks],
        "ellipses": ellipses, "error": error, "sigma": sigma}


def events_of(folder, frames):
    """Counters of health that grew, by name: [index of the frame, by how much]."""
    rows, index = {}, {int(n): i for i, n in enumerate(frames["frame"])}
    columns = read_csv(folder + "/health.csv")
    for frame, name, grew in zip(*(columns.get(k, ()) for k in ("frame", "counter", "grew"))):
        rows.setdefault(name, []).append([index[int(frame)], int(grew)])
    return rows


def data_of(folder, summary):
    """All that the charts draw."""
    frames, tracking = read_csv(folder + "/frames.csv"), read_csv(folder + "/tracking.csv")
    spread = read_csv(folder + "/uncertainty.csv")
    if not frames:
        return None
    times = [int(t) for t in frames["t_us"]]
    angle = [None if v is None else rounded(math.degrees(v)) for v in numbers(spread.get("attitude_sigma_rad", ()))]
    return {
        "frame": [int(n) for n in frames["frame"]],
        "t": [round(1e-6 * (t - times[0]), 4) for t in times],
        "stages": [{"name": name, "ms": numbers(frames[key + "_ms"]), "budget": iekf}
                   for key, name, iekf, _ in STAGES],
        "total": numbers(frames["total_ms"]),
        "budget": summary["latency_ms"]["budget"],
        "registration": numbers(frames["registration_px"]),
        "corners": numbers(frames["corners"]), "matches": numbers(frames["matches"]),
        "inliers": numbers(frames["inliers"]), "landmarks": numbers(frames["landmarks"]),
        "state": list(tracking["state"]),
        "nis": [n / d if d and n is not None else None
                for n, d in zip(numbers(tracking["nis"]), numbers(tracking["nis_dof"]))],
        "nees": numbers(tracking["nees"]),
        "score": numbers(spread.get("health_score", ())), "angle": angle,
        "events": events_of(folder, frames),
        "path": trajectory_of(folder, summary, times),
        "video_rate": summary["video"]["rate_hz"] if summary.get("video") else None,
        "pictures": [int(name[8:-4]) for name in summary["pictures"]]}


def shown(text):
    return html.escape(str(text))


def value(number, digits=2, unit=""):
    return "&ndash;" if number is None else f"{number:.{digits}f}{unit}"


def bar(ms, budget):
    """A bar of a time against its budget, at most twice the budget long."""
    share = ms / budget if budget > 0 else 0.0
    over = " over" if share > 1 else ""
    return (f"<span class='bar{over}' title='{ms:.2f} of {budget:.2f} ms'>"
            f"<i style='width:{min(50 * share, 100):.2f}%'></i></span>")


def stage_table(summary):
    latency = summary["latency_ms"]
    rows = [(f"<i class='stage s{i}'></i>{name}", latency["stages"][key], iekf, ekf, iekf)
            for i, (key, name, iekf, ekf) in enumerate(STAGES)]
    rows.append(("<b>whole frame</b>", latency, 41.57, 37.78, latency["budget"]))
    cells = "".join(
        f"<tr><td>{name}</td>" + "".join(f"<td>{s[k]:.3f}</td>" for k in ("p50", "p95", "p99", "max"))
        + f"<td>{bar(s['p99'], budget)}</td><td>{100 * s['over_budget']:.2f} %</td>"
          f"<td>{iekf:.2f}</td><td>{ekf:.2f}</td></tr>" for name, s, iekf, ekf, budget in rows)
    return ("<div class='scrolled' tabindex='0'><table><tr><th>per frame, ms</th><th>p50</th><th>p95</th><th>p99</th>"
            "<th>max</th><th>p99 against budget</th><th>over</th><th>paper IEKF</th><th>paper EKF</th></tr>"
            + cells + "</table></div>")


def verdict(summary):
    points = "".join(f"<li class='{shown(p['grade'])}'>{shown(p['text'])}</li>"
                     for p in summary["verdict"]["points"])
    headline = summary["verdict"]["headline"]
    return (f"<div class='judged {GRADES.get(headline, 'fair')}'><h2 class='headline'>{shown(headline)}</h2>"
            f"<ul class='verdict'>{points}</ul></div>")


def title_of(source):
    """The kind of source and the last part of its path: where a user keeps it is nobody's concern."""
    kind, colon, rest = source.partition(":")
    return kind + colon + (rest.rstrip("/").rsplit("/", 1)[-1])


def cards(summary):
    t, r, l = summary["trajectory"], summary["registration_px"], summary["latency_ms"]
    travel = summary.get("travel")
    items = [
        ("frames tracked", f"{summary['tracked']} of {summary['frames']}"),
        ("latency, median / 99 %", f"{l['p50']:.2f} / {l['p99']:.2f} ms"),
        ("frames over the budget", f"{100 * l['over_budget']:.2f} %"),
        ("registration error, mean / max", r["mean"] is not None
         and value(r["mean"], 2) + " / " + value(r["max"], 2, " px")),
        (f"trajectory error, rms ({ALIGNED.get(t['aligned'], t['aligned'])})", t["ate_rmse_m"] is not None
         and value(t["ate_rmse_m"], 3, " m")),
        ("rotation error, rms", t["rotation_rmse_deg"] is not None and value(t["rotation_rmse_deg"], 2, "&deg;")),
        ("NEES (3 is consistent)", summary["nees"]["mean"] is not None and value(summary["nees"]["mean"], 2)),
        ("NIS / degrees of freedom", summary["nis"]["mean"] is not None
         and f"{value(summary['nis']['mean'], 1)} / {value(summary['nis']['dof'], 1)}"),
        ("drives to the left of the mount's axis", travel and value(travel["left_deg"], 2) + " &plusmn; "
         + value(travel["sigma_deg"], 2, "&deg;")),
        ("landmarks in the map", f"{summary['map']['landmarks']} of {summary['map']['capacity']}"),
    ]
    return card_row(items)


def card_row(items):
    """A card for each (name, value) that has a value."""
    return "<div class='cards'>" + "".join(
        f"<div><b>{v}</b><span>{shown(k)}</span></div>" for k, v in items if v) + "</div>"


def inlined(path, kind):
    with open(path, "rb") as file:
        return f"data:{kind};base64,{base64.b64encode(file.read()).decode()}"


def picture(folder, name):
    frame = int(name[8:-4])
    return (f"<figure data-frame='{frame}'><img alt='frame {frame}' src='{inlined(f'{folder}/{name}', 'image/jpeg')}'>"
            f"<figcaption>frame {frame}</figcaption></figure>")


SCRUBBER = (
    "<div class='scrub'><button id='play' type='button' aria-label='play or pause'>▶</button>"
    "<input id='scrubber' type='range' min='0' value='0' step='1' aria-label='frame'>"
    "<span class='zoom'><button id='nearer' type='button' aria-label='zoom in'>+</button>"
    "<button id='wider' type='button' aria-label='zoom out'>−</button>"
    "<button id='all' type='button'>all</button></span></div><p id='readout' class='muted'></p>")


def player(folder, summary):
    """The video, its scrubber, and the pictures of this run."""
    parts = ["<h2>What a user sees</h2><div id='player'>"]
    video = summary.get("video")
    if video and video["file"].endswith(".mp4"):
        path = f"{folder}/{video['file']}"
        inside = os.path.getsize(path) <= MOST_INLINE_VIDEO
        parts.append("<video id='video' playsinline muted controls preload='auto' "
                     f"src='{inlined(path, 'video/mp4') if inside else shown(video['file'])}'></video>"
                     f"<p id='no-video' hidden>The video <code>{shown(video['file'])}</code> cannot be played here"
                     f"{'' if inside else ': keep it in the same folder as this page'}.</p>")
    parts.append(SCRUBBER + "</div>")
    if summary["pictures"]:
        parts += ["<div class='frames'>", *(picture(folder, name) for name in summary["pictures"]), "</div>"]
    return "".join(parts)


CHARTS = [
    ("latency", "Latency", "<p class='muted'>Over: the share of frames above the paper's row (stages) or above the "
     "budget (whole frame). The paper's columns are its Table 1, on its desktop PC."
     " <label><input type='checkbox' id='to-budget'> chart up to the budget</label></p>"),
    ("path", "Trajectory", "<p class='muted' id='path-note'></p>"),
    ("error", "Position: what the filter says of itself", ""),
    ("registration", "Registration error", "<p class='muted'>Mean distance between the true pixel of anchored scene "
     "points and where the estimated pose puts them.</p>"),
    ("map", "Map and matches", ""),
    ("consistency", "Consistency", "<p class='muted'>NIS over its degrees of freedom, and NEES over 3: 1 is "
     "consistent.</p>"),
    ("health", "Health", "<p class='muted'>Where a counter grew. Score: below 1 is healthy.</p>"),
]


def chart_sections(names, before=None):
    """The sections of these charts; `before` has what stands above a chart, by its name."""
    parts = []
    for name, heading, note in CHARTS:
        if name in names:
            parts.append(f"<section id='{name}'><h2>{heading}</h2>{(before or {}).get(name, '')}"
                         f"<div class='chart' data-chart='{name}'></div>{note}</section>")
    return parts


def ending(manifest, summary):
    """Health, and how the run was made."""
    health = "".join(f"<div><span>{shown(k.replace('_', ' '))}</span><b>{shown(v)}</b></div>"
                     for k, v in summary["health"].items())
    return [f"<details><summary>Every counter of health</summary><div class='health'>{health}</div></details>",
            "<h2>How this was made</h2>"
            f"<p><code>{shown(manifest['command'])}</code></p>"
            f"<p class='muted'>cairn {shown(manifest['version'])} &middot; {shown(manifest['compiler'])}"
            f" &middot; {shown(manifest['cpu'])}<br>log hash <code>{shown(summary['log_hash'])}</code>"
            "<br>Charts: uPlot, MIT licence (in this page's source). Drag to zoom, double-click for all, click to "
            "go to a frame.</p>"]


def beginning(manifest):
    config = manifest["config"]
    return (f"<header><h1>{shown(title_of(manifest['source']['name']))}</h1>"
            f"<p class='muted'>{shown(config['mode'])} &middot; {shown(config['filter'])}"
            f" &middot; seed {shown(manifest['seed'])}"
            f" &middot; {shown(manifest['source']['note'] or 'no assumptions')}</p></header>")


def read_json(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def write_page(folder, manifest, parts, data):
    """report.html: `parts` of its body, and `data` for its charts."""
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    with whole_file(folder + "/report.html") as file:
        file.write("<!doctype html><html lang='en'><meta charset='utf-8'><meta name='viewport' "
                   "content='width=device-width, initial-scale=1'>"
                   f"<title>Cairn: {shown(title_of(manifest['source']['name']))}</title>"
                   f"<style>{page_part('uplot_css')}{page_part('css')}</style>" + "\n".join(parts)
                   + f"<!--\nuPlot:\n{page_part('uplot_licence')}-->"
                   f"<script type='application/json' id='data'>{text}</script>"
                   + "".join(f"<script>{page_part(name)}</script>" for name in ("uplot", "charts", "page"))
                   + "</html>\n")


def main(folder):
    summary, manifest = read_json(folder + "/summary.json"), read_json(folder + "/manifest.json")
    summary["config_mode"] = manifest["config"]["mode"]
    parts = [beginning(manifest), verdict(summary), cards(summary), player(folder, summary),
             *chart_sections([name for name, _, _ in CHARTS], {"latency": stage_table(summary)}),
             *ending(manifest, summary)]
    write_page(folder, manifest, parts, data_of(folder, summary))


if __name__ == "__main__":
    try:
        main(sys.argv[1])
    except OSError as problem:
        if problem.errno not in CANNOT_WRITE:
            raise
        sys.stderr.write(f"cannot be written: {problem.strerror}\n")
        sys.exit(5)  # as host_sim/io/python_script.cpp knows it
