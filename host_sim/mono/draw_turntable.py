#!/usr/bin/env python3
"""Draws the turntable experiment from runs.csv and frames.csv of its folder."""
import csv
import statistics
import sys
from collections import defaultdict
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

CHOSEN = (
    "6dof S=1.000",
    "6dof S=1.009",
    "6dof adaptive",
    "rotation",
    "rotation + f",
    "pivot, lever known",
    "pivot, lever known + f",
    "pivot bank, lever unknown",
)


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def draw_errors(folder):
    """Yaw error over time, first seed: one panel per condition."""
    series = defaultdict(lambda: ([], []))
    conditions = []
    for row in read(folder / "frames.csv"):
        if row["condition"] not in conditions:
            conditions.append(row["condition"])
        t, error = series[row["condition"], row["variant"]]
        t.append(float(row["t_s"]))
        error.append(float(row["yaw_error_deg"]))
    rows = (len(conditions) + 1) // 2
    figure, axes = plt.subplots(rows, 2, figsize=(12, 3 * rows), sharex=True, squeeze=False)
    for index, condition in enumerate(conditions):
        axis = axes[index % rows][index // rows]
        for variant in CHOSEN:
            if (condition, variant) in series:
                axis.plot(*series[condition, variant], label=variant, linewidth=1.2)
        axis.set_title(condition)
        axis.set_ylabel("yaw error, deg")
        axis.grid(alpha=0.3)
        axis.legend(fontsize=6)
    for axis in axes[-1]:
        axis.set_xlabel("time, s")
    figure.tight_layout()
    figure.savefig(folder / "yaw_error.png", dpi=110)


def draw_fading(folder):
    """Largest yaw error against the fading factor, all seeds."""
    runs = defaultdict(list)
    conditions = []
    for row in read(folder / "runs.csv"):
        if row["condition"] not in conditions:
            conditions.append(row["condition"])
        if row["variant"].startswith("6dof S="):
            factor = float(row["variant"].split("=")[1])
            runs[row["condition"], factor].append(float(row["yaw_max_deg"]))
    figure, axis = plt.subplots(figsize=(8, 5))
    for condition in conditions:
        factors = sorted(f for c, f in runs if c == condition)
        medians = [statistics.median(runs[condition, f]) for f in factors]
        axis.plot(factors, medians, marker="o", label=condition)
    axis.set_xlabel("fading factor S")
    axis.set_ylabel("largest yaw error, deg, median over the seeds")
    axis.set_ylim(bottom=0)
    axis.grid(alpha=0.3)
    axis.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(folder / "fading.png", dpi=110)


if __name__ == "__main__":
    draw_errors(Path(sys.argv[1]))
    draw_fading(Path(sys.argv[1]))
