#!/usr/bin/env python3
"""How far paths are from the first one after Sim(3) alignment, as a share of its extent (the diagonal of its
bounding box): for runs without truth, which can only be compared with one another. A folder stands for its
trajectory.tum; poses are paired by their times.

  path_difference.py REFERENCE PATH...
"""
import sys
from pathlib import Path

import numpy


def read(name):
    path = Path(name)
    path = path / "trajectory.tum" if path.is_dir() else path
    rows = numpy.loadtxt(path, ndmin=2)
    return {row[0]: row[1:4] for row in rows}


def align(points, reference):
    """Points after the Sim(3) that brings them nearest to the reference: Umeyama 1991."""
    mean, reference_mean = points.mean(axis=0), reference.mean(axis=0)
    centred = points - mean
    covariance = (reference - reference_mean).T @ centred / len(points)
    u, d, vt = numpy.linalg.svd(covariance)
    sign = numpy.ones(3)
    sign[2] = numpy.sign(numpy.linalg.det(u) * numpy.linalg.det(vt))
    rotation = (u * sign) @ vt
    scale = (d * sign).sum() / (centred**2).sum(axis=1).mean()
    return reference_mean + scale * centred @ rotation.T


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    reference = read(sys.argv[1])
    for name in sys.argv[2:]:
        path = read(name)
        times = sorted(reference.keys() & path.keys())
        if len(times) < 3:
            sys.exit(f"{name}: {len(times)} poses at the times of the reference")
        expected = numpy.array([reference[t] for t in times])
        found = align(numpy.array([path[t] for t in times]), expected)
        extent = numpy.linalg.norm(expected.max(axis=0) - expected.min(axis=0))
        rms = numpy.sqrt(((found - expected) ** 2).sum(axis=1).mean())
        print(f"{name}: {100.0 * rms / extent:.2f} % of the extent, {len(times)} of {len(reference)} poses")


if __name__ == "__main__":
    main()
