#!/usr/bin/env python3
"""Compares the time of a frame in WebAssembly (node) with the host's: the tracker with drawing, without decoding,
reading and hashing. Of each frame the fastest of RUNS runs counts, so that other programs on the machine do not.

usage: speed.py HOST_BUILD PAGE LOG      (LOG: what PAGE/hall.clip stands for, build/web-clip/hall.log)
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
NS_PER_MS = 1e6
RUNS = 10


def output(command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def main():
    host, page, log = map(pathlib.Path, sys.argv[1:4])
    runs = []
    for _ in range(RUNS):
        printed = output([host / "bin/replay_vehicle", log, "--overlay", "yes", "--ticks", "yes"])
        runs.append([int(line.split()[-1]) for line in printed.splitlines() if line.startswith("ticks ")])
    best = [min(frame) for frame in zip(*runs)]
    native = sum(best) / len(best) / NS_PER_MS
    printed = output(["node", "--no-experimental-fetch", ROOT / "tests/web/replay_clip.js", page / "engine.wasm",
                      page / "hall.clip", "--time", str(RUNS)])
    wasm = float(re.search(r"tracker ([\d.]+) ms", printed)[1])
    print(f"native {native:.3f} ms a frame; {printed.strip()}; ratio {wasm / native:.2f}, {1000 / wasm:.0f} frames/s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
