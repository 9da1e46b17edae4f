#!/usr/bin/env python3
"""At most one draw of a random generator among the arguments of a call: their order of evaluation is the
compiler's, GCC's for x86-64 from right to left, for Arm from left to right. In braces it is fixed.

usage: check_draws.py FILE_OR_FOLDER...
"""
import pathlib
import re
import sys

DRAW = re.compile(r"\b(random|engine|rng|generator|world)_?\.(next|below|uniform|normal)\s*\("
                  r"|\b(uniform|unit|gaussian)_?\s*\(")
CALL = re.compile(r"([\w>]+)\s*\(")
NOT_CALLS = re.compile(r"(if|for|while|switch|return|sizeof)$|(EXPECT|ASSERT)_")  # or macros: one after the other
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.S)


def arguments(text, at):
    """The arguments of the parenthesis that opens at `at`; none where it does not close before a ';'."""
    depth, start, found = 0, at + 1, []
    for i in range(at, len(text)):
        c = text[i]
        if c in "([{":
            depth += 1
        elif c in ")]}":
            depth -= 1
            if depth == 0:
                return found + [text[start:i]]
        elif c == "," and depth == 1:
            found.append(text[start:i])
            start = i + 1
        elif c == ";":
            break
    return []


def faults(text):
    text = COMMENT.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)
    for call in CALL.finditer(text):
        if NOT_CALLS.match(call[1]):
            continue
        if sum(DRAW.search(argument) is not None for argument in arguments(text, call.end() - 1)) > 1:
            yield text.count("\n", 0, call.start()) + 1, call[1]


def main():
    bad = checked = 0
    for path in map(pathlib.Path, sys.argv[1:]):
        files = [f for kind in ("*.cpp", "*.hpp") for f in path.rglob(kind)] if path.is_dir() else [path]
        for file in sorted(files):
            checked += 1
            for line, name in faults(file.read_text()):
                print(f"{file}:{line}: several random draws among the arguments of {name}")
                bad += 1
    print(f"{checked} files, {bad} faults")
    return 1 if bad or not checked else 0


if __name__ == "__main__":
    sys.exit(main())
