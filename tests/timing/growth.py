#!/usr/bin/env python3
"""How the instructions of a frame grow with active landmarks, image size, corners and the library, on the
emulated M7, with fitted exponents. Writes docs/results/timing-growth.md and its picture.

usage: growth.py
Needs build/host with cairn_sim and build/cortex-m7 with replay_vehicle_large, replay_handheld_large and
library_cost.
"""
import importlib.util
import json
import math
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tests/target"))
import frame_timing  # noqa: E402
from targets import Target  # noqa: E402

OUT = ROOT / "build/firmware/growth"
PAGE = ROOT / "docs/results/timing-growth.md"
SCALE = 1e9 / (frame_timing.NANOSECONDS_PER_INSTRUCTION * frame_timing.TICKS_PER_SECOND["cortex-m7"])
COUNTS = ("corners", "searched", "matches", "inliers", "landmarks")
# The camera passes a plane: the map grows by what comes into view, to the capacity of the large image.
GROWING = {"vehicle": ["stress:frames=360,step_mm=60"],
           "handheld": [f"stress:handheld=1,frames=20,step_mm=30,seed={seed}" for seed in range(1, 6)]}
SIZES = [8, 16, 32, 48, 64, 80, 96, 112]
LARGE = {"vehicle": 48, "handheld": 24}  # from here on the exponent is also fitted alone
# From few corners to many, in otherwise the same world.
CORNERS = [f"stress:frames=60,density={density},contrast={contrast}"
           for density, contrast in ((6, 120), (15, 160), (40, 200), (100, 255), (200, 255))]
NEAR = 0.12  # share by which a frame's landmarks may differ from a size
PAGE_HEAD = """# How a frame's cost grows

Instructions on the emulated Cortex-M7, written by `tests/timing/growth.py` (`scripts/firmware.sh --growth`).
Exponents are slopes of straight lines through the logarithms of all frames concerned.

![Instructions of a frame against landmarks, corners, pixels and library](timing-growth.png)

## Active landmarks

Images of the large configuration (128 landmarks, 50 features): a camera passes a plane and the map grows
from nothing within one run ({inputs}). `landmarks`: in the state when the frame begins; median of the frames
within {near:.0f} %.

"""


def record(source, mode=None):
    name = "".join(c if c.isalnum() else "-" for c in source) + (f"-{mode}" if mode else "")
    log = OUT / f"{name}.log"
    command = [ROOT / "build/host/bin/cairn_sim", "run", source, "--no-video", "--force", "--out", OUT / name,
               "--record", log]
    if not source.startswith("stress"):
        command += ["--mode", mode, "--max-frames", "60"]
    if "handheld" in (mode or source):
        command += ["--filter", "mono"]
    subprocess.run(command, check=True, capture_output=True, cwd=ROOT)
    return log


def frames_of(target, program, log):
    """A dictionary per frame: stages' instructions and what was counted."""
    status, text = target.run(program, [log, "--ticks", "yes"])
    if status:
        sys.exit(f"{program}: status {status}\n{text[-500:]}")
    rows = {}
    for line in text.splitlines():
        fields = line.split()
        if fields[0] == "ticks":
            rows[fields[1]] = dict(zip(frame_timing.STAGES, (int(f) * SCALE for f in fields[2:])))
        elif fields[0] == "counts":
            rows[fields[1]].update(zip(COUNTS, map(int, fields[2:])))
    frames = list(rows.values())
    for before, frame in zip([{"landmarks": 0}, *frames], frames):
        frame["at_start"] = before["landmarks"]
    return frames


def exponent(pairs):
    """Slope of a straight line through the logarithms."""
    points = [(math.log(x), math.log(y)) for x, y in pairs if x > 0 and y > 0]
    mx = sum(x for x, _ in points) / max(1, len(points))
    my = sum(y for _, y in points) / max(1, len(points))
    across = sum((x - mx) ** 2 for x, _ in points)
    return sum((x - mx) * (y - my) for x, y in points) / across if across else float("nan")


def median(values):
    ordered = sorted(values)
    return ordered[len(ordered) // 2]


def active(frames):
    page = ["| landmarks | frames | matches | features | pose update | frame | worst frame |",
            "| ---: | ---: | ---: | ---: | ---: | ---: | ---: |"]
    for size in SIZES:
        near = [f for f in frames if abs(f["at_start"] - size) <= NEAR * size]
        if not near:
            continue
        page.append(f"| {size} | {len(near)} | {median([f['matches'] for f in near])} | "
                    + " | ".join(f"{median([f[key] for f in near]):,.0f}"
                                 for key in ("features", "pose_update", "frame"))
                    + f" | {max(f['frame'] for f in near):,.0f} |")
    pairs = [(f["at_start"], f["frame"]) for f in frames if f["at_start"] >= 6]
    return page, pairs


def library(target):
    status, text = target.run("library_cost")
    if status:
        sys.exit(f"library_cost: status {status}")
    rows = [line.split() for line in text.splitlines()]
    return [(int(size), operation, int(ticks) * SCALE) for size, operation, ticks in rows]


def draw(panels):
    if importlib.util.find_spec("matplotlib") is None:
        print("no picture: python3 has no matplotlib (Debian: python3-matplotlib)")
        return
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(2, 2, figsize=(10, 8), constrained_layout=True)
    for axis, (label, series) in zip(axes.flat, panels):
        for name, pairs in series.items():
            axis.plot([x for x, _ in pairs], [y / 1e6 for _, y in pairs], ".", label=name)
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_xlabel(label)
        axis.set_ylabel("million instructions")
        axis.legend()
    figure.savefig(PAGE.with_suffix(".png"), dpi=90)


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    target = Target(ROOT / "build/cortex-m7")
    page, landmark_pairs, all_frames = [], {}, {}
    for mode, sources in GROWING.items():
        all_frames[mode] = [frame for source in sources
                            for frame in frames_of(target, f"replay_{mode}_large", record(source))]
        rows, pairs = active(all_frames[mode])
        landmark_pairs[mode] = pairs
        large = exponent([pair for pair in pairs if pair[0] >= LARGE[mode]])
        page += [f"{mode.capitalize()}, exponent {exponent(pairs):.2f}; from {LARGE[mode]} landmarks on {large:.2f}:", "",
                 *rows, ""]

    page += ["## Corners", "", "Default image, vehicle mode (hand-held mode searches patches, not corners), in worlds with more and "
             "more marks: medians of the frames with at least 10 searches.", "", "| corners found | features | frame |", "| ---: | ---: | ---: |"]
    corner_pairs = []
    for source in CORNERS:
        frames = [f for f in frames_of(target, "replay_vehicle", record(source)) if f["searched"] >= 10]
        if not frames:
            continue
        corners, features, frame = (median([f[key] for f in frames]) for key in ("corners", "features", "frame"))
        corner_pairs.append((corners, features))
        page.append(f"| {corners} | {features:,.0f} | {frame:,.0f} |")
    page += ["", f"Exponent of the stage against corners: {exponent(corner_pairs):.2f}."]

    page += ["", "## Image", "", "The hall in the image of the large configuration, 60 frames, vehicle mode.", "",
             "| image | features | frame |", "| --- | ---: | ---: |"]
    pixel_pairs = []
    for label, pixels, source in (("320x240", 320 * 240, "hall-small"), ("640x480", 640 * 480, "hall")):
        frames = frames_of(target, "replay_vehicle_large", record(source, "vehicle"))
        late = frames[len(frames) // 2:]
        pixel_pairs.append((pixels, median([f["frame"] for f in late])))
        page.append(f"| {label} | {median([f['features'] for f in late]):,.0f} | {pixel_pairs[-1][1]:,.0f} |")
    page += ["", f"Exponent of the frame against pixels: {exponent(pixel_pairs):.2f}."]

    costs = library(target)
    page += ["", "## Library", "", "The map library's own operations (`tests/target/library_cost.cpp`): `archive` puts a "
             "landmark into a full library, `visible` finds those that a pose should see, `slice` is one frame's share of "
             "matching 64 features while lost (2,048 pairs), `whole` all of it.", "",
             "| landmarks | archive | visible | slice | whole |", "| ---: | ---: | ---: | ---: | ---: |"]
    operations = ("archive", "visible", "slice", "whole")
    by_operation = {name: [(size, cost) for size, each, cost in costs if each == name] for name in operations}
    for size in sorted({size for size, _, _ in costs}):
        page.append(f"| {size:,} | " + " | ".join(f"{dict(by_operation[name])[size]:,.0f}" for name in operations) + " |")
    page += ["", "Exponents: " + ", ".join(f"{name} {exponent(pairs):.2f}" for name, pairs in by_operation.items()) + "."]

    text = PAGE_HEAD.format(inputs=" and ".join(f"`{sources[0]}`" for sources in GROWING.values()), near=100 * NEAR) + "\n".join(page) + "\n"
    print(text)
    PAGE.write_text(text)
    draw([("landmarks in the state", landmark_pairs), ("corners found", {"features": corner_pairs}),
          ("pixels of the image", {"frame": pixel_pairs}), ("landmarks in the library", by_operation)])
    (OUT / "growth.json").write_text(json.dumps(all_frames))
    return 0


if __name__ == "__main__":
    debian = "/usr/bin/python3"  # a python3 of the user's own may lack matplotlib where Debian's has it
    if importlib.util.find_spec("matplotlib") is None and sys.executable != debian and pathlib.Path(debian).exists():
        os.execv(debian, [debian, *sys.argv])
    sys.exit(main())
