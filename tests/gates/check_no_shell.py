#!/usr/bin/env python3
"""No program of the host starts a shell: file names reach other programs as arguments, never as text that a
shell reads (host_sim/io/child_process.hpp).

usage: check_no_shell.py FILE_OR_FOLDER...
"""
import pathlib
import re
import sys

SHELL = re.compile(r"""\bsystem\s*\(|\bpopen\b|/bin/(ba|da|z)?sh\b|["'](ba|da|z)?sh["']|\bshell\s*=\s*True|\bgetoutput\b""")
SOURCES = {".cpp", ".hpp", ".c", ".h", ".in", ".py"}


def faults(text):
    for number, line in enumerate(text.splitlines(), start=1):
        found = SHELL.search(line)
        if found:
            yield number, found[0]


def main():
    bad = checked = 0
    for path in map(pathlib.Path, sys.argv[1:]):
        files = [f for f in path.rglob("*") if f.suffix in SOURCES] if path.is_dir() else [path]
        for file in sorted(files):
            checked += 1
            for line, name in faults(file.read_text()):
                print(f"{file}:{line}: {name}: starts a shell; use run_child()")
                bad += 1
    print(f"{checked} files, {bad} faults")
    return 1 if bad or not checked else 0


if __name__ == "__main__":
    sys.exit(main())
