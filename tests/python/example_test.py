#!/usr/bin/env python3
"""Runs the example of docs/how-to/python.md as it stands, and checks what it prints.

usage: example_test.py MODULE_FOLDER
"""
import contextlib
import io
import pathlib
import re
import sys

PAGE = pathlib.Path(__file__).resolve().parent.parent.parent / "docs/how-to/python.md"


def need(good, what, output):
    if not good:
        sys.exit(f"{what}:\n{output}")


def number(pattern, output):
    found = re.search(pattern, output)
    need(found, f"{pattern} is not printed", output)
    return float(found[1])


def main():
    try:
        import numpy  # noqa: F401
    except ImportError:
        print("skipped: no numpy here")
        return 77
    sys.path.insert(0, sys.argv[1])
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), re.M | re.S)
    need(len(blocks) == 4, f"{len(blocks)} parts of the example", "")
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile("\n".join(blocks), str(PAGE), "exec"), {})
    output = printed.getvalue()
    print(output)
    group = number(r"GroupIekfSlam .*NEES ([\d.]+)", output)
    need(group < number(r"EkfSlam  .*NEES ([\d.]+)", output), "the default filter is no more consistent", output)
    need(number(r"median shift (\d+) px", output) == 9, "the shift", output)
    moved = number(r"moved ([\d.-]+) of", output)
    need(abs(moved - 3 * 59 / 300) < 0.06, "the camera's way", output)
    need("tracking" in output and "0 refused" in output, "the trackers", output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
