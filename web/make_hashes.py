#!/usr/bin/env python3
"""Writes what the page compares its hashes with: those of programs that replayed the same clip.

usage: make_hashes.py OUT.json ABOUT NAME=FILE...
ABOUT: a line on the clip. FILE: what a replay program printed with --overlay yes on the target NAME.
"""
import json
import pathlib
import sys


def column(lines, kind, at):
    return [line.split()[at] for line in lines if line.startswith(kind + " ")]


def main(arguments):
    if len(arguments) < 3:
        print(__doc__, file=sys.stderr)
        return 2
    numbers, targets = None, []
    for target in arguments[2:]:
        name, _, path = target.partition("=")
        lines = pathlib.Path(path).read_text().splitlines()
        own = [int(number) for number in column(lines, "frame", 1)]
        if not own or numbers not in (None, own):
            print(f"make_hashes: {path}: no replay, or of other frames than the first", file=sys.stderr)
            return 3
        numbers = own
        targets.append({"name": name, "frames": column(lines, "frame", 4), "pictures": column(lines, "overlay", 2)})
    page = {"about": arguments[1], "numbers": numbers, "targets": targets}
    pathlib.Path(arguments[0]).write_text(json.dumps(page, separators=(",", ":")))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
