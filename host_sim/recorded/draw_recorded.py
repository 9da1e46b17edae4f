#!/usr/bin/env python3
"""Makes report.html of a recorded planar run, which has landmarks and no pictures, from the files in a folder: the page
of every other run without its video. Usage: draw_recorded.py FOLDER"""
import math
import os
import sys
import types


def page_library():
    """report.py: carried along by cairn_sim (PARTS), else in the folder beside."""
    carried = globals().get("PARTS")
    if carried is None:
        sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../reports"))
        import report
        return report
    library = types.ModuleType("report")
    library.PARTS = carried
    exec(compile(carried["report.py"], "report.py", "exec"), library.__dict__)
    return library


page = page_library()


def plane_fit(points, truth):
    """Rotation and translation in the plane that lay `points` over `truth` best, as a function."""
    n = len(points)
    (ax, ay), (bx, by) = ([sum(p[k] for p in side) / n for k in (0, 1)] for side in (points, truth))
    cosine = sine = 0.0
    for (x, y), (u, v) in zip(points, truth):
        cosine += (x - ax) * (u - bx) + (y - ay) * (v - by)
        sine += (x - ax) * (v - by) - (y - ay) * (u - bx)
    angle = math.atan2(sine, cosine)
    c, s = math.cos(angle), math.sin(angle)
    return lambda p: (c * (p[0] - ax) - s * (p[1] - ay) + bx, s * (p[0] - ax) + c * (p[1] - ay) + by)


def floats(column):
    return [float(v) if v else None for v in column]


def frame_at(times_s, t_s):
    """The last frame at `t_s` or before."""
    low, high = 0, len(times_s)
    while low < high:
        middle = (low + high) // 2
        low, high = (middle + 1, high) if times_s[middle] <= t_s + 1e-6 else (low, middle)
    return max(0, low - 1)


def path_of(samples, landmarks, aligned, times_s):
    """What the page draws of the path."""
    estimate = list(zip(floats(samples["x_m"]), floats(samples["y_m"])))
    truth = list(zip(floats(samples["true_x_m"]), floats(samples["true_y_m"])))
    known = [i for i, p in enumerate(truth) if p[0] is not None]
    move = (lambda p: p)
    if aligned and known:
        move = plane_fit([estimate[i] for i in known], [truth[i] for i in known])
    error, at = [None] * len(times_s), []
    for i, t in enumerate(floats(samples["t_s"])):
        frame, point = frame_at(times_s, t), move(estimate[i])
        at.append([frame, page.rounded(point[0]), page.rounded(point[1])])
        if truth[i][0] is not None:
            error[frame] = page.rounded(math.dist(point, truth[i]))
    points, ellipses = [], []
    if landmarks:
        for x, y, xx, xy, yy in zip(*(floats(landmarks[k]) for k in (
                "x_m", "y_m", "var_x_m2", "cov_xy_m2", "var_y_m2"))):
            origin, ahead = move((x, y)), move((x + 1.0, y))
            turn = math.atan2(ahead[1] - origin[1], ahead[0] - origin[0])
            long, short, angle = page.ellipse([[xx, xy], [xy, yy]], 0, 1)
            points.append([page.rounded(v) for v in origin])
            ellipses.append([*points[-1], long, short, page.rounded(angle + turn)])
    return {"axes": ["x", "y"], "unit": "m", "flip": False, "estimate": at,
            "truth": [[page.rounded(x), page.rounded(y)] for x, y in truth if x is not None],
            "landmarks": points, "whole": True, "ellipses": ellipses, "error": error, "sigma": [None] * len(times_s)}


def data_of(folder, summary):
    """All that the charts draw; a frame is a step of the recording."""
    frames, samples = page.read_csv(folder + "/frames.csv"), page.read_csv(folder + "/samples.csv")
    if not frames or not samples:
        return None
    start = int(frames["t_us"][0])
    times_s = [1e-6 * int(t) for t in frames["t_us"]]
    nothing = [None] * len(times_s)
    nees = list(nothing)
    for t, value in zip(floats(samples["t_s"]), floats(samples["nees"])):
        if value is not None and summary["nees"] is not None:
            nees[frame_at(times_s, t)] = page.rounded(value)
    return {
        "frame": [int(n) for n in frames["frame"]],
        "t": [round(1e-6 * (int(t) - start), 4) for t in frames["t_us"]],
        "stages": [{"name": name, "ms": page.numbers(frames[key + "_ms"]), "budget": iekf}
                   for key, name, iekf, _ in page.STAGES],
        "total": page.numbers(frames["total_ms"]), "budget": summary["latency_ms"]["budget"],
        "registration": nothing, "corners": nothing, "matches": page.numbers(frames["matches"]),
        "inliers": page.numbers(frames["inliers"]), "landmarks": page.numbers(frames["landmarks"]),
        "state": ["tracking"] * len(times_s), "nis": nothing, "nees": nees, "score": [], "angle": [], "events": {},
        "path": path_of(samples, page.read_csv(folder + "/landmarks.csv"),
                        summary["trajectory"]["aligned"] == "se2", times_s),
        "video_rate": None, "pictures": []}


def cards(summary):
    trajectory, latency, nees = summary["trajectory"], summary["latency_ms"], summary["nees"]
    per_dof, rmse = summary["nis"]["mean_per_dof"], summary["map"]["rmse_m"]
    return page.card_row([
        ("steps", f"{summary['frames']}"),
        ("latency p50 / p99", f"{latency['p50']:.3f} / {latency['p99']:.3f} ms"),
        ("trajectory error", page.value(trajectory["ate_rmse_m"], 3, " m rms")
         + f" ({page.shown(trajectory['aligned'])})"),
        ("heading error", trajectory["heading_rmse_deg"] is not None
         and page.value(trajectory["heading_rmse_deg"], 2, "&deg; rms")),
        ("NEES", nees is not None and page.value(nees["mean"], 2) + " (3 is consistent)"),
        ("NIS a degree of freedom", per_dof is not None and page.value(per_dof, 2) + " (1 is consistent)"),
        ("landmarks", f"{summary['map']['landmarks']}"),
        ("error of the map", rmse is not None and page.value(rmse, 3, " m rms"))])


def main(folder):
    summary, manifest = page.read_json(folder + "/summary.json"), page.read_json(folder + "/manifest.json")
    sections = page.chart_sections(("latency", "path", "error", "registration", "map", "consistency", "health"),
                                   {"latency": page.stage_table(summary)})
    parts = [page.beginning(manifest), cards(summary), "<div id='player'>" + page.SCRUBBER + "</div>", *sections,
             *page.ending(manifest, summary)]
    page.write_page(folder, manifest, parts, data_of(folder, summary))


if __name__ == "__main__":
    main(sys.argv[1])
