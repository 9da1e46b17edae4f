#!/usr/bin/env python3
"""Runs fixed_cost on an emulated board without a floating-point unit, prints the instructions of the steps of a frame in
fixed point and in emulated float, and their ratio; fails where an update in float does not take four times as many.

usage: cost.py TICKS_PER_SECOND EMULATOR... PROGRAM
"""
import re
import subprocess
import sys

INSTRUCTION_S = 64e-9  # of the emulator's time (toolchains/run_qemu_system.sh)
LEAST_GAIN = 4.0
GATED = ("update",)


def main():
    per_instruction = float(sys.argv[1].rstrip("U")) * INSTRUCTION_S
    done = subprocess.run(sys.argv[2:], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"fixed_cost: status {done.returncode}\n{done.stdout}{done.stderr}")
    cost = {(name, step, int(landmarks)): round(int(ticks) / per_instruction)
            for name, step, landmarks, ticks in
            re.findall(r"^(fixed|float) (\w+) (\d+) (\d+)$", done.stdout, re.M)}
    steps = [(step, landmarks) for name, step, landmarks in cost if name == "fixed"]
    if not steps:
        sys.exit(f"fixed_cost: no figures in\n{done.stdout}")
    failed = False
    print("step, landmarks: instructions in fixed point, in float, their ratio")
    for step, landmarks in steps:
        fixed, single = cost["fixed", step, landmarks], cost["float", step, landmarks]
        ratio = single / fixed
        print(f"{step:12} {landmarks:3}: {fixed:10,} {single:10,} {ratio:6.2f}")
        if step in GATED and ratio < LEAST_GAIN:
            print(f"fixed_cost: {step}, {landmarks} landmarks: less than {LEAST_GAIN} times fewer")
            failed = True
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
