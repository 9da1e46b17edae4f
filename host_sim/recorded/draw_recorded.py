#!/usr/bin/env python3
"""Makes report.html of a recorded planar run from the files in a folder: path and map over the
truth, position error and NEES over time, the figures. Usage: draw_recorded.py FOLDER"""
import csv
import html
import io
import json
import pathlib
import sys

try:
    import matplotlib
except ImportError:
    sys.exit(4)
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402


def columns(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    names = rows[0].keys() if rows else []
    return {n: np.array([float(r[n]) if r[n] else np.nan for r in rows]) for n in names}


def align(points, target):
    """Best rotation and translation in the plane, where both are known."""
    known = ~np.isnan(target[:, 0])
    a, b = points[known], target[known]
    ca, cb = a.mean(0), b.mean(0)
    cosine = np.sum((a - ca) * (b - cb))
    sine = np.sum((a - ca)[:, 0] * (b - cb)[:, 1] - (a - ca)[:, 1] * (b - cb)[:, 0])
    angle = np.arctan2(sine, cosine)
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return lambda p: (p - ca) @ rotation.T + cb


def svg(figure):
    figure.tight_layout()
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    plt.close(figure)
    return text.getvalue()[text.getvalue().index("<svg"):]


def draw_field(samples, landmarks, aligned):
    path = np.column_stack([samples["x_m"], samples["y_m"]])
    truth = np.column_stack([samples["true_x_m"], samples["true_y_m"]])
    move = align(path, truth) if aligned and not np.all(np.isnan(truth)) else (lambda p: p)
    figure, axes = plt.subplots(figsize=(6.5, 6.5))
    axes.plot(truth[:, 0], truth[:, 1], color="0.6", linewidth=2.0, label="truth")
    path = move(path)
    axes.plot(path[:, 0], path[:, 1], linewidth=0.9, color="#2166ac", label="estimate")
    if landmarks:
        points = move(np.column_stack([landmarks["x_m"], landmarks["y_m"]]))
        axes.plot(points[:, 0], points[:, 1], "x", color="#b2182b", label="landmarks")
        axes.plot(landmarks["true_x_m"], landmarks["true_y_m"], "k+", markersize=9)
    axes.set_aspect("equal")
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    axes.legend(fontsize=8)
    axes.grid(alpha=0.3)
    return svg(figure), np.hypot(*(path - truth).T)


def draw_errors(samples, error, nees):
    figure, axes = plt.subplots(2 if nees else 1, 1, figsize=(6.5, 5.0), sharex=True, squeeze=False)
    axes[0][0].plot(samples["t_s"], error, linewidth=0.8)
    axes[0][0].set_ylabel("position error, m")
    if nees:
        axes[1][0].plot(samples["t_s"], samples["nees"], linewidth=0.8)
        axes[1][0].axhspan(0.216, 9.348, color="0.85", label="95 % interval, 3 dof")
        axes[1][0].set_yscale("log")
        axes[1][0].set_ylabel("NEES")
        axes[1][0].legend(fontsize=8)
    axes[-1][0].set_xlabel("time, s")
    for row in axes:
        row[0].grid(alpha=0.3)
    return svg(figure)


def table(summary):
    rows = []

    def walk(prefix, value):
        if isinstance(value, dict):
            for key, inner in value.items():
                walk(f"{prefix}{key} ", inner)
        elif value is not None:
            text = f"{value:.4g}" if isinstance(value, float) else str(value)
            rows.append(f"<tr><td>{html.escape(prefix)}</td><td>{html.escape(text)}</td></tr>")

    walk("", summary)
    return "<table>" + "".join(rows) + "</table>"


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: draw_recorded.py FOLDER")
    folder = pathlib.Path(sys.argv[1])
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    samples = columns(folder / "samples.csv")
    field, error = draw_field(samples, columns(folder / "landmarks.csv"),
                              summary["trajectory"]["aligned"] == "se2")
    name = html.escape(f"{manifest['source']['name']}, {manifest['config']['filter']}")
    page = (
        f"<!doctype html><meta charset='utf-8'><title>{name}</title>"
        "<style>body{font:14px sans-serif;margin:2em;color:#1f2933}td{padding:0 1em 0 0}"
        ".side{display:flex;flex-wrap:wrap;gap:1em}</style>"
        f"<h1>{name}</h1><p>{html.escape(manifest['source']['note'])}</p>"
        f"<div class='side'>{field}{draw_errors(samples, error, summary['nees'] is not None)}</div>"
        f"<h2>Figures</h2>{table(summary)}<p>{html.escape(manifest['command'])}</p>"
    )
    part = folder / "report.html.part"
    part.write_text(page, encoding="utf-8")
    part.replace(folder / "report.html")


if __name__ == "__main__":
    main()
