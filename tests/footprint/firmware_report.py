#!/usr/bin/env python3
"""Runs every firmware image of the given builds and reports memory, stack, equality with the host and,
with --timing, instructions and modelled cycles. Leaves build/firmware/summary.json and
docs/reference/footprint.md. Called by scripts/firmware.sh, which builds and records first.
"""
import argparse
import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
for folder in ("tests/footprint", "tests/target", "tests/target/plugin"):
    sys.path.insert(0, str(ROOT / folder))
import compare_runs  # noqa: E402
import cycles  # noqa: E402
import memory  # noqa: E402

STAGES = ["preprocess", "pose_prediction", "features", "pose_update", "render", "frame"]
# Input logs for each image, and frames on the board of each kind: the first board runs them all.
LOGS = {
    "vehicle": ["hall"],
    "handheld": ["seven-scenes", "hall"],
    "vehicle_tiny": ["hall-small"],
    "handheld_tiny": [],
}
ALL_FRAMES, SOME_FRAMES = 60, 20
NANOSECONDS_PER_INSTRUCTION = 64  # toolchains/run_qemu_system.sh: icount shift 6
TICKS_PER_SECOND = {"cortex-m7": 25e6, "cortex-m4f": 25e6, "cortex-m33": 20e6, "cortex-m55": 32e6}


def run(command, environment=None):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, env=environment)
    return done.returncode, done.stdout


def frames_of(text):
    return [line for line in text.splitlines() if line.startswith("frame ")]


def modes_of(log):
    """The mode that the log was recorded in: byte 2 of its header's payload."""
    return "handheld" if log.read_bytes()[18] else "vehicle"


class Board:
    def __init__(self, name):
        self.name = name
        self.build = ROOT / "build" / name
        self.emulator = compare_runs.emulator_of(self.build)
        self.bare_metal = name.startswith("cortex-")
        self.frames = ALL_FRAMES if name == "cortex-m7" else SOME_FRAMES

    def program(self, name):
        return compare_runs.program_of(self.build, name)

    def run(self, program, arguments=(), environment=None):
        return run([*self.emulator, self.program(program), *arguments], environment)

    def selftest(self):
        status, text = self.run("port_selftest")
        return status == 0, text.strip().splitlines()[-1] if text.strip() else "no output"

    def storage(self):
        _, text = self.run("footprint")
        rows = (line.split() for line in text.splitlines())
        return {r[0]: dict(zip(("filter", "map", "vision", "tracker"), map(int, r[1:]))) for r in rows}


def compare(board, image, log):
    """Replays `log` on host and board: frames compared, the first that differs, painted stack, ticks."""
    arguments = [log, "--frames", str(board.frames)]
    host_status, host = run([ROOT / "build/host/bin" / f"replay_{image}", *arguments])
    status, target = board.run(f"replay_{image}", [*arguments, "--ticks", "yes"])
    expected, got = frames_of(host), frames_of(target)
    differ = [a.split()[1] for a, b in zip(expected, got) if a != b]
    complete = host_status == 0 and status == 0 and len(expected) == len(got) and expected
    lines = target.splitlines()
    return {
        "frames": len(got),
        "hash_equal": bool(complete and not differ),
        "first_difference": differ[0] if differ else None if complete else "run ended early",
        "painted": max([int(l.split()[1]) for l in lines if l.startswith("stack ")], default=0),
        "ticks": [list(map(int, l.split()[2:])) for l in lines if l.startswith("ticks ")],
    }


def quantile(values, share):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


def stage_instructions(board, ticks):
    scale = 1e9 / (NANOSECONDS_PER_INSTRUCTION * TICKS_PER_SECOND[board.name])
    table = {}
    for k, stage in enumerate(STAGES):
        counts = [round(row[k] * scale) for row in ticks]
        table[stage] = {"worst": max(counts), "p99": quantile(counts, 0.99),
                        "median": quantile(counts, 0.5), "hybrid_bound": None}
    return table


def marker(image, name):
    text = subprocess.run(["arm-none-eabi-nm", image], capture_output=True, text=True, check=True).stdout
    return next(f"0x{l.split()[0]}" for l in text.splitlines() if l.endswith(f" {name}"))


def block_counts(board, image, log, plugin):
    """Counts blocks of a replay; the CSV's path."""
    import os
    elf = board.program(f"replay_{image}")
    out = ROOT / "build/firmware" / f"blocks-{board.name}-{image}-{log.stem}.csv"
    options = (f"-plugin {plugin},out={out},begin={marker(elf, 'cairn_frame_begin')},"
               f"end={marker(elf, 'cairn_frame_end')}")
    board.run(f"replay_{image}", [log, "--frames", str(board.frames)],
              {**os.environ, "CAIRN_QEMU_OPTIONS": options})
    return elf, out


def timing(board, image, log, ticks, plugin):
    table = {"instructions": stage_instructions(board, ticks)}
    elf, counts = block_counts(board, image, log, plugin)
    frames, blocks = cycles.read_counts(counts)
    table["instructions"]["frame"] = {
        "worst": max(frames), "p99": quantile(frames, 0.99), "median": quantile(frames, 0.5),
        "hybrid_bound": sum(b[1] * b[3] for b in blocks)}
    if board.name == "cortex-m7":
        model = cycles.modelled(elf, counts)
        for mhz in (480, 600):
            table[f"modelled_ms_{mhz}mhz"] = {
                what: round(model[what][1] / (1e3 * mhz), 3) for what in ("worst", "hybrid")}
    return table


def build_plugin():
    out = ROOT / "build/firmware/block_count.so"
    subprocess.run(["gcc", "-O2", "-shared", "-fPIC", "-fvisibility=hidden",
                    ROOT / "tests/target/plugin/block_count.c", "-o", out], check=True)
    return out


def measure(board, plugin):
    good, line = board.selftest()
    print(f"\n{board.name}: {line}")
    result = {"selftest": good}
    storage = board.storage()
    for image in LOGS:
        entry = {"frames": 0, "hash_equal": None}
        parts = storage[image]
        entry["ram_bytes"] = dict(parts)
        if board.bare_metal:
            size = memory.memory_of(board.build, "arm-none-eabi-size", board.program(f"replay_{image}"))
            entry["flash_bytes"] = size["flash_bytes"]
            entry["ram_bytes"]["total"] = size["ram_bytes"]
            entry["frame_buffer_bytes"] = size["frame_bytes"]
            entry["stack_bytes"] = size["stack_bytes"]
            good = good and not size["stack_faults"]
        for name in LOGS[image]:
            log = ROOT / f"build/firmware/logs/{name}.log"
            if not log.exists() or modes_of(log) != image.split("_")[0]:
                continue
            outcome = compare(board, image, log)
            entry["frames"] += outcome["frames"]
            entry["hash_equal"] = entry["hash_equal"] is not False and outcome["hash_equal"]
            entry["stack_painted_bytes"] = max(entry.get("stack_painted_bytes", 0), outcome["painted"])
            if outcome["first_difference"] is not None:
                entry["first_difference"] = f"{name}: frame {outcome['first_difference']}"
            if plugin and board.bare_metal and outcome["ticks"]:
                entry.setdefault("timing", {})[name] = timing(board, image, log, outcome["ticks"], plugin)
        good = good and entry["hash_equal"] is not False
        result[image] = entry
        print_entry(image, entry)
    return result, good


def print_entry(image, entry):
    ram = entry["ram_bytes"]
    equal = {None: "not replayed", True: "equal", False: entry.get("first_difference", "differs")}
    print(f"  {image:14s} flash {entry.get('flash_bytes', 0):7d}  RAM {ram.get('total', 0):7d} "
          f"(filter {ram['filter']}, map {ram['map']}, vision {ram['vision']}, tracker "
          f"{ram['tracker']})  stack {entry.get('stack_bytes', 0)} by graph, "
          f"{entry.get('stack_painted_bytes', 0)} painted  {entry['frames']} frames: "
          f"{equal[entry['hash_equal']]}")
    for log, table in entry.get("timing", {}).items():
        for stage, row in table["instructions"].items():
            bound = f"  hybrid bound {row['hybrid_bound']:9d}" if row["hybrid_bound"] else ""
            print(f"      {log:13s} {stage:16s} worst {row['worst']:9d}  p99 {row['p99']:9d}  "
                  f"median {row['median']:9d}{bound}")
        if "modelled_ms_480mhz" in table:
            print(f"      {log:13s} modelled ms       480 MHz {table['modelled_ms_480mhz']}  "
                  f"600 MHz {table['modelled_ms_600mhz']}")


HEADING = """# Footprint

Bytes of the replay images: tracker, port and replay program together. `scripts/firmware.sh` measures
and writes this page; `tests/footprint/budget.json` is what CI allows.

Flash: code, constants and initial values. RAM: static data without stack and input frame; of it
filter (state and covariance), map (landmarks and candidates) and vision (detector, search, scratch).
Stack: deepest path of the call graph from `main`, and the painted high-water mark of the replay.
Heap: none ([how that is held](no-heap.md)).

| board | image | flash | RAM | filter | map | vision | input frame | stack | painted |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
"""


def write_page(results):
    rows = []
    for board, images in results.items():
        for image, e in images.items():
            if image == "selftest" or "flash_bytes" not in e:
                continue
            ram = e["ram_bytes"]
            rows.append(f"| {board} | {image} | {e['flash_bytes']} | {ram['total']} | {ram['filter']} | "
                        f"{ram['map']} | {ram['vision']} | {e['frame_buffer_bytes']} | "
                        f"{e['stack_bytes']} | {e.get('stack_painted_bytes') or '-'} |")
    storage = ["", "Storage of the tracker objects on the first board, also for the configuration that "
               "no image is built for:", "", "| tracker | bytes |", "| --- | ---: |"]
    first = next(iter(results))
    for name, parts in Board(first).storage().items():
        storage.append(f"| {name} | {parts['tracker']} |")
    page = ROOT / "docs/reference/footprint.md"
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text(HEADING + "\n".join(rows + storage) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--boards", required=True)
    parser.add_argument("--timing", action="store_true")
    args = parser.parse_args()
    (ROOT / "build/firmware").mkdir(parents=True, exist_ok=True)
    plugin = build_plugin() if args.timing else None
    results, good = {}, True
    for name in args.boards.split(","):
        results[name], board_good = measure(Board(name), plugin)
        good = good and board_good
    summary = ROOT / "build/firmware/summary.json"
    summary.write_text(json.dumps({"targets": results}, indent=2) + "\n")
    if any(name.startswith("cortex-") for name in results):
        write_page(results)
    print(f"\n{'every frame equal to the host' if good else 'NOT ALL GOOD'}; {summary.relative_to(ROOT)}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
