#!/usr/bin/env python3
"""Holds every loop of the core that a frame reached against its bound, and writes the list.

usage: loop_bounds.py PROGRAM PROFILE [--page PAGE]

PROGRAM: loop_count of the preset host-loops; PROFILE: what it wrote, with the largest count of each
piece of the code in any one frame. Fails where a loop ran more often than its bound allows for as
often as it was reached, where a stage's function was called more often than its count, or where
loop_rules.py gives no bound. With --page the profile is of all inputs, and it fails too where one of them does not
drive what it is there for.
"""
import argparse
import json
import pathlib
import subprocess
import sys

import loop_rules
import source_loops

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent

# Calls in one frame that the counts of the configuration limit: (function, file, bound).
STAGES = [
    ("search_landmark", "tracking/active_search", "40 + kMaxSeeds", "max_searches, and each seed once"),
    ("best_corner", "tracking/feature_supply", "12", "cells_per_frame"),
    ("take_converged", "tracking/seed_pool", "4", "max_new_landmarks_per_frame"),
    ("follow", "tracking/seed_pool", "1", "one step of the pool"),
    ("search_landmarks", "tracking/landmark_search", "1", "one plan"),
    ("detect_fast", "vision/", "40 + 12 + kMaxSeeds", "searches, cells, seeds"),
    ("describe_freak", "vision/", "40 * kMaxCorners + 16 + kMaxSeeds * kMaxCorners", "corners described"),
]
# What an input is there to drive: (file, head of the loop, least count of its body in a frame, input).
PURPOSES = [("map/library_matcher", "next_slot_ < library.size()", 100, "lost-full-library-vehicle")]
PAGE = """# Bounds of every loop

Written by `tests/timing/loop_bounds.py` (`scripts/firmware.sh --loops`): every loop of the core that a frame
reached, in the inputs of `tests/target/inputs.json` of 640x480 and in {tries} tries of a search that
evolves stress scenes towards the largest sum of all counts. `bound`: how often the body can run each time that the
loop is reached, as the capacity or count behind the limit in its head (values of `DefaultConfig` below); a plain
number is fixed in the code. `around`: how often the loop around it, or its function, ran at most in one frame;
`body`: how often its own body did; both of the template instance that ran most. The check fails when `body`
exceeds `around` times the bound, or when a loop has no bound. Counted at commit {revision}; a loop that is newer, or
has another name there, is not in the table.

What it cannot see: a bound that is exceeded in one pass and compensated by other passes of the same frame, since
only a frame's largest sums are compared. {unreached} loops of the core were reached by no frame: other filters, the map's
files, relocalisation, set-up.

"""


def exported(program, profile):
    merged = profile.with_suffix(".profdata")
    subprocess.run(["llvm-profdata", "merge", "-o", merged, profile], check=True)
    text = subprocess.run(["llvm-cov", "export", program, f"-instr-profile={merged}"], capture_output=True,
                          text=True, check=True).stdout
    return json.loads(text)["data"][0]["functions"]


def below_core(path):
    return path.split("/core/", 1)[1] if "/core/" in path else None


class Counts:
    """Regions of every function's instance, by file."""

    def __init__(self, functions):
        self.instances = {}  # file -> [[(begin, end, count)]]
        self.calls = {}      # (file, mangled name) -> count
        for function in functions:
            file = below_core(function["filenames"][0])
            if file is None or function["count"] == 0:
                continue
            regions = [((r[0], r[1]), (r[2], r[3]), r[4]) for r in function["regions"] if r[7] == 0 and r[5] == 0]
            self.instances.setdefault(file, []).append(regions)
            key = (file, function["name"])
            self.calls[key] = max(self.calls.get(key, 0), function["count"])

    def of(self, loop, outer):
        """(times the loop around it, or its function, ran; times its own body ran) of the instance that ran
        most; None where none did. Counts of other pieces are differences, which a maximum does not keep."""
        best = None
        for regions in self.instances.get(loop.file, []):
            body = [count for begin, _, count in regions if begin == (loop.body_line, loop.body_column)]
            if not body:
                continue
            around = [count for begin, _, count in regions
                      if outer and begin == (outer.body_line, outer.body_column)]
            reached = max(around, default=regions[0][2])
            if reached and (best is None or max(body) > best[1]):
                best = (reached, max(body))
        return best


def check_loops(counts, values):
    rows, faults, unreached = [], [], 0
    loops = source_loops.loops_of_core(ROOT)
    for loop in loops:
        around = [each for each in loops if each.file == loop.file and each is not loop
                  and (each.body_line, each.body_column) <= (loop.line, loop.column) and loop.line <= each.end_line
                  and loop.end_line <= each.end_line]
        outer = max(around, key=lambda each: (each.body_line, each.body_column), default=None)
        found = counts.of(loop, outer)
        if found is None:
            unreached += 1
            continue
        reached, body = found
        bound = loop_rules.bound_of(loop)
        where = f"{loop.file}:{loop.line}"
        if bound is None:
            faults.append(f"{where}: {loop.head}: no bound in loop_rules.py")
            continue
        limit = eval(bound, {}, values)
        if body > reached * limit:
            faults.append(f"{where}: {loop.head}: body ran {body} times in {reached} passes, bound {bound} = {limit}")
        rows.append((loop, bound, limit, reached, body))
    return rows, faults, unreached


def check_purposes(rows):
    """`rows` of check_loops() over all inputs: faults where an input no longer does what it is there for."""
    faults = []
    for file, head, least, name in PURPOSES:
        most = max((body for loop, _, _, _, body in rows if file in loop.file and head in loop.head), default=0)
        if most < least:
            faults.append(f"{name}: {file}: ({head}) ran {most} times in a frame, {least} wanted: mend the input")
    return faults


def check_stages(counts, values):
    rows, faults = [], []
    for name, file, bound, why in STAGES:
        limit = eval(bound, {}, values)
        calls = [count for (path, mangled), count in counts.calls.items()
                 if file in path and f"{len(name)}{name}" in mangled]
        most = max(calls, default=0)
        if most > limit:
            faults.append(f"{name}: called {most} times in a frame, bound {bound} = {limit}")
        rows.append((name, why, limit, most))
    return rows, faults


def write_page(page, rows, stages, values, unreached, tries):
    used = sorted({word for _, bound, *_ in rows for word in values if word in bound})
    lines = ["## Calls in a frame", "", "| function | count behind it | bound | largest seen |",
             "| --- | --- | ---: | ---: |"]
    lines += [f"| `{name}` | {why} | {limit} | {most} |" for name, why, limit, most in stages]
    lines += ["", "## Constants", "", "| constant | value |", "| --- | ---: |"]
    lines += [f"| `{name}` | {values[name]} |" for name in used]
    file = None
    for loop, bound, limit, reached, body in rows:
        if loop.file != file:
            file = loop.file
            lines += ["", f"## `{file}`", "", "| line | loop | bound | around | body |",
                      "| ---: | --- | --- | ---: | ---: |"]
        text = loop.head.replace("|", "\\|")
        shown = f"`{bound}`" if not bound.isdigit() else bound
        lines.append(f"| {loop.line} | `{text}` | {shown} | {reached:,} | {body:,} |")
    described = subprocess.run(["git", "describe", "--always", "--dirty", "--abbrev=7"], cwd=ROOT, capture_output=True,
                               text=True)
    revision = described.stdout.strip() or "unknown"
    page.write_text(PAGE.format(tries=f"{tries:,}", unreached=unreached, revision=revision) + "\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("profile", type=pathlib.Path)
    parser.add_argument("--page", type=pathlib.Path)
    parser.add_argument("--tries", type=int, default=0)
    args = parser.parse_args()
    values = loop_rules.constants(ROOT)
    counts = Counts(exported(args.program, args.profile))
    rows, faults, unreached = check_loops(counts, values)
    stages, stage_faults = check_stages(counts, values)
    faults += stage_faults
    if args.page:
        faults += check_purposes(rows)
    for fault in faults:
        print(fault)
    print(f"{len(rows)} loops reached, {len(faults)} faults")
    if args.page:
        write_page(args.page, rows, stages, values, unreached, args.tries)
    return 1 if faults or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
