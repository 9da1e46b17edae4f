#!/usr/bin/env python3
"""Draws the pictures of `cairn_sim consistency` from the files in a folder:
nees.png (average NEES with its chi-square band), error.png (position and heading RMSE) and
field.png (landmarks and paths of run 0). Usage: draw_consistency.py FOLDER"""
import csv
import json
import pathlib
import sys

try:
    import matplotlib
except ImportError:
    sys.exit(4)
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def read_series(path):
    series = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            columns = series.setdefault(row["filter"], {"t": [], "nees": [], "pos": [], "head": []})
            columns["t"].append(float(row["t_s"]))
            columns["nees"].append(float(row["nees"]))
            columns["pos"].append(float(row["rmse_position_m"]))
            columns["head"].append(float(row["rmse_heading_rad"]))
    return series


def draw_nees(folder, series, summary):
    low, high = summary["nees_band"]
    figure, axes = plt.subplots(figsize=(8, 4.5))
    axes.axhspan(low, high, color="0.85", label=f"95 % band [{low:.2f}, {high:.2f}]")
    for name, columns in series.items():
        axes.plot(columns["t"], columns["nees"], label=name, linewidth=1.2)
    if max(max(columns["nees"]) for columns in series.values()) > 12.0:
        axes.set_yscale("log")
    axes.set_xlabel("time, s")
    axes.set_ylabel("average NEES (3 degrees of freedom)")
    axes.set_title(title(summary))
    axes.legend(fontsize=8)
    axes.grid(alpha=0.3)
    save(figure, folder / "nees.png")


def draw_error(folder, series, summary):
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(8, 6), sharex=True)
    for name, columns in series.items():
        top.plot(columns["t"], columns["pos"], label=name, linewidth=1.2)
        bottom.plot(columns["t"], columns["head"], label=name, linewidth=1.2)
    top.set_ylabel("position RMSE, m")
    bottom.set_ylabel("heading RMSE, rad")
    bottom.set_xlabel("time, s")
    top.set_title(title(summary))
    top.legend(fontsize=8)
    for axes in (top, bottom):
        axes.grid(alpha=0.3)
    save(figure, folder / "error.png")


def draw_field(folder):
    path = folder / "sample.csv"
    if not path.exists():
        return
    lines = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            xs, ys = lines.setdefault(row["kind"], ([], []))
            xs.append(float(row["x_m"]))
            ys.append(float(row["y_m"]))
    figure, axes = plt.subplots(figsize=(6.5, 6.5))
    for name, (xs, ys) in lines.items():
        if name == "landmark":
            axes.plot(xs, ys, "k+", label="landmarks")
        elif name == "truth":
            axes.plot(xs, ys, "k-", linewidth=2.0, alpha=0.4, label="truth")
        else:
            axes.plot(xs, ys, linewidth=1.0, label=name)
    axes.set_aspect("equal")
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    axes.set_title("run 0")
    axes.legend(fontsize=8)
    axes.grid(alpha=0.3)
    save(figure, folder / "field.png")


def title(summary):
    experiment = summary["experiment"]
    return (f"{summary['runs']} runs, start covariance diag("
            f"{experiment['position_variance_m2']:g}, {experiment['position_variance_m2']:g}, "
            f"{experiment['heading_variance_rad2']:g})")


def save(figure, path):
    figure.tight_layout()
    figure.savefig(path, dpi=120)
    plt.close(figure)


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: draw_consistency.py FOLDER")
    folder = pathlib.Path(sys.argv[1])
    summary = json.loads((folder / "summary.json").read_text())
    series = read_series(folder / "consistency.csv")
    draw_nees(folder, series, summary)
    draw_error(folder, series, summary)
    draw_field(folder)


if __name__ == "__main__":
    main()
