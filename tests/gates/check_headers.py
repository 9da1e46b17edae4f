#!/usr/bin/env python3
"""Compiles each header of core and port by itself: whoever includes one needs no other before it. What a header
includes first is compiled by itself with it, and what a source of the core includes first is by the build. Left out are the parts of a class that its own header includes at its end
and that do not name it (PARTS).

usage: check_headers.py ROOT EIGEN COMPILER
"""
import os
import pathlib
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor


PARTS = ("cairn/mono/detail/", "cairn/runtime/detail/", "cairn/map/detail/")


def headers_of(root):
    for part in ("core", "port"):
        include = root / part / "include"
        for path in sorted(include.rglob("*.h*")):
            header = path.relative_to(include).as_posix()
            if not (header.startswith(PARTS) and path.stem.endswith("_impl")):
                yield header


def first_include(path):
    """What the file includes before all else, or None."""
    first = re.search(r"^#include (\S+)", path.read_text(encoding="utf-8"), re.MULTILINE)
    return first.group(1).strip('"') if first else None


def path_of(root, header):
    return next(path for part in ("core", "port") if (path := root / part / "include" / header).exists())


def fault(command, header):
    """The first error of a file that includes `header` alone, or None."""
    done = subprocess.run(command, input=f'#include "{header}"\n', capture_output=True, text=True)
    if done.returncode == 0:
        return None
    return next((line for line in done.stderr.splitlines() if "error" in line),
                f"status {done.returncode}")


def main():
    root, eigen, compiler = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    command = [compiler, "-std=c++17", "-fsyntax-only", "-x", "c++", "-isystem", eigen,
               "-I", str(root / "core/include"), "-I", str(root / "port/include"), "-"]
    headers = list(headers_of(root))
    covered = {first_include(path_of(root, header)) for header in headers}
    covered |= {first_include(source) for source in (root / "core/src").rglob("*.cpp")}
    headers = [header for header in headers if header not in covered]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        faults = list(pool.map(lambda header: fault(command, header), headers))
    for header, text in zip(headers, faults):
        if text is not None:
            print(f"{header} does not compile alone: {text}")
    print(f"{len(headers)} headers, and those that they include first")
    return 1 if any(faults) or not headers else 0


if __name__ == "__main__":
    sys.exit(main())
