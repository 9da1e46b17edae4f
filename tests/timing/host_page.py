#!/usr/bin/env python3
"""Times the hall, a hand-held sequence and the stress scenes on this machine with cairn_sim timing and
writes docs/reference/timing-host.md with its picture.

usage: host_page.py [--quick]   (needs build/host; best on a quiet machine; --quick: without the stress scenes)
"""
import json
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
OUT = ROOT / "build/firmware/host-timing"
PAGE = ROOT / "docs/reference/timing-host.md"
SCENES = "../shared/data/seven_scenes_redkitchen"
HEAD = """# Timing of a frame on the host

Written by `tests/timing/host_page.py` with [`cairn_sim timing`](command-line.md#timing-source---out-dir) on one
core of {cpu}, {compiler}. Wall time of the frames' stages, and time on the core, which stands still while
other programs have it. Instructions: callgrind, first 60 frames, the same in every run. `paper`: the rows of
its Table 1, a desktop PC.

"""


def run(*arguments):
    done = subprocess.run([ROOT / "build/host/bin/cairn_sim", "timing", *arguments], cwd=ROOT,
                          capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"cairn_sim timing {' '.join(map(str, arguments))}: {done.stdout}{done.stderr}")


def section(title, folder):
    summary = json.loads((folder / "timing.json").read_text())
    ms = summary["latency_ms"]
    return summary, (f"## {title}\n\n{(folder / 'timing.md').read_text()}\n{summary['frames']} frames; 99 % within "
                     f"{ms['cpu']['p99']:.3f} ms on the core: {ms['budget_over_p99']:.1f} times below {ms['budget']} ms.\n\n")


def main():
    run("hall", "--out", OUT / "hall")
    summary, text = section("Hall, vehicle", OUT / "hall")
    text += "![Histogram of the frames' times](timing-host.png)\n\n"
    if (ROOT / SCENES).exists():
        run(f"seven-scenes:{SCENES}", "--filter", "mono", "--out", OUT / "seven-scenes")
        text += section("Seven-scenes, hand-held", OUT / "seven-scenes")[1]
    if "--quick" not in sys.argv[1:]:
        run("--worst-case", "--out", OUT / "worst-case")
        text += "## Stress scenes\n\nTime on the core.\n\n" + (OUT / "worst-case/timing.md").read_text()
    build = summary["build"]
    PAGE.write_text(HEAD.format(cpu=build["cpu"], compiler=build["compiler"]) + text)
    picture = OUT / "hall/timing.png"
    if picture.exists():
        shutil.copy(picture, PAGE.with_suffix(".png"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
