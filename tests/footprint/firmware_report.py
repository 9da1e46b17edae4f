#!/usr/bin/env python3
"""What the programs of one target's build do: self-test, memory, equality with the host and, as asked
for, instructions with modelled cycles, and unit tests. scripts/firmware.sh builds and calls:

  firmware_report.py --record                     records the inputs that all targets replay
  firmware_report.py --target NAME [--timing] [--unit-tests]
  firmware_report.py --write-pages                renews docs/reference, if no target is missing

Every measured target leaves build/firmware/results/NAME.json, all together summary.json.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
for folder in ("tests/footprint", "tests/target", "tests/timing"):
    sys.path.insert(0, str(ROOT / folder))
import footprint_page  # noqa: E402
import frame_timing  # noqa: E402
import inputs  # noqa: E402
import memory  # noqa: E402
import page_tables  # noqa: E402
import timing_page  # noqa: E402
from targets import Target  # noqa: E402

OUT = ROOT / "build/firmware"
LOGS = OUT / "logs"
RESULTS = OUT / "results"
IMAGES = footprint_page.REPLAYS
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
    entry["flash_parts"] = memory.flash_parts("arm-none-eabi-nm", target.program(f"replay_{image}"))
    entry["frame_buffer_bytes"] = size["frame_bytes"]
    entry["stack_bytes"] = size["stack_bytes"]
    entry["stack_path"] = size["stack_path"]
    return size["stack_faults"]


def painted_stack(target, image, log):
    _, text = target.run(f"replay_{image}", [log, *REPLAY_OPTIONS, "--ticks", "yes"])
    return max([int(line.split()[1]) for line in text.splitlines() if line.startswith("stack ")], default=0)


def has(target, image):
    return any((target.build / "bin" / f"replay_{image}{end}").exists() for end in (".elf", ""))


def replay(target, host, image, log):
    """(lines, first line that differs from the host's or None, painted stack) of one input on one target."""
    lines, difference = target.same_lines(f"replay_{image}", [log.log, *REPLAY_OPTIONS], host)
    return lines, difference, painted_stack(target, image, log.log) if target.bare_metal else 0


def measure_image(target, host, image, logs):
    """One replay program on one target: memory and equality on each of `logs`."""
    entry = {"ram_bytes": dict(storage_of(target)[image]), "frames": 0, "hash_equal": None, "inputs": {}}
    faults = memory_of(target, image, entry) if target.bare_metal else []
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        outcomes = list(pool.map(lambda log: replay(target, host, image, log), logs))
    for log, (lines, difference, painted) in zip(logs, outcomes):
        frames = lines // 2  # one line for the frame, one for the picture drawn
        entry["frames"] += frames
        entry["hash_equal"] = entry["hash_equal"] is not False and difference is None
        entry["inputs"][log.name] = {"frames": frames, "hash_equal": difference is None}
        if difference is not None:
            entry["inputs"][log.name]["first_difference"] = difference
        if target.bare_metal:
            entry["stack_painted_bytes"] = max(entry.get("stack_painted_bytes", 0), painted)
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


def unit_tests(target):
    """Runs the build's own tests: {passed, run}, and whether all passed."""
    done = subprocess.run(["ctest", "--test-dir", target.build, "--output-on-failure",
                           "--parallel", str(os.cpu_count() or 1)], capture_output=True, text=True)
    found = re.search(r"(\d+) tests failed out of (\d+)", done.stdout)
    if found is None:
        print(f"  no unit test was run:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        return {"passed": 0, "run": 0}, False
    failed, run = int(found[1]), int(found[2])
    print(f"  {run - failed} of {run} tests pass")
    if failed:
        print(done.stdout[-4000:])
    return {"passed": run - failed, "run": run}, failed == 0


def revision():
    done = subprocess.run(["git", "describe", "--always", "--dirty", "--abbrev=7"], cwd=ROOT,
                          capture_output=True, text=True)
    return done.stdout.strip() or "unknown"


def keep_earlier(result, earlier, timing):
    """What this run was not asked for stays in `result` as an earlier run measured it, with the commit of then."""
    if "unit_tests" not in result and "unit_tests" in earlier:
        result["unit_tests"] = {"revision": earlier["revision"], **earlier["unit_tests"]}
    if timing:
        return
    for image, entry in earlier.items():
        if not isinstance(entry, dict) or "timing" not in entry or image not in result:
            continue
        result["timing_revision"] = earlier.get("timing_revision", earlier["revision"])
        result[image].update({key: entry[key] for key in ("timing", "coverage") if key in entry})


def earlier_result(target):
    file = RESULTS / f"{target}.json"
    return json.loads(file.read_text()) if file.exists() else {}


def measure_target(args):
    target = Target(ROOT / "build" / args.target)
    logs = inputs.recorded(LOGS)
    result, good = measure(target, Target(ROOT / "build/host"), logs)
    result["revision"] = revision()
    result["compiler"] = footprint_page.compiler_of(ROOT, args.target)
    if args.timing:
        frame_timing.measure(target, IMAGES, logs, OUT, result)
    if args.unit_tests:
        result["unit_tests"], passed = unit_tests(target)
        good = good and passed
    keep_earlier(result, earlier_result(args.target), args.timing)
    RESULTS.mkdir(parents=True, exist_ok=True)
    (RESULTS / f"{args.target}.json").write_text(json.dumps(result, indent=2) + "\n")
    return good


def all_results():
    """Of every target that was measured, the boards first."""
    found = {path.stem: json.loads(path.read_text()) for path in RESULTS.glob("*.json")}
    return {name: found[name] for name in page_tables.ORDER if name in found}


def write_pages():
    results = all_results()
    missing = [name for name in footprint_page.NEEDED if name not in results]
    if missing:
        print(f"pages not renewed: {', '.join(missing)} not measured")
        return
    footprint_page.write(ROOT, results)
    timed = {name: entry for name, entry in results.items()
             if any("timing" in image for image in entry.values() if isinstance(image, dict))}
    if timed:
        timing_page.write(ROOT, timed)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--target", help="build folder below build/")
    parser.add_argument("--timing", action="store_true")
    parser.add_argument("--unit-tests", action="store_true")
    parser.add_argument("--write-pages", action="store_true")
    args = parser.parse_args()
    OUT.mkdir(parents=True, exist_ok=True)
    if args.record:
        inputs.record(ROOT / "build/host", LOGS)
    good = measure_target(args) if args.target else True
    summary = OUT / "summary.json"
    summary.write_text(json.dumps({"targets": all_results()}, indent=2) + "\n")
    if args.write_pages:
        write_pages()
    if args.target:
        print(f"{args.target}: {'every frame equal to the host' if good else 'NOT ALL GOOD'}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
