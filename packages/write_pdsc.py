#!/usr/bin/env python3
"""Writes the list of sources in Cairn.Cairn.pdsc anew, from core/src.

usage: write_pdsc.py ROOT
"""
import pathlib
import re
import sys


def source_lines(root):
    return [f'        <file category="sourceCpp" name="{path.relative_to(root).as_posix()}"/>'
            for path in sorted((root / "core/src").rglob("*.cpp"))]


def with_sources(text, root):
    kept = re.sub(r'        <file category="sourceCpp" name="[^"]*"/>\n', "", text).replace("@SOURCES@\n", "")
    return kept.replace("      </files>", "\n".join(source_lines(root)) + "\n      </files>")


def main():
    root = pathlib.Path(sys.argv[1])
    description = root / "packages/Cairn.Cairn.pdsc"
    description.write_text(with_sources(description.read_text(), root))


if __name__ == "__main__":
    main()
