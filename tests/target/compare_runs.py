#!/usr/bin/env python3
"""Runs a program on the host and, from another build, on its target (through that build's emulator),
and compares their lines: equal to the bit, or the first line that differs.

usage: compare_runs.py BUILD_FOLDER PROGRAM HOST_PROGRAM [ARGUMENT...]
"""
import pathlib
import subprocess
import sys

from targets import emulator_of, program_of


def lines(command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{command[0]}: status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout.splitlines()


def main():
    build, name, host = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
    arguments = sys.argv[4:]
    expected = lines([host] + arguments)
    got = lines(emulator_of(build) + [program_of(build, name)] + arguments)
    if len(expected) != len(got):
        print(f"{len(expected)} lines on the host, {len(got)} on the target")
        return 1
    differ = [(a, b) for a, b in zip(expected, got) if a != b]
    for a, b in differ[:10]:
        print(f"host   {a}\ntarget {b}")
    print(f"{len(expected)} lines, {len(differ)} differ")
    return 1 if differ or not expected else 0


if __name__ == "__main__":
    sys.exit(main())
