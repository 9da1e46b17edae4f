#!/usr/bin/env python3
"""Runs one handheld source with nine settings that should not matter (least corner score 20, 25 and 30,
times first frame 0, 2 and 4 later, or as given) and prints median and worst errors: a single run of a monocular filter
says little, because a small change of the input may change its path.

  handheld_ensemble.py SOURCE --first 150 --out DIR [--shard I/N] [options of cairn_sim run]

Runs that are complete in DIR already are not repeated: use a new folder after a change.
"""
import argparse
import itertools
import json
import statistics
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from shard import add_shard_option, of_shard

ROOT = Path(__file__).resolve().parent.parent.parent


def run(args, rest, score, later):
    out = args.out / f"{score}-{later}"
    command = [args.program, "run", args.source, "--mode", "handheld", "--filter", "mono", "--no-video", "--force", "--out", out,
               "--first-frame", str(args.first + later), "--corner-score", str(score), *rest]
    if not (out / "summary.json").exists():
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return json.loads((out / "summary.json").read_text(encoding="utf-8"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("source")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--later", type=lambda text: [int(n) for n in text.split(",")], default=[0, 2, 4],
                        help="first frames, counted from --first: 0,2,4")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--program", type=Path, default=ROOT / "build/host/bin/cairn_sim")
    parser.add_argument("--jobs", type=int, default=2)
    add_shard_option(parser)
    args, rest = parser.parse_known_args()
    settings = of_shard(list(itertools.product((20, 25, 30), args.later)), args.shard)
    with ThreadPoolExecutor(args.jobs) as pool:
        runs = list(pool.map(lambda setting: run(args, rest, *setting), settings))
    if args.shard != (1, 1):
        return
    for (score, later), summary in zip(settings, runs):
        trajectory = summary["trajectory"]
        print(f"score {score} first +{later}: ATE {trajectory['ate_rmse_m']} m, "
              f"rotation {trajectory['rotation_rmse_deg']} deg, NIS a degree of freedom "
              f"{summary['nis']['mean'] / summary['nis']['dof']:.2f}, lost {summary['lost']}, "
              f"tracked {summary['tracked']} of {summary['frames']}")
    for key, unit in (("ate_rmse_m", "m"), ("rotation_rmse_deg", "deg")):
        values = [summary["trajectory"][key] for summary in runs]
        if None in values:
            continue
        print(f"{key}: median {statistics.median(values):.4f} {unit}, worst {max(values):.4f} {unit}")


if __name__ == "__main__":
    main()
