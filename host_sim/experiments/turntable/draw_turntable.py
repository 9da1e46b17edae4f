#!/usr/bin/env python3
"""Draws the turntable experiment from runs.csv and frames.csv of its folder, as the pictures of paper B:
fading.png its Figs. 3 to 5, yaw_error.png, pitch_error.png and angles.png its Figs. 6 to 11."""
import csv
import statistics
import sys
from collections import defaultdict
from pathlib import Path

try:
    import matplotlib
except ImportError:
    sys.exit(4)
matplotlib.use("Agg")
import matplotlib.pyplot as plt

CHOSEN = (
    "6dof S=1.000",
    "6dof S=1.009",
    "6dof adaptive",
    "6dof, starts at rest",
    "rotation",
    "rotation + f",
    "pivot, lever known",
    "pivot, lever known + f",
    "pivot bank, lever unknown",
)


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def in_order(rows):
    """Conditions in the order of the file."""
    return list(dict.fromkeys(row["condition"] for row in rows))


def panels(count, height):
    rows = (count + 1) // 2
    figure, axes = plt.subplots(rows, 2, figsize=(12, height * rows), sharex=True, squeeze=False)
    for axis in axes[-1]:
        axis.set_xlabel("time, s")
    return figure, [axes[i % rows][i // rows] for i in range(count)]


def finish(figure, path):
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_errors(folder, frames, angle):
    """Error of yaw or pitch over time, first seed: one panel per condition."""
    series = defaultdict(lambda: ([], []))
    for row in frames:
        t, error = series[row["condition"], row["variant"]]
        t.append(float(row["t_s"]))
        error.append(float(row[f"{angle}_error_deg"]))
    conditions = in_order(frames)
    figure, axes = panels(len(conditions), 3)
    for axis, condition in zip(axes, conditions):
        for variant in CHOSEN:
            if (condition, variant) in series:
                axis.plot(*series[condition, variant], label=variant, linewidth=1.2)
        axis.set_title(condition)
        axis.set_ylabel(f"{angle} error, deg")
        axis.grid(alpha=0.3)
        axis.legend(fontsize=6)
    finish(figure, folder / f"{angle}_error.png")


def draw_angles(folder, frames):
    """Yaw as it was and as it was estimated, first seed."""
    conditions = in_order(frames)
    figure, axes = panels(len(conditions), 3)
    for axis, condition in zip(axes, conditions):
        own = [row for row in frames if row["condition"] == condition]
        true = [row for row in own if row["variant"] == own[0]["variant"]]
        axis.plot([float(r["t_s"]) for r in true], [float(r["true_yaw_deg"]) for r in true], color="black",
                  linewidth=2.5, alpha=0.4, label="true")
        for variant in CHOSEN:
            rows = [row for row in own if row["variant"] == variant]
            if rows:
                axis.plot([float(r["t_s"]) for r in rows],
                          [float(r["true_yaw_deg"]) + float(r["yaw_error_deg"]) for r in rows],
                          label=variant, linewidth=1)
        axis.set_title(condition)
        axis.set_ylabel("yaw, deg")
        axis.grid(alpha=0.3)
        axis.legend(fontsize=6)
    finish(figure, folder / "angles.png")


MEASURES = (("yaw_max_deg", "largest, deg"), ("yaw_mean_deg", "mean absolute, deg"),
            ("yaw_mse_deg2", "mean square, deg^2"))


def draw_fading(folder):
    """The three measures of the yaw error against the fading factor, median of all seeds; the adaptive
    factor as a star at the right."""
    rows = read(folder / "runs.csv")
    values = defaultdict(list)
    for row in rows:
        for measure, _ in MEASURES:
            values[row["condition"], row["variant"], measure].append(float(row[measure]))
    names = sorted({row["variant"] for row in rows if row["variant"].startswith("6dof S=")})
    factors = [float(name.split("=")[1]) for name in names]
    figure, axes = plt.subplots(1, 3, figsize=(15, 5))
    for axis, (measure, label) in zip(axes, MEASURES):
        for condition in in_order(rows):
            median = {name: statistics.median(values[condition, name, measure]) for name in names}
            line, = axis.plot(factors, [median[name] for name in names], marker="o", label=condition)
            adaptive = values.get((condition, "6dof adaptive", measure))
            if adaptive and factors:
                axis.plot(max(factors) + 0.003, statistics.median(adaptive), marker="*", color=line.get_color())
        axis.set_xlabel("fading factor S; star: adaptive")
        axis.set_ylabel(f"yaw error, {label}, median over the seeds")
        axis.set_ylim(bottom=0)
        axis.grid(alpha=0.3)
    axes[0].legend(fontsize=7)
    finish(figure, folder / "fading.png")


def main():
    folder = Path(sys.argv[1])
    frames = read(folder / "frames.csv")
    draw_angles(folder, frames)
    for angle in ("yaw", "pitch"):
        draw_errors(folder, frames, angle)
    draw_fading(folder)


if __name__ == "__main__":
    main()
