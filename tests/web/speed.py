#!/usr/bin/env python3
"""Compares the time of a frame in WebAssembly (node) with the host's: the tracker with drawing, without decoding,
reading and hashing; the fastest of five runs each.

usage: speed.py HOST_BUILD PAGE LOG      (LOG: what PAGE/hall.clip stands for, build/web-clip/hall.log)
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
NS_PER_MS = 1e6


def output(command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def main():
    host, page, log = map(pathlib.Path, sys.argv[1:4])
    runs = []
    for _ in range(5):
        printed = output([host / "bin/replay_vehicle", log, "--overlay", "yes", "--ticks", "yes"])
        totals = [int(line.split()[-1]) for line in printed.splitlines() if line.startswith("ticks ")]
        runs.append(sum(totals) / len(totals) / NS_PER_MS)
    native = min(runs)
    printed = output(["node", "--no-experimental-fetch", ROOT / "tests/web/replay_clip.js", page / "engine.wasm",
                      page / "hall.clip", "--time"])
    wasm = float(re.search(r"tracker ([\d.]+) ms", printed)[1])
    print(f"native {native:.3f} ms a frame; {printed.strip()}; ratio {wasm / native:.2f}, {1000 / wasm:.0f} frames/s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
