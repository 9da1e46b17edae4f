#!/usr/bin/env python3
"""Instructions per update cycle of the planar filters, counted by callgrind.

GroupIekfSlam may cost at most as much as EkfSlam (paper A reports 1.197 for its filter); in double, where
60 landmarks are within 0.2 % of it, another compiler may miss by 1 %. The lifted filter is printed, not
judged. Exit code 77: valgrind is missing.
"""
import argparse
import re
import shutil
import subprocess
import sys

CYCLES = 10
LIMIT = {"float": 1.0, "double": 1.01}


def instructions(program, name, landmarks, scalar):
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null",
               "--toggle-collect=measured_cycles", program, name, str(landmarks), str(CYCLES), scalar]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    return int(re.search(r"Collected : (\d+)", run.stderr).group(1)) / CYCLES


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--scalars", default="double,float")
    arguments = parser.parse_args()
    if shutil.which("valgrind") is None:
        print("skipped: valgrind is not installed")
        return 77
    failed = False
    print("scalar landmarks      ekf    group  ratio   lifted  ratio")
    for scalar in arguments.scalars.split(","):
        for landmarks in (10, 20, 30, 60):
            ekf, group, lifted = (instructions(arguments.program, name, landmarks, scalar)
                                  for name in ("ekf", "group", "lifted"))
            print(f"{scalar:6} {landmarks:9} {ekf:8.0f} {group:8.0f} {group / ekf:6.3f} "
                  f"{lifted:8.0f} {lifted / ekf:6.2f}", flush=True)
            failed = failed or group > LIMIT[scalar] * ekf
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
