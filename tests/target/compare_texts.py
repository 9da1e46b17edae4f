#!/usr/bin/env python3
"""Runs two commands, separated by --, and compares their output line by line."""
import subprocess
import sys


def main():
    split = sys.argv.index("--")
    outputs = []
    for command in (sys.argv[1:split], sys.argv[split + 1:]):
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{command[0]}: status {done.returncode}\n{done.stdout}{done.stderr}")
        outputs.append(done.stdout.splitlines())
    differ = [(a, b) for a, b in zip(*outputs) if a != b]
    for a, b in differ[:10]:
        print(f"{a}\n{b}\n")
    print(f"{len(outputs[0])} and {len(outputs[1])} lines, {len(differ)} differ")
    return 1 if differ or not outputs[0] or len(outputs[0]) != len(outputs[1]) else 0


if __name__ == "__main__":
    sys.exit(main())
