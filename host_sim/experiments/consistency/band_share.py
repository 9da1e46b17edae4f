#!/usr/bin/env python3
"""How often the average NEES lies in its 95 % band, over experiments that differ in their seed alone.

Usage: band_share.py FOLDER... (each with the consistency.csv and summary.json of `cairn_sim consistency`)

The average over many runs is strongly correlated in time, so its share of steps in the band scatters
from seed to seed. The second line of a filter is what an exactly consistent filter would reach with the
same scatter: every series scaled, step by step, so that its mean over the seeds is 3.
"""
import csv
import json
import pathlib
import statistics
import sys

DEGREES = 3


def read(folder):
    series = {}
    with open(folder / "consistency.csv", newline="") as file:
        for row in csv.DictReader(file):
            series.setdefault(row["filter"], []).append(float(row["nees"]))
    return series


def band_of(folder):
    runs = json.loads((folder / "summary.json").read_text())["experiment"]["runs"]
    degrees = runs * DEGREES
    h = 2.0 / (9.0 * degrees)
    return [degrees * (1.0 - h + z * h**0.5) ** 3 / runs for z in (-1.959964, 1.959964)]


def shares(series, steps, scale, low, high):
    return [100.0 * statistics.mean(low <= one[k] * scale[k] <= high for k in steps) for one in series]


def line(name, values):
    above = sum(v >= 95.0 for v in values)
    return (f"  {name:9} median {statistics.median(values):5.1f} %, mean {statistics.mean(values):5.1f} %, "
            f"lowest {min(values):5.1f} %; at least 95 %: {above} of {len(values)} seeds")


def main():
    folders = [pathlib.Path(name) for name in sys.argv[1:]]
    if len(folders) < 2:
        sys.exit(__doc__)
    low, high = band_of(folders[0])
    experiments = [read(folder) for folder in folders]
    print(f"band [{low:.2f}, {high:.2f}]")
    for name in experiments[0]:
        series = [one[name] for one in experiments]
        half = len(series[0]) // 2
        mean = [statistics.mean(column) for column in zip(*series)]
        for loop in range(2):
            steps = range(loop * half, (loop + 1) * half)
            print(f"{name}, loop {loop + 1}: mean NEES {statistics.mean(mean[k] for k in steps):.3f}")
            print(line("measured", shares(series, steps, [1.0] * len(mean), low, high)))
            print(line("exact", shares(series, steps, [DEGREES / m for m in mean], low, high)))


if __name__ == "__main__":
    main()
