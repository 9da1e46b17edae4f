#!/usr/bin/env python3
"""Makes the folder of a package whose layout is not that of the sources.

usage: make.py ROOT arduino|cmsis OUTPUT_FOLDER
arduino: a library for the IDE's libraries folder, sources below src/. cmsis: the content of a pack; zip it as
Cairn.Cairn.VERSION.pack. OUTPUT_FOLDER must not exist.
"""
import pathlib
import shutil
import sys

# Arduino has no place for a library's compiler options: the macros stand before the first Eigen header.
ARDUINO_EIGEN = """#pragma once
#define EIGEN_DONT_VECTORIZE
#define EIGEN_MAX_ALIGN_BYTES 0
#define EIGEN_DONT_PARALLELIZE
#define EIGEN_NO_IO
#define EIGEN_MPL2_ONLY
#define EIGEN_STACK_ALLOCATION_LIMIT 0
#define EIGEN_NO_DEBUG
"""


def arduino(root, out):
    shutil.copytree(root / "core/include/cairn", out / "src/cairn")
    shutil.copytree(root / "core/src", out / "src/core", ignore=shutil.ignore_patterns("CMakeLists.txt"))
    shutil.copy(root / "packages/library.properties", out)
    (out / "src/cairn/eigen_options.hpp").write_text(ARDUINO_EIGEN)
    for path in [*out.rglob("*.hpp"), *out.rglob("*.cpp")]:
        text = path.read_text()
        if "#include <Eigen/" in text:
            first = text.index("#include <Eigen/")
            path.write_text(text[:first] + '#include "cairn/eigen_options.hpp"\n' + text[first:])


def cmsis(root, out):
    shutil.copytree(root / "core", out / "core", ignore=shutil.ignore_patterns("CMakeLists.txt"))
    shutil.copy(root / "packages/Cairn.Cairn.pdsc", out)
    shutil.copy(root / "README.md", out)


def main():
    root, kind, out = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
    if kind not in ("arduino", "cmsis"):
        sys.exit(f"make.py: expected arduino or cmsis, found '{kind}'")
    out.mkdir(parents=True)
    shutil.copy(root / "LICENSE", out)
    {"arduino": arduino, "cmsis": cmsis}[kind](root, out)


if __name__ == "__main__":
    main()
