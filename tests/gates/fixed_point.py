#!/usr/bin/env python3
"""The planar filter without floating point, compiled for a core without a floating-point unit:
its objects call no routine that emulates floating point; on an emulated Cortex-M3 it gives the bytes that
the host gives, and an update takes at most a quarter of the instructions that one in float takes
there (maps of 20 landmarks and more).

usage: fixed_point.py ROOT EIGEN HOST_PROGRAM
HOST_PROGRAM is tests/planar/fixed_cost.cpp, built for the host. Exit code 77: no compiler or emulator.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

CPUS = ("cortex-m3", "cortex-m0plus")
FILTER = ["tests/gates/fixed_planar_filter.cpp", "core/src/numeric/fixed_math.cpp",
          "core/src/numeric/wide_integer.cpp", "core/src/planar/fixed_motion.cpp",
          "core/src/planar/fixed_sighting.cpp"]
IN_FLOAT = ["tests/planar/fixed_cost.cpp", "core/src/numeric/math.cpp", "core/src/planar/increment.cpp",
            "core/src/base/status.cpp"]
PORT = ["startup", "guards", "fault", "semihost", "ticks_cmsdk"]
SOFT_FLOAT = re.compile(
    r"^(__aeabi_([fd]\w+|c[fd]\w+|(i|ui|l|ul|h)2[fd]\w*)"
    r"|__(add|sub|mul|div|neg|eq|ne|lt|le|gt|ge|cmp|unord|pow)[sdt]f\w*"
    r"|__(fix|float|extend|trunc)\w+|\w*(sqrt|fabs|floor|sin|cos|atan2?|exp|log|pow)[fl]?)$")
BOARD = {"code": "0", "code_bytes": "4M", "ram": "0x20000000", "ram_bytes": "4M",
         "frame_ram": "0x21000000", "frame_ram_bytes": "16M"}
TICKS_HZ = 25e6  # of the board's timer
INSTRUCTION_S = 64e-9  # of the emulator's time
LEAST_GAIN = 4.0


class Builder:
    def __init__(self, root, eigen, folder):
        self.root, self.folder = root, folder
        self.flags = ["-mthumb", "-mfloat-abi=soft", "-O2", "-DNDEBUG", "-ffp-contract=off", "-fno-math-errno",
                      "-DEIGEN_DONT_VECTORIZE", "-ffunction-sections", "-fdata-sections", f"-I{root}",
                      f"-I{root}/core/include", f"-I{root}/port/include", f"-I{root}/tests/planar",
                      "-isystem", eigen]

    def run(self, *command):
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"fixed_point: {command[0]} failed:\n{done.stdout}{done.stderr}")
        return done.stdout

    def object(self, source, cpu, text=None, defines=()):
        path = pathlib.Path(source)
        out = self.folder / f"{path.stem}_{cpu}.o"
        if path.suffix == ".c":
            language = ["arm-none-eabi-gcc", "-std=c11"]
        else:
            language = ["arm-none-eabi-g++", "-std=c++17", "-fno-exceptions", "-fno-rtti",
                        "-fno-threadsafe-statics", "-fno-use-cxa-atexit"]
        if text is not None:
            (self.folder / path.name).write_text(text)
            path = self.folder / path.name
        else:
            path = self.root / path
        self.run(*language, f"-mcpu={cpu}", *self.flags, *defines, "-c", path, "-o", out)
        return out

    def together(self, name, sources, cpu):
        """One object of several sources: what they all include is read once."""
        return self.object(name, cpu, "".join(f'#include "{self.root}/{source}"\n' for source in sources))

    def soft_float(self, objects):
        listing = self.run("arm-none-eabi-nm", "-u", *objects)
        names = {line.split()[-1] for line in listing.splitlines() if " U " in line}
        return sorted(name for name in names if SOFT_FLOAT.match(name))


def lines_of(text):
    cost = {(name, int(landmarks)): (int(predict), int(update)) for name, landmarks, predict, update in
            re.findall(r"^(fixed|float) (\d+) (\d+) (\d+)$", text, re.M)}
    return cost, re.search(r"^hash (\w+)$", text, re.M).group(1)


def main():
    root, eigen, host = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], sys.argv[3]
    for tool in ("arm-none-eabi-g++", "qemu-system-arm"):
        if not shutil.which(tool):
            print(f"fixed_point: {tool} is not installed")
            sys.exit(77)
    failed = False
    with tempfile.TemporaryDirectory() as name:
        builder = Builder(root, eigen, pathlib.Path(name))
        bait = builder.object("bait.cpp", CPUS[0], text="float bait(float a, int b) { return a * b; }\n")
        if len(builder.soft_float([bait])) != 2:
            sys.exit("fixed_point: the check does not see a product in float")
        board = CPUS[0]
        timer = ("-DCAIRN_BOARD_TIMER_BASE=0x40000000U", "-DCAIRN_BOARD_TIMER_HZ=25000000U")
        with ThreadPoolExecutor() as pool:
            cost = pool.submit(builder.together, "cost.cpp", FILTER[1:] + IN_FLOAT, board)
            filters = {cpu: pool.submit(builder.together, "filter.cpp", FILTER, cpu) for cpu in CPUS}
            port = [pool.submit(builder.object, f"port/cortex_m/{part}.c", board, defines=timer) for part in PORT]
            parts = [each.result() for each in [cost, *port]]
            for cpu, each in filters.items():
                for symbol in builder.soft_float([each.result()]):
                    print(f"fixed_point: {cpu}: the filter calls {symbol}")
                    failed = True

        image = pathlib.Path(name) / "fixed_cost.elf"
        builder.run("arm-none-eabi-g++", f"-mcpu={board}", *builder.flags, "-nostartfiles", "-nodefaultlibs",
                    "-Wl,--gc-sections", "-Wl,--no-warn-rwx-segments", f"-T{root}/port/cortex_m/firmware.ld",
                    *[f"-Wl,--defsym=cairn_board_{key}={value}" for key, value in BOARD.items()],
                    *parts, "-lm", "-lc", "-lgcc", "-o", image)
        cost, target_hash = lines_of(builder.run(root / "toolchains/run_qemu_system.sh", "mps2-an385", image))
        _, host_hash = lines_of(builder.run(host))

    if target_hash != host_hash:
        print(f"fixed_point: {board} gives {target_hash}, the host {host_hash}")
        failed = True
    per_tick = 1.0 / (TICKS_HZ * INSTRUCTION_S)
    print("landmarks: instructions of a prediction and an update, fixed point, float, their ratio")
    for landmarks in sorted({landmarks for _, landmarks in cost}):
        fixed, single = (tuple(round(t * per_tick) for t in cost[name, landmarks]) for name in ("fixed", "float"))
        ratio = single[1] / fixed[1]
        print(f"{landmarks:9}: {fixed[0]:,} {fixed[1]:,}  {single[0]:,} {single[1]:,}  "
              f"{single[0] / fixed[0]:.2f} {ratio:.2f}")
        if landmarks >= 20 and ratio < LEAST_GAIN:
            print(f"fixed_point: {landmarks} landmarks: less than {LEAST_GAIN} times fewer")
            failed = True
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
