#!/usr/bin/env python3
"""Runs every target program of the given builds: self-test, memory, equality with the host and, with
--timing, instructions and modelled cycles. Leaves build/firmware/summary.json and, with
--write-pages, renews docs/reference. Called by scripts/firmware.sh, which builds first.
"""
import argparse
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
for folder in ("tests/footprint", "tests/target", "tests/timing"):
    sys.path.insert(0, str(ROOT / folder))
import footprint_page  # noqa: E402
import frame_timing  # noqa: E402
import inputs  # noqa: E402
import memory  # noqa: E402
import timing_page  # noqa: E402
from targets import Target  # noqa: E402

OUT = ROOT / "build/firmware"
IMAGES = ["vehicle", "handheld", "vehicle_tiny", "handheld_tiny", "vehicle_large", "handheld_large"]
PARTS = ("filter", "map", "vision", "tracker")
REPLAY_OPTIONS = ["--overlay", "yes"]


def storage_of(target):
    """Bytes of each tracker's parts on the target."""
    _, text = target.run("footprint")
    rows = [line.split() for line in text.splitlines()]
    return {row[0]: dict(zip(PARTS, map(int, row[1:]))) for row in rows}


def memory_of(target, image, entry):
    size = memory.memory_of(target.build, "arm-none-eabi-size", target.program(f"replay_{image}"))
    entry["flash_bytes"] = size["flash_bytes"]
    entry["ram_bytes"]["total"] = size["ram_bytes"]
    entry["frame_buffer_bytes"] = size["frame_bytes"]
    entry["stack_bytes"] = size["stack_bytes"]
    entry["stack_path"] = size["stack_path"]
    return size["stack_faults"]


def painted_stack(target, image, log):
    _, text = target.run(f"replay_{image}", [log, *REPLAY_OPTIONS, "--ticks", "yes"])
    return max([int(line.split()[1]) for line in text.splitlines() if line.startswith("stack ")], default=0)


def has(target, image):
    return any((target.build / "bin" / f"replay_{image}{end}").exists() for end in (".elf", ""))


def measure_image(target, host, image, logs):
    """One replay program on one target: memory and equality on each of `logs`."""
    entry = {"ram_bytes": dict(storage_of(target)[image]), "frames": 0, "hash_equal": None, "inputs": {}}
    faults = memory_of(target, image, entry) if target.bare_metal else []
    for log in logs:
        lines, difference = target.same_lines(f"replay_{image}", [log.log, *REPLAY_OPTIONS], host)
        frames = lines // 2  # one line for the frame, one for the picture drawn
        entry["frames"] += frames
        entry["hash_equal"] = entry["hash_equal"] is not False and difference is None
        entry["inputs"][log.name] = {"frames": frames, "hash_equal": difference is None}
        if difference is not None:
            entry["inputs"][log.name]["first_difference"] = difference
        if target.bare_metal:
            entry["stack_painted_bytes"] = max(entry.get("stack_painted_bytes", 0),
                                               painted_stack(target, image, log.log))
    entry["faults"] = faults
    return entry


def print_entry(image, entry):
    ram = entry["ram_bytes"]
    parts = ", ".join(f"{part} {ram[part]}" for part in PARTS)
    memory_text = ""
    if "flash_bytes" in entry:
        memory_text = (f"flash {entry['flash_bytes']:6d}  RAM {ram['total']:6d} ({parts})  stack "
                       f"{entry['stack_bytes']} by graph, {entry.get('stack_painted_bytes', 0)} painted  ")
    equal = {None: "not replayed", True: "all equal", False: "DIFFERENT"}[entry["hash_equal"]]
    print(f"  {image:14s} {memory_text}{entry['frames']} frames {equal}")
    for name, outcome in entry["inputs"].items():
        if "first_difference" in outcome:
            print(f"      {name}: first difference: {outcome['first_difference']}")
    for fault in entry["faults"]:
        print(f"      {fault}")


def measure(target, host, logs):
    status, text = target.run("port_selftest")
    lines, difference = target.same_lines("exercise", [], host)
    result = {"selftest": status == 0, "modules": lines, "modules_equal": difference is None}
    print(f"\n{target.name}: {text.strip().splitlines()[-1] if text.strip() else 'self-test says nothing'}; "
          f"{lines} modules {'equal' if difference is None else 'DIFFERENT: ' + difference}")
    good = result["selftest"] and result["modules_equal"]
    for image in IMAGES:
        if not has(target, image) or not has(host, image):
            continue
        entry = measure_image(target, host, image, [log for log in logs if image in log.images])
        result[image] = entry
        good = good and entry["hash_equal"] is not False and not entry["faults"]
        print_entry(image, entry)
    return result, good


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--targets", required=True, help="build folders below build/, comma-separated")
    parser.add_argument("--timing", default="", help="those of them to time, comma-separated")
    parser.add_argument("--write-pages", action="store_true")
    args = parser.parse_args()
    OUT.mkdir(parents=True, exist_ok=True)
    host = Target(ROOT / "build/host")
    logs = inputs.record(host.build, OUT / "logs")
    results, good = {}, True
    for name in args.targets.split(","):
        results[name], target_good = measure(Target(ROOT / "build" / name), host, logs)
        good = good and target_good
    if args.write_pages:
        footprint_page.write(ROOT, results)
    timed = [name for name in args.timing.split(",") if name]
    for name in timed:
        frame_timing.measure(Target(ROOT / "build" / name), IMAGES, logs, OUT, results[name])
    summary = OUT / "summary.json"
    summary.write_text(json.dumps({"targets": results}, indent=2) + "\n")
    if args.write_pages and timed:
        timing_page.write(ROOT, {name: results[name] for name in timed})
    print(f"\n{'every frame equal to the host' if good else 'NOT ALL GOOD'}; {summary.relative_to(ROOT)}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
