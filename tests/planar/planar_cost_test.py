#!/usr/bin/env python3
"""Instructions per update cycle of the planar filters, counted by callgrind.

GroupIekfSlam may cost at most as much as EkfSlam (paper A reports 1.197 for its filter); in double, where
60 landmarks are within 0.2 % of it, another compiler may miss by 1 %. The lifted filter is printed, not
judged. Exit code 77: valgrind is missing, or cannot run the program that runs well without it.
"""
import argparse
import re
import signal
import subprocess
import sys

CYCLES = 10
LIMIT = {"float": 1.0, "double": 1.01}


class CannotCount(Exception):
    """Valgrind does not run here, or not this program."""


def ending(run):
    """How a program ended, with the last line of what it wrote to standard error."""
    number = -run.returncode if run.returncode < 0 else run.returncode - 128
    name = next((f" ({each.name})" for each in signal.Signals if each.value == number), "")
    return ": ".join([f"code {run.returncode}{name}", *run.stderr.strip().splitlines()[-1:]])


def instructions(program, name, landmarks, scalar):
    command = [program, name, str(landmarks), str(CYCLES), scalar]
    try:
        run = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null",
                              "--toggle-collect=measured_cycles", *command], capture_output=True, text=True)
    except FileNotFoundError as error:
        raise CannotCount("valgrind is not installed") from error
    if run.returncode:
        subprocess.run(command, check=True)  # a failure of the program's own is no reason to skip
        raise CannotCount(f"valgrind cannot run {program}, it ends with {ending(run)}")
    return int(re.search(r"Collected : (\d+)", run.stderr).group(1)) / CYCLES


def judge(program, scalars):
    """Prints the table; whether every ratio is within its limit."""
    good = True
    print("scalar landmarks      ekf    group  ratio   lifted  ratio")
    for scalar in scalars:
        for landmarks in (10, 20, 30, 60):
            ekf, group, lifted = (instructions(program, name, landmarks, scalar)
                                  for name in ("ekf", "group", "lifted"))
            print(f"{scalar:6} {landmarks:9} {ekf:8.0f} {group:8.0f} {group / ekf:6.3f} "
                  f"{lifted:8.0f} {lifted / ekf:6.2f}", flush=True)
            good = good and group <= LIMIT[scalar] * ekf
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--scalars", default="double,float")
    arguments = parser.parse_args()
    try:
        return 0 if judge(arguments.program, arguments.scalars.split(",")) else 1
    except CannotCount as reason:
        print(f"skipped: {reason}")
        return 77


if __name__ == "__main__":
    sys.exit(main())
