"""Instructions and modelled cycles of replayed frames on an emulated board.

Stages by the board's timer, which counts instructions under the emulator (to one or two); whole frames
and blocks by the plugin block_count.c; cycles by cycles.py.
"""
import os
import subprocess
from concurrent.futures import ThreadPoolExecutor

import coverage
import cycles
import inputs

STAGES = ["preprocess", "pose_prediction", "features", "pose_update", "render", "frame"]
NANOSECONDS_PER_INSTRUCTION = 64  # toolchains/run_qemu_system.sh: icount shift 6
TICKS_PER_SECOND = {"cortex-m7": 25e6, "cortex-m4f": 25e6, "cortex-m33": 20e6, "cortex-m55": 32e6}
CYCLE_MODEL = {"cortex-m7"}  # targets that llvm-mca has a usable model of


def quantile(values, share):
    """Nearest rank."""
    ordered = sorted(values)
    return ordered[max(0, -int(-share * len(ordered) // 1) - 1)]


def row_of(counts):
    median = quantile(counts, 0.5)
    return {"worst": max(counts), "p99": quantile(counts, 0.99), "median": median,
            "worst_over_median": round(max(counts) / median, 3) if median else None, "hybrid_bound": None}


def stage_counts(target, image, log):
    """Per frame: instructions by stage, and the units of work that the tracker booked (0: it books none)."""
    status, text = target.run(f"replay_{image}", [log, "--overlay", "yes", "--ticks", "yes"])
    if status:
        raise RuntimeError(f"{target.name} {image} {log.name}: status {status}")
    rows = {kind: [list(map(int, l.split()[2:])) for l in text.splitlines() if l.startswith(f"{kind} ")]
            for kind in ("ticks", "counts")}
    scale = 1e9 / (NANOSECONDS_PER_INSTRUCTION * TICKS_PER_SECOND[target.name])
    return ([[round(ticks * scale) for ticks in row] for row in rows["ticks"]],
            [row[-1] for row in rows["counts"]])


def stage_table(stages):
    return {stage: row_of([row[k] for row in stages]) for k, stage in enumerate(STAGES)}


def instructions_per_unit(stages, work):
    """Largest of any frame, drawing apart, as a share of what a unit stands for; None without units."""
    render, frame = STAGES.index("render"), STAGES.index("frame")
    shares = [(row[frame] - row[render]) / (1000 * units) for row, units in zip(stages, work) if units]
    return round(max(shares), 3) if shares else None


def marker(image, name):
    text = subprocess.run(["arm-none-eabi-nm", image], capture_output=True, text=True, check=True).stdout
    return next(f"0x{l.split()[0]}" for l in text.splitlines() if l.endswith(f" {name}"))


def build_plugin(out):
    library = out / "block_count.so"
    subprocess.run(["gcc", "-O2", "-shared", "-fPIC", "-fvisibility=hidden",
                    inputs.ROOT / "tests/timing/block_count.c", "-o", library], check=True)
    return library


def plugin_refusal(library):
    """Why the emulator takes no plugin, None where it does: some are built without plugins."""
    done = subprocess.run(["qemu-system-arm", "-plugin", library, "-version"], capture_output=True, text=True)
    return done.stderr.strip() if done.returncode else None


def count_blocks(target, image, log, out, plugin):
    """Replays with the plugin: (ELF file, CSV file, text of the replay)."""
    elf = target.program(f"replay_{image}")
    counts = out / f"blocks-{target.name}-{image}-{log.stem}.csv"
    options = (f"-plugin {plugin},out={counts},begin={marker(elf, 'cairn_frame_begin')},"
               f"end={marker(elf, 'cairn_frame_end')}")
    status, text = target.run(f"replay_{image}", [log, "--overlay", "yes"],
                              {**os.environ, "CAIRN_QEMU_OPTIONS": options})
    if status:
        raise RuntimeError(f"{target.name} {image} {log.name} under the plugin: status {status}")
    return elf, counts, text


def measure_input(target, image, log, out, plugin):
    stages, work = stage_counts(target, image, log)
    table = stage_table(stages)
    elf, counts, _ = count_blocks(target, image, log, out, plugin)
    frames, blocks = cycles.read_counts(counts)
    table["frame"] = row_of(frames)
    table["frame"]["hybrid_bound"] = sum(b[1] * b[3] for b in blocks)
    entry = {"instructions": table, "instructions_per_unit": instructions_per_unit(stages, work)}
    if target.name in CYCLE_MODEL:
        model = cycles.modelled(elf, counts)
        entry["modelled_cycles"] = {what: [round(c) for c in model[what]] for what in model}
        for mhz in (480, 600):
            entry[f"modelled_ms_{mhz}mhz"] = round(model["worst"][1] / (1e3 * mhz), 3)
            entry[f"modelled_hybrid_ms_{mhz}mhz"] = round(model["hybrid"][1] / (1e3 * mhz), 3)
    return entry, elf, blocks


def print_entry(target, image, name, entry):
    print(f"\n{target.name} {image}, {name}: instructions")
    for stage, row in entry["instructions"].items():
        bound = f"  hybrid bound {row['hybrid_bound']:9d}" if row["hybrid_bound"] else ""
        ratio = f"  worst/median {row['worst_over_median']:.2f}" if row["worst_over_median"] else ""
        print(f"  {stage:16s} worst {row['worst']:9d}  p99 {row['p99']:9d}  median {row['median']:9d}"
              f"{ratio}{bound}")
    if "modelled_ms_480mhz" in entry:
        print(f"  modelled: worst frame {entry['modelled_ms_480mhz']} ms at 480 MHz, "
              f"{entry['modelled_ms_600mhz']} ms at 600 MHz; hybrid bound "
              f"{entry['modelled_hybrid_ms_480mhz']} and {entry['modelled_hybrid_ms_600mhz']} ms")


def measure(target, images, logs, out, results):
    """Adds `timing` and `coverage` to each image's entry in `results`."""
    plugin = build_plugin(out)
    for image in images:
        if image not in results:
            continue
        executed = set()
        elf = None
        asked = [log for log in logs if image in log.images]
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            measured = list(pool.map(lambda log: measure_input(target, image, log.log, out, plugin), asked))
        for log, (entry, elf, blocks) in zip(asked, measured):
            entry["set"] = log.set
            results[image].setdefault("timing", {})[log.name] = entry
            executed |= {(b[0], b[1]) for b in blocks}
            print_entry(target, image, log.name, entry)
        if executed and target.name in CYCLE_MODEL:
            report = coverage.report(elf, executed, out / f"uncovered-{target.name}-{image}.txt")
            results[image]["coverage"] = report
            print(f"  never run in a frame: {report['uncovered_instructions']} of "
                  f"{report['instructions']} instructions of the core, {report['uncovered_blocks']} "
                  f"blocks: {report['list']}")
