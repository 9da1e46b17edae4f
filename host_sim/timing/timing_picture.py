"""Draws timing.png from the frame_times.csv in the folder given: how often a frame took how long."""
import csv
import pathlib
import sys

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
except ImportError:
    sys.exit(4)

PAPER_MS = 41.57
STAGES = ["preprocess", "pose_prediction", "features", "pose_update", "render"]


def main():
    folder = pathlib.Path(sys.argv[1])
    with open(folder / "frame_times.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    total = [float(row["total_ms"]) for row in rows]
    low = min(min(total), PAPER_MS)
    high = max(max(total), PAPER_MS) * 1.2
    ratio = (high / (0.8 * low)) ** (1 / 80)
    edges = [0.8 * low * ratio ** i for i in range(81)]
    figure, (above, below) = plt.subplots(2, 1, figsize=(8, 6), constrained_layout=True)
    above.hist(total, bins=edges, color="tab:blue")
    above.axvline(PAPER_MS, color="tab:red", label=f"paper's desktop PC, {PAPER_MS} ms")
    above.set_xscale("log")
    above.set_yscale("log")
    above.set_xlabel("time of a frame, ms")
    above.set_ylabel("frames")
    above.legend()
    numbers = [int(row["frame"]) for row in rows]
    below.stackplot(numbers, [[float(row[f"{stage}_ms"]) for row in rows] for stage in STAGES],
                    labels=[stage.replace("_", " ") for stage in STAGES])
    below.set_xlabel("frame")
    below.set_ylabel("ms")
    below.legend(loc="upper right", fontsize="small")
    figure.savefig(folder / "timing.png", dpi=100)


main()
