#!/usr/bin/env python3
"""Runs fixed_cost on an emulated board without a floating-point unit, prints the instructions of a prediction and an
update in fixed point and in emulated float, and their ratio; fails where an update in float does not take four times
as many.

usage: cost.py TICKS_PER_SECOND EMULATOR... PROGRAM
"""
import re
import subprocess
import sys

INSTRUCTION_S = 64e-9  # of the emulator's time (toolchains/run_qemu_system.sh)
LEAST_GAIN = 4.0


def main():
    per_instruction = float(sys.argv[1].rstrip("U")) * INSTRUCTION_S
    done = subprocess.run(sys.argv[2:], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"fixed_cost: status {done.returncode}\n{done.stdout}{done.stderr}")
    cost = {(name, int(landmarks)): tuple(round(int(ticks) / per_instruction) for ticks in (predict, update))
            for name, landmarks, predict, update in
            re.findall(r"^(fixed|float) (\d+) (\d+) (\d+)$", done.stdout, re.M)}
    sizes = sorted({landmarks for _, landmarks in cost})
    if not sizes:
        sys.exit(f"fixed_cost: no figures in\n{done.stdout}")
    failed = False
    print("landmarks: instructions of a prediction and an update, fixed point, float, their ratios")
    for landmarks in sizes:
        fixed, single = cost["fixed", landmarks], cost["float", landmarks]
        ratio = single[1] / fixed[1]
        print(f"{landmarks:9}: {fixed[0]:,} {fixed[1]:,}  {single[0]:,} {single[1]:,}  "
              f"{single[0] / fixed[0]:.2f} {ratio:.2f}")
        if ratio < LEAST_GAIN:
            print(f"fixed_cost: {landmarks} landmarks: less than {LEAST_GAIN} times fewer")
            failed = True
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
