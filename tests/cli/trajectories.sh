#!/usr/bin/env bash
# The trajectories are read as evo reads them: its rules for TUM and KITTI files (evo/tools/file_interface.py)
# and for what a pose is (evo/core/lie_algebra.py).
. "$(dirname "$0")/support.sh"

expect 0 "log hash" run hall-small --max-frames 12 --no-video --out vehicle
expect 0 "log hash" run hall-small --max-frames 30 --mode handheld --no-video --out handheld
cat >"$work/evo.py" <<'PYTHON'
import csv
import math
import sys


def matrix(path):
    with open(path, encoding="utf-8") as file:
        return list(csv.reader((line for line in file if not line.startswith("#")), delimiter=" "))


def tum(path):
    rows = matrix(path)
    assert rows and all(len(row) == 8 for row in rows), f"{path}: 8 entries a row, no trailing blank"
    rows = [[float(value) for value in row] for row in rows]
    assert all(a[0] < b[0] for a, b in zip(rows, rows[1:])), f"{path}: times"
    for row in rows:
        assert abs(math.sqrt(sum(q * q for q in row[4:])) - 1.0) < 1e-6, f"{path}: quaternion"
    return rows


def kitti(path):
    rows = matrix(path)
    assert rows and all(len(row) == 12 for row in rows), f"{path}: 12 entries a row, no trailing blank"
    rows = [[float(value) for value in row] for row in rows]
    for m in rows:
        R = [m[0:3], m[4:7], m[8:11]]
        for i in range(3):
            for k in range(3):
                dot = sum(R[i][n] * R[k][n] for n in range(3))
                assert abs(dot - (i == k)) < 1e-6, f"{path}: rotation"
    return rows


for folder in sys.argv[1:]:
    estimate, truth = tum(f"{folder}/trajectory.tum"), tum(f"{folder}/truth.tum")
    rows, true_rows = kitti(f"{folder}/trajectory_kitti.txt"), kitti(f"{folder}/truth_kitti.txt")
    times = {row[0] for row in truth}
    both = [row for row in estimate if row[0] in times]
    assert len(rows) == len(true_rows) == len(both), f"{folder}: {len(rows)} {len(true_rows)} {len(both)}"
    for row, m in zip(both, rows):
        assert max(abs(row[1] - m[3]), abs(row[2] - m[7]), abs(row[3] - m[11])) < 1e-6, folder
PYTHON
python3 "$work/evo.py" "$work/vehicle" "$work/handheld" || fail "evo's rules"
finish
