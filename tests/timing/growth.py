#!/usr/bin/env python3
"""How the instructions of a frame grow with active landmarks, library size, image size and corners, on
the emulated M7, with fitted exponents. Writes docs/reference/timing-growth.md.

usage: growth.py [--quick]   (--quick: two sizes of each, page not written)
Needs build/host with cairn_sim and a configured build/cortex-m7, whose images it builds.
"""
import argparse
import math
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tests/target"))
import frame_timing  # noqa: E402
from targets import Target  # noqa: E402

FRAMES, MEASURED = 300, 100  # the last ones, when the map is full
ACTIVE = {"vehicle": [8, 16, 32, 64, 128], "handheld": [8, 16, 32, 50]}
LIBRARY = [64, 256, 1024]
SCALE = 1e9 / (frame_timing.NANOSECONDS_PER_INSTRUCTION * frame_timing.TICKS_PER_SECOND["cortex-m7"])


def record(source, mode, out):
    log = out / f"{source}-{mode}-{FRAMES}.log"
    subprocess.run([ROOT / "build/host/bin/cairn_sim", "run", source, "--mode", mode, "--max-frames",
                    str(FRAMES), "--no-video", "--out", out / f"{source}-{mode}", "--record", log],
                   check=True, capture_output=True, cwd=ROOT)
    return log


def frames_of(target, program, log):
    """A dictionary per frame: stages' instructions and what was counted."""
    status, text = target.run(program, [log, "--overlay", "yes", "--ticks", "yes"])
    if status:
        sys.exit(f"{program}: status {status}\n{text[-500:]}")
    rows = {}
    for line in text.splitlines():
        fields = line.split()
        if fields[0] == "ticks":
            counts = [int(f) * SCALE for f in fields[2:]]
            rows[fields[1]] = dict(zip(frame_timing.STAGES, counts))
        elif fields[0] == "counts":
            names = ("corners", "searched", "matches", "inliers", "landmarks")
            rows[fields[1]].update(zip(names, map(int, fields[2:])))
    return list(rows.values())


def mean(frames, key):
    return sum(f[key] for f in frames) / len(frames)


def exponent(pairs):
    """Slope of a straight line through the logarithms."""
    points = [(math.log(x), math.log(y)) for x, y in pairs if x > 0 and y > 0]
    if len(points) < 2:
        return float("nan")
    mx = sum(x for x, _ in points) / len(points)
    my = sum(y for _, y in points) / len(points)
    across = sum((x - mx) ** 2 for x, _ in points)
    return sum((x - mx) * (y - my) for x, y in points) / across if across else float("nan")


def active_rows(target, mode, sizes, log):
    pairs, rows = [], []
    for active in sizes:
        name = f"growth_{int(mode == 'vehicle')}_{active}_256"
        frames = frames_of(target, name, log)[-MEASURED:]
        pairs.append((mean(frames, "landmarks"), mean(frames, "frame")))
        rows.append(f"| {mode} | {active} | {mean(frames, 'landmarks'):.1f} | {mean(frames, 'inliers'):.1f} | "
                    f"{mean(frames, 'features'):,.0f} | {mean(frames, 'pose_update'):,.0f} | "
                    f"{mean(frames, 'frame'):,.0f} | {max(f['frame'] for f in frames):,.0f} |")
    return rows, exponent(pairs)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    args = parser.parse_args()
    out = ROOT / "build/firmware/growth"
    out.mkdir(parents=True, exist_ok=True)
    active = {mode: sizes[:2] if args.quick else sizes for mode, sizes in ACTIVE.items()}
    library = LIBRARY[:1] if args.quick else LIBRARY
    names = [f"growth_{int(mode == 'vehicle')}_{n}_256" for mode in active for n in active[mode]]
    names += [f"growth_1_64_{n}" for n in library]
    target = Target(ROOT / "build/cortex-m7")
    subprocess.run(["cmake", "--build", target.build, "--target", "replay_vehicle", *dict.fromkeys(names)],
                   check=True)
    logs = {mode: record("hall", mode, out) for mode in active}

    page = ["# How a frame's cost grows", "",
            f"Instructions on the emulated Cortex-M7, written by `tests/timing/growth.py`: `hall`, the last "
            f"{MEASURED} of {FRAMES} frames, drawing included. Exponents are slopes of straight lines through "
            "the logarithms.", "", "## Active landmarks", "",
            "| mode | capacity | landmarks | inliers | features | pose update | frame | worst frame |",
            "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"]
    told = []
    for mode, sizes in active.items():
        rows, slope = active_rows(target, mode, sizes, logs[mode])
        page += rows
        told.append(f"{mode} {slope:.2f}")
    page += ["", f"Exponent of the frame against landmarks in the state: {', '.join(told)}."]

    pairs = []
    page += ["", "## Library", "", "| archived landmarks (capacity) | frame |", "| ---: | ---: |"]
    for size in library:
        frames = frames_of(target, f"growth_1_64_{size}", logs["vehicle"])[-MEASURED:]
        pairs.append((size, mean(frames, "frame")))
        page.append(f"| {size} | {pairs[-1][1]:,.0f} |")
    page += ["", f"Exponent: {exponent(pairs):.3f}."]

    pairs = []
    page += ["", "## Image", "", "| image | features | frame |", "| --- | ---: | ---: |"]
    small = record("hall-small", "vehicle", out)
    for label, pixels, log in (("320x240", 320 * 240, small), ("640x480", 640 * 480, logs["vehicle"])):
        frames = frames_of(target, "replay_vehicle", log)[:MEASURED]
        pairs.append((pixels, mean(frames, "features")))
        page.append(f"| {label} | {mean(frames, 'features'):,.0f} | {mean(frames, 'frame'):,.0f} |")
    page += ["", f"Exponent of features against pixels: {exponent(pairs):.2f}."]

    frames = frames_of(target, "replay_vehicle", logs["vehicle"])
    slope = exponent([(f["corners"], f["features"]) for f in frames if f["searched"] > 0])
    page += ["", "## Corners", "", f"Exponent of features against corners found, over all frames: {slope:.2f}."]
    text = "\n".join(page) + "\n"
    print(text)
    if not args.quick:
        (ROOT / "docs/reference/timing-growth.md").write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
