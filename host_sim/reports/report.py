"""Makes report.html of a run: python3 report.py FOLDER. Reads only the run's own files."""
import base64
import contextlib
import csv
import html
import io
import json
import os
import sys

try:
    import matplotlib
except ImportError:
    sys.exit(4)
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

INK, MUTED, GRID = "#1f2933", "#7b8794", "#e4e7eb"
BLUE, ORANGE, GREEN, RED = "#2166ac", "#e08214", "#1b7837", "#b2182b"
STAGES = [
    ("preprocess", "image preprocessing", 1.20, 1.20, "#a6bddb"),
    ("pose_prediction", "camera pose estimation", 23.05, 19.26, "#3690c0"),
    ("features", "feature extraction and matching", 6.40, 6.40, "#1b7837"),
    ("pose_update", "camera pose calculation", 9.70, 9.70, "#e08214"),
    ("render", "rendering and registration", 1.22, 1.22, "#8073ac"),
]

plt.rcParams.update({
    "font.family": "sans-serif", "font.size": 9, "axes.edgecolor": MUTED, "axes.labelcolor": INK,
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": GRID,
    "text.color": INK, "xtick.color": MUTED, "ytick.color": MUTED, "legend.frameon": False,
    "svg.fonttype": "none", "svg.hashsalt": "cairn", "figure.constrained_layout.use": True,
})


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


def read_csv(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [row[name] for row in rows] for name in (rows[0] if rows else {})}


def numbers(column):
    return np.array([float(v) if v else np.nan for v in column])


def read_tum(path):
    if not os.path.exists(path):
        return None
    values = np.loadtxt(path, ndmin=2)
    return values if values.size else None


def svg(figure):
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    plt.close(figure)
    text = buffer.getvalue()
    return text[text.index("<svg"):]


def chart(draw, wide, narrow, *data):
    """The figure of draw(axes, *data) twice: for a page and for a phone. None where it draws nothing."""
    parts = []
    for name, size in (("wide", wide), ("narrow", narrow)):
        plt.rcParams["svg.hashsalt"] = "cairn" + name  # ids in one page differ
        figure, axes = plt.subplots(figsize=size)
        if draw(axes, *data) is False:
            plt.close(figure)
            return None
        parts.append(f"<div class='chart {name}'>{svg(figure)}</div>")
    return "".join(parts)


def aligned(estimate, truth, mode):
    """The estimate at the true times, laid over the truth as summary.json was computed."""
    times = {round(t, 6): i for i, t in enumerate(truth[:, 0])}
    pairs = [(i, times[round(t, 6)]) for i, t in enumerate(estimate[:, 0]) if round(t, 6) in times]
    if len(pairs) < 3 or mode != "sim3":
        return estimate[:, 1:4]
    e = estimate[[p[0] for p in pairs], 1:4]
    g = truth[[p[1] for p in pairs], 1:4]
    me, mg = e.mean(0), g.mean(0)
    u, d, vt = np.linalg.svd((g - mg).T @ (e - me) / len(e))
    s = np.diag([1, 1, np.sign(np.linalg.det(u) * np.linalg.det(vt))])
    r = u @ s @ vt
    scale = np.trace(np.diag(d) @ s) / max(e.var(0).sum(), 1e-18)
    return (scale * (r @ (estimate[:, 1:4] - me).T)).T + mg


def plot_trajectory(axes, folder, summary):
    estimate, truth = read_tum(folder + "/trajectory.tum"), read_tum(folder + "/truth.tum")
    if estimate is None:
        return False
    mode = summary["trajectory"]["aligned"]
    planar = mode == "start"
    p = aligned(estimate, truth, mode) if truth is not None else estimate[:, 1:4]
    a, b = (0, 1) if planar else (0, 2)
    if truth is not None and not planar:
        spread = np.argsort(-np.ptp(truth[:, 1:4], axis=0))
        a, b = sorted(spread[:2])
    landmarks = read_csv(folder + "/landmarks.csv")
    if planar and landmarks:
        x, y = numbers(landmarks["x"]), numbers(landmarks["y"])
        axes.plot(x, y, "+", color=MUTED, ms=4, label="landmarks")
    if truth is not None:
        axes.plot(truth[:, 1 + a], truth[:, 1 + b], color=MUTED, lw=2.6, alpha=0.6, label="truth")
    axes.plot(p[:, a], p[:, b], color=BLUE, lw=1.2, label="estimate")
    axes.plot(p[0, a], p[0, b], "o", color=GREEN, ms=5, label="start")
    axes.set_aspect("equal", "datalim")
    axes.set_xlabel("xyz"[a] + (", m" if truth is not None else ", map units"))
    axes.set_ylabel("xyz"[b] + (", m" if truth is not None else ", map units"))
    axes.legend(loc="best", fontsize=8)
    return True


def plot_latency(axes, frames, summary):
    n = numbers(frames["frame"])
    total = numbers(frames["total_ms"])
    budget = summary["latency_ms"]["budget"]
    axes.stackplot(n, [numbers(frames[k + "_ms"]) for k, *_ in STAGES],
                   colors=[s[4] for s in STAGES], labels=[s[1] for s in STAGES], lw=0)
    axes.plot(n, total, color=INK, lw=0.6, label="frame, wall time")
    axes.axhline(budget, color=RED, lw=1.2, ls="--")
    axes.annotate(f"budget {budget:g} ms", (n[-1], budget), xytext=(0, 3),
                  textcoords="offset points", ha="right", color=RED, fontsize=8)
    axes.set_ylim(0, max(1.12 * budget, min(np.nanmax(total) * 1.1, 4 * budget)))
    axes.set_xlabel("frame")
    axes.set_ylabel("ms")
    legend_above(axes, 3)


def legend_above(axes, columns):
    """As many columns as the figure is wide."""
    narrow = axes.figure.get_figwidth() < 5.0
    axes.legend(loc="lower left", fontsize=8, ncol=max(1, columns - 2) if narrow else columns,
                bbox_to_anchor=(0, 1.0))


def plot_histogram(axes, frames, summary):
    total = numbers(frames["total_ms"])
    axes.hist(total, bins=60, color=BLUE)
    for key, color in (("p50", GREEN), ("p99", ORANGE)):
        axes.axvline(summary["latency_ms"][key], color=color, lw=1.2,
                     label=f"{key} {summary['latency_ms'][key]:.2f} ms")
    axes.set_xlabel("time of a frame, ms")
    axes.set_ylabel("frames")
    axes.legend(fontsize=8)


def plot_registration(axes, frames):
    px = numbers(frames["registration_px"])
    if np.all(np.isnan(px)):
        return False
    axes.plot(numbers(frames["frame"]), px, color=BLUE, lw=0.9)
    axes.axhline(np.nanmean(px), color=MUTED, lw=1, ls="--", label=f"mean {np.nanmean(px):.2f} px")
    axes.set_ylim(0, max(1.0, 1.15 * np.nanpercentile(px, 99.5)))
    axes.set_xlabel("frame")
    axes.set_ylabel("registration error, px")
    axes.legend(fontsize=8, loc="upper left")
    return True


def plot_map(axes, frames, tracking):
    n = numbers(frames["frame"])
    for key, color in (("landmarks", MUTED), ("matches", ORANGE), ("inliers", GREEN)):
        axes.plot(n, numbers(frames[key]), color=color, lw=0.9, label=key)
    bad = np.array([s not in ("tracking",) for s in tracking["state"]])
    top = axes.get_ylim()[1]
    axes.fill_between(n, 0, top, where=bad, color=RED, alpha=0.12, lw=0, step="mid",
                      label="not tracking")
    axes.set_xlabel("frame")
    axes.set_ylim(0, top)
    legend_above(axes, 4)


def shown(text):
    return html.escape(str(text))


def value(number, digits=2, unit=""):
    return "&ndash;" if number is None else f"{number:.{digits}f}{unit}"


def stage_table(summary):
    rows = []
    latency = summary["latency_ms"]
    for key, name, iekf, ekf, color in STAGES:
        s = latency["stages"][key]
        rows.append(f"<tr><td><i style='background:{color}'></i>{name}</td>"
                    + "".join(f"<td>{s[k]:.3f}</td>" for k in ("p50", "p95", "p99", "max"))
                    + f"<td>{100 * s['over_budget']:.2f} %</td><td>{iekf:.2f}</td><td>{ekf:.2f}</td></tr>")
    rows.append("<tr class='total'><td>whole frame</td>"
                + "".join(f"<td>{latency[k]:.3f}</td>" for k in ("p50", "p95", "p99", "max"))
                + f"<td>{100 * latency['over_budget']:.2f} %</td><td>41.57</td><td>37.78</td></tr>")
    return ("<div class='scrolled'><table><tr><th>per frame, ms</th><th>p50</th><th>p95</th><th>p99</th><th>max</th>"
            "<th>over budget</th><th>paper IEKF</th><th>paper EKF</th></tr>" + "".join(rows) + "</table></div>")


def verdict(summary):
    points = "".join(f"<li class='{shown(p['grade'])}'>{shown(p['text'])}</li>"
                     for p in summary["verdict"]["points"])
    return f"<h2 class='headline'>{shown(summary['verdict']['headline'])}</h2><ul class='verdict'>{points}</ul>"


def title_of(source):
    """The kind of source and the last part of its path: where a user keeps it is nobody's concern."""
    kind, colon, rest = source.partition(":")
    return kind + colon + (rest.rstrip("/").rsplit("/", 1)[-1])


def cards(summary):
    t, r, l = summary["trajectory"], summary["registration_px"], summary["latency_ms"]
    items = [
        ("tracked", f"{summary['tracked']} of {summary['frames']} frames"),
        ("latency p50 / p99", f"{l['p50']:.2f} / {l['p99']:.2f} ms"),
        ("over budget", f"{100 * l['over_budget']:.2f} % of frames"),
        ("registration error", r["mean"] is not None
         and value(r["mean"], 2, " px mean") + ", " + value(r["max"], 2, " px max")),
        ("trajectory error", t["ate_rmse_m"] is not None
         and value(t["ate_rmse_m"], 3, " m rms") + f" ({shown(t['aligned'])})"),
        ("rotation error", t["rotation_rmse_deg"] is not None and value(t["rotation_rmse_deg"], 2, "&deg; rms")),
        ("NEES", summary["nees"]["mean"] is not None and value(summary["nees"]["mean"], 2) + " (3 is consistent)"),
        ("NIS", summary["nis"]["mean"] is not None
         and f"{value(summary['nis']['mean'], 1)} at {value(summary['nis']['dof'], 1)} degrees of freedom"),
        ("map", f"{summary['map']['landmarks']} of {summary['map']['capacity']} landmarks"),
    ]
    return "<div class='cards'>" + "".join(
        f"<div><b>{v}</b><span>{shown(k)}</span></div>" for k, v in items if v) + "</div>"


def picture(path):
    with open(path, "rb") as file:
        data = base64.b64encode(file.read()).decode()
    frame = int(os.path.basename(path)[8:-4])
    return f"<figure><img alt='frame {frame}' src='data:image/jpeg;base64,{data}'><figcaption>frame {frame}</figcaption></figure>"


STYLE = """
:root{color-scheme:light dark}
body{font:15px/1.5 system-ui,sans-serif;color:#1f2933;background:#fff;max-width:1060px;margin:2.2em auto;padding:0 1em}
.headline{font-size:1.3em;margin:.8em 0 .3em}.verdict{list-style:none;padding:0;margin:0 0 1em}
.verdict li{padding:.25em 0 .25em 1.7em;position:relative}.verdict li::before{position:absolute;left:0;width:1.4em;text-align:center}
.good::before{content:'✓';color:#1b7837}.bad::before{content:'✕';color:#b2182b}.note::before{content:'•'}
.bad{font-weight:600}.chart.narrow{display:none}.scrolled{overflow-x:auto}
h1{font-size:1.55em;margin:0}h2{font-size:1.1em;margin:2em 0 .5em}p{margin:.3em 0}.muted{color:#7b8794}
.cards{display:grid;grid-template-columns:repeat(auto-fill,minmax(225px,1fr));gap:.7em;margin:1.3em 0}
.cards div{border:1px solid #e4e7eb;border-radius:8px;padding:.6em .8em}.cards b{display:block;font-weight:600}
.cards span{color:#7b8794;font-size:.85em}
table{border-collapse:collapse;font-size:.9em;width:100%}th,td{text-align:right;padding:.3em .6em;border-bottom:1px solid #e4e7eb}
th:first-child,td:first-child{text-align:left}th{color:#7b8794;font-weight:500}.total td{font-weight:600}
td i{display:inline-block;width:.7em;height:.7em;border-radius:2px;margin-right:.5em}
svg{width:100%;height:auto}.side{display:flex;flex-wrap:wrap;gap:1em}.side .chart{flex:1 1 300px}
.frames{display:grid;grid-template-columns:repeat(auto-fill,minmax(310px,1fr));gap:.7em}
figure{margin:0}img{width:100%;border-radius:6px;display:block}figcaption{color:#7b8794;font-size:.85em}
.health{columns:3;font-size:.85em}.health div{display:flex;justify-content:space-between;padding:.1em .4em}
code{font-size:.85em;overflow-wrap:anywhere}
@media (max-width:700px){.health{columns:1}.chart.narrow{display:block}.chart.wide{display:none}.side{display:block}
th,td{padding:.3em .35em;white-space:nowrap}td:first-child{white-space:normal;min-width:8em}
.frames{grid-template-columns:1fr}.cards{grid-template-columns:repeat(auto-fill,minmax(150px,1fr))}}
@media (prefers-color-scheme:dark){body{background:#14181d;color:#e4e7eb}.chart{background:#fff;border-radius:6px;padding:4px}
.cards div,th,td{border-color:#3e4c59}.good::before{color:#7fbf7b}.bad::before{color:#f4866f}}
"""


def main(folder):
    with open(folder + "/summary.json", encoding="utf-8") as file:
        summary = json.load(file)
    with open(folder + "/manifest.json", encoding="utf-8") as file:
        manifest = json.load(file)
    frames, tracking = read_csv(folder + "/frames.csv"), read_csv(folder + "/tracking.csv")
    config = manifest["config"]
    parts = [
        f"<h1>{shown(title_of(manifest['source']['name']))}</h1>",
        f"<p class='muted'>{shown(config['mode'])} &middot; {shown(config['filter'])}"
        f" &middot; seed {shown(manifest['seed'])}"
        f" &middot; {shown(manifest['source']['note'] or 'no assumptions')}</p>",
        verdict(summary), cards(summary)]
    pictures = [f"{folder}/{name}" for name in summary["pictures"]]
    if pictures:
        parts += ["<h2>What a user sees</h2><div class='frames'>", *map(picture, pictures), "</div>"]
    parts += ["<h2>Latency</h2>", stage_table(summary),
              "<p class='muted'>Over budget: the share of frames above the paper's row (stages) or above "
              f"{summary['latency_ms']['budget']:g} ms (whole frame). The paper's columns are its Table 1, "
              "on its desktop PC.</p>",
              chart(plot_latency, (8.6, 2.9), (4.1, 3.6), frames, summary)]
    parts += ["<h2>Trajectory and time of a frame</h2><div class='side'>",
              chart(plot_trajectory, (5.2, 4.6), (4.1, 4.1), folder, summary)
              or "<p>No pose was estimated.</p>",
              chart(plot_histogram, (4.2, 2.9), (4.1, 2.9), frames, summary), "</div>"]
    registration = chart(plot_registration, (8.6, 2.4), (4.1, 2.6), frames)
    if registration:
        parts += ["<h2>Registration error</h2>", registration,
                  "<p class='muted'>Mean distance between the true pixel of anchored scene points and "
                  "where the estimated pose puts them"
                  f" ({summary['registration_px']['n']} points).</p>"]
    parts += ["<h2>Map and matches</h2>", chart(plot_map, (8.6, 2.6), (4.1, 3.0), frames, tracking)]
    health = "".join(f"<div><span>{shown(k.replace('_', ' '))}</span><b>{shown(v)}</b></div>"
                     for k, v in summary["health"].items())
    parts += [f"<h2>Health</h2><div class='health'>{health}</div>",
              "<h2>How this was made</h2>"
              f"<p><code>{shown(manifest['command'])}</code></p>"
              f"<p class='muted'>cairn {shown(manifest['version'])} &middot; {shown(manifest['compiler'])}"
              f" &middot; {shown(manifest['cpu'])}<br>log hash <code>{shown(summary['log_hash'])}</code></p>"]
    title = shown(title_of(manifest["source"]["name"]))
    with whole_file(folder + "/report.html") as file:
        file.write("<!doctype html><html lang='en'><meta charset='utf-8'><meta name='viewport' "
                   "content='width=device-width, initial-scale=1'>"
                   f"<title>Cairn: {title}</title><style>{STYLE}</style>" + "\n".join(parts) + "</html>\n")


main(sys.argv[1])
