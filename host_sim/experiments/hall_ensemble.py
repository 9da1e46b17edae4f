#!/usr/bin/env python3
"""Drives the built-in hall with several filters and seeds and compares their registration error mu: a single run says
little, because a small change of the input may change its path.

  hall_ensemble.py --out DIR [--seeds 1-10] [--filters group-iekf,lifted-iekf,ekf] [--frames 4774] [--shard I/N]

Writes DIR/table.md (a row per seed, and what the filters differ by) and, where matplotlib is installed,
DIR/registration.png: mu over the frames of the first seed, as in the paper's Fig. 6, and of all seeds. Runs that
are complete in DIR already are not repeated: use a new folder after a change.
"""
import argparse
import csv
import json
import statistics
import subprocess
import sys
from pathlib import Path

from shard import add_shard_option, of_shard

ROOT = Path(__file__).resolve().parent.parent.parent
SETTLING_FRAMES = 60  # 2 s
LAP_FRAMES = 2400


def seeds_of(text):
    first, _, last = text.partition("-")
    return list(range(int(first), int(last or first) + 1))


def read_csv(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def run(args, name, seed):
    out = args.out / name / str(seed)
    if not (out / "summary.json").exists():
        subprocess.run([args.program, "run", "hall", "--max-frames", str(args.frames), "--filter", name,
                        "--seed", str(seed), "--no-video", "--force", "--out", out], check=True, stdout=subprocess.DEVNULL)
    frames = read_csv(out / "frames.csv")
    mu = [float(row["registration_px"]) if row["registration_px"] else None for row in frames]
    settled = [px for px in mu[SETTLING_FRAMES:] if px is not None]
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    return {"mu": mu, "mean": summary["registration_px"]["mean"], "p95": summary["registration_px"]["p95"],
            "largest": max(settled), "beyond": 100.0 * sum(px > 6.0 for px in settled) / len(settled),
            "ate": summary["trajectory"]["ate_rmse_m"], "nees": summary["nees"]["filter_mean"], "lost": summary["lost"],
            "known": summary["map"]["reused"]["sightings_percent"] if args.frames > LAP_FRAMES else 0.0}


def write_table(args, runs, seeds):
    lines = ["| seed | filter | mu, px: mean | p95 | largest after 2 s | frames above 6 px | position, m | NEES "
             "| lost | sightings re-used |", "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    for seed in seeds:
        for name in args.filters:
            r = runs[name, seed]
            lines.append(f"| {seed} | {name} | {r['mean']:.2f} | {r['p95']:.2f} | {r['largest']:.1f} "
                         f"| {r['beyond']:.1f} % | {r['ate']:.3f} | {r['nees']:.1f} | {r['lost']} "
                         f"| {r['known']:.0f} % |")
    for name in args.filters:
        own = [runs[name, seed] for seed in seeds]
        mean = {key: statistics.mean(r[key] for r in own) for key in own[0] if key != "mu"}
        lines.append(f"| mean | {name} | {mean['mean']:.2f} | {mean['p95']:.2f} | {mean['largest']:.1f} "
                     f"| {mean['beyond']:.1f} % | {mean['ate']:.3f} | {mean['nees']:.1f} "
                     f"| {sum(r['lost'] for r in own)} | {mean['known']:.0f} % |")
    lines.append("")
    base = args.filters[-1]
    for name in args.filters[:-1]:
        difference = [runs[name, seed]["mean"] - runs[base, seed]["mean"] for seed in seeds]
        error = statistics.stdev(difference) / len(seeds) ** 0.5 if len(seeds) > 1 else 0.0
        lines.append(f"mu of {name} less that of {base}: {statistics.mean(difference):+.2f} px "
                     f"(standard error {error:.2f}), smaller with {sum(d < 0 for d in difference)} of {len(seeds)} "
                     "seeds.")
    text = "\n".join(lines) + "\n"
    (args.out / "table.md").write_text(text, encoding="utf-8")
    print(text, end="")


def draw(args, runs, seeds):
    try:
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
    except ImportError:
        print("registration.png not drawn: matplotlib is not installed", file=sys.stderr)
        return
    figure, (above, below) = plt.subplots(2, 1, figsize=(9, 6), sharex=True, constrained_layout=True)
    colours = dict(zip(args.filters, ("tab:blue", "tab:green", "tab:red")))
    for name in (args.filters[0], args.filters[-1]):
        first = [px if px is not None else float("nan") for px in runs[name, seeds[0]]["mu"]]
        above.plot(first, color=colours[name], linewidth=0.9, label=name)
        columns = zip(*(runs[name, seed]["mu"] for seed in seeds))
        known = [[px for px in column if px is not None] for column in columns]
        below.plot([statistics.mean(px) if px else float("nan") for px in known], color=colours[name],
                   linewidth=0.9, label=name)
    above.set_title(f"seed {seeds[0]}", fontsize="medium")
    below.set_title(f"mean of seeds {seeds[0]} to {seeds[-1]}", fontsize="medium")
    below.set_xlabel("frame")
    for axes in (above, below):
        axes.set_ylabel("registration error mu, px")
        axes.axvline(LAP_FRAMES, color="0.6", linewidth=0.8, linestyle="--")
        axes.set_ylim(bottom=0.0)
        axes.legend(loc="upper right", fontsize="small")
    figure.savefig(args.out / "registration.png", dpi=100)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--seeds", type=seeds_of, default="1-10")
    parser.add_argument("--filters", type=lambda text: text.split(","), default="group-iekf,lifted-iekf,ekf",
                        help="the last one is what the others are compared with")
    parser.add_argument("--frames", type=int, default=4774)
    parser.add_argument("--program", type=Path, default=ROOT / "build/host/bin/cairn_sim")
    add_shard_option(parser)
    args = parser.parse_args()
    wanted = of_shard([(name, seed) for seed in args.seeds for name in args.filters], args.shard)
    runs = {(name, seed): run(args, name, seed) for name, seed in wanted}
    if args.shard != (1, 1):
        return
    write_table(args, runs, args.seeds)
    draw(args, runs, args.seeds)


if __name__ == "__main__":
    main()
