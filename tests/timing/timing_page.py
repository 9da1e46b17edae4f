"""Writes docs/reference/timing.md from the results of frame_timing.py."""

HEADING = """# Timing of a frame on the boards

Written by `scripts/firmware.sh --timing`. Instructions that a whole frame (tracking and drawing) takes on
the emulated boards: exact, and the same in every run. Inputs: `tests/target/inputs.json`, recorded anew
by each run; those of the set `worst` are stress scenes, each made to drive one part of a frame to its
dearest ([what they are](command-line.md#stress-scenes)).

- worst, p99, median: over the frames of one input. Stages by the board's timer, to two instructions;
  whole frames by counting every executed instruction.
- hybrid bound: every block of code at the largest count that any one frame of the input had, all added
  up. Above any observed frame, but no proof: code that never ran counts nothing (see "Never run").
- modelled: cycles of the worst frame, and of the hybrid bound, by LLVM's model of the Cortex-M7 (dual
  issue, latencies; each block drained at its end). Caches, flash wait states, bus contention and
  mispredicted branches are not in the model: expect 30 to 50 % either way on silicon. Not calibrated on
  a board.
- measured at: the commit. Runs without `--timing` leave these tables as they were.

The paper's desktop PC takes 41.57 ms a frame; that is 19.95 M cycles at 480 MHz and 24.94 M at 600 MHz.
"""
GATE = """
## Gate

CI replays these inputs on the emulated boards and fails when a worst frame needs more than 2 % more
instructions than this table says. Renew it with `tests/timing/timing_gate.py --renew` (after
`scripts/test.sh`) and commit it together with what made the frame dearer.

"""
# What CI replays: whole frames of the default configuration; few, so that it stays short.
GATE_TARGET = "cortex-m7"
GATE_INPUTS = {"hall", "hall-handheld", "seven-scenes", "map-in-view-vehicle", "lost-full-library-vehicle",
               "bred-vehicle", "noise-handheld", "scene-cut-handheld"}
BEGIN, END = "<!-- gate -->", "<!-- end of gate -->"


def thousands(value):
    return f"{value:,}" if value is not None else "-"


def tables(results):
    rows = []
    for target, entries in results.items():
        for image, entry in entries.items():
            for name, timing in (entry.get("timing", {}) if isinstance(entry, dict) else {}).items():
                rows += ["", f"## {target}, `{image}`, {name} ({timing['set']})", "",
                         "| stage | worst | p99 | median | worst/median | hybrid bound |",
                         "| --- | ---: | ---: | ---: | ---: | ---: |"]
                for stage, row in timing["instructions"].items():
                    rows.append(f"| {stage.replace('_', ' ')} | {thousands(row['worst'])} | "
                                f"{thousands(row['p99'])} | {thousands(row['median'])} | "
                                f"{row['worst_over_median'] or '-'} | {thousands(row['hybrid_bound'])} |")
                if "modelled_ms_480mhz" in timing:
                    cycles = timing["modelled_cycles"]
                    rows += ["", "| modelled | cycles | 480 MHz | 600 MHz |", "| --- | ---: | ---: | ---: |"]
                    for what, key in (("worst", "modelled"), ("hybrid", "modelled_hybrid")):
                        rows.append(f"| {what} | {thousands(cycles[what][1])} | {timing[key + '_ms_480mhz']} ms"
                                    f" | {timing[key + '_ms_600mhz']} ms |")
    return rows


def summary(results):
    """The dearest of all inputs, by image."""
    rows = ["", "## Dearest", "", "Over all inputs of an image. Budget: 20 M instructions (goal 12 M), hybrid bound 24 M, "
            "41.57 ms at 600 MHz, worst/median 2.5. Share of units: the largest share of what a frame's "
            "[units of work](../explanation/frame-work.md) stand for that it took, drawing apart.", "",
            "| target | measured at | image | inputs | worst frame | of input | share of units | hybrid bound | "
            "worst/median | modelled worst, 480 / 600 MHz | modelled hybrid, 600 MHz |",
            "| --- | --- | --- | ---: | ---: | --- | ---: | ---: | ---: | ---: | ---: |"]
    for target, entries in results.items():
        for image, entry in entries.items():
            timings = entry.get("timing", {}) if isinstance(entry, dict) else {}
            if not timings:
                continue
            frames = {name: timing["instructions"]["frame"] for name, timing in timings.items()}
            worst = max(frames, key=lambda name: frames[name]["worst"])

            def largest(key):
                values = [timing[key] for timing in timings.values() if key in timing]
                return f"{max(values)} ms" if values else "-"

            shares = [timing["instructions_per_unit"] for timing in timings.values()
                      if timing.get("instructions_per_unit")]
            rows.append(f"| {target} | {entries.get('timing_revision', entries['revision'])} | {image} | "
                        f"{len(frames)} | {thousands(frames[worst]['worst'])} | {worst} | "
                        f"{max(shares) if shares else '-'} | "
                        f"{thousands(max(f['hybrid_bound'] for f in frames.values()))} | "
                        f"{max(f['worst_over_median'] or 0 for f in frames.values()):.2f} | "
                        f"{largest('modelled_ms_480mhz')} / {largest('modelled_ms_600mhz')} | "
                        f"{largest('modelled_hybrid_ms_600mhz')} |")
    return rows


def never_run(results):
    rows = ["", "## Never run", "", "Instructions of the core that no frame of an image's inputs ran: refusals, "
            "rare branches, and what these inputs do not provoke. The bounds above say nothing about them.", "",
            "| target | image | instructions of the core | never run | blocks | largest |",
            "| --- | --- | ---: | ---: | ---: | --- |"]
    for target, entries in results.items():
        for image, entry in entries.items():
            if not isinstance(entry, dict) or "coverage" not in entry:
                continue
            report = entry["coverage"]
            largest = ", ".join(f"`{short(f['name'])}` {f['instructions']}" for f in report["functions"][:5])
            rows.append(f"| {target} | {image} | {thousands(report['instructions'])} | "
                        f"{thousands(report['uncovered_instructions'])} | {report['uncovered_blocks']} | {largest} |")
    return rows


def short(name):
    """A function's own name, without templates' and calls' arguments."""
    depth, kept = 0, ""
    for letter in name:
        depth += letter in "<("
        if depth == 0:
            kept += letter
        depth -= letter in ">)"
    return kept.split("::")[-1].strip() or name[:40]


def gate_text(rows):
    """`rows`: (target, image, input, instructions of the worst frame)."""
    lines = ["| target | image | input | worst frame |", "| --- | --- | --- | ---: |"]
    lines += [f"| {target} | {image} | {name} | {worst:,} |" for target, image, name, worst in rows]
    return f"{BEGIN}\n" + "\n".join(lines) + f"\n{END}\n"


def read_gate(page):
    """{(target, image, input): instructions}"""
    text = page.read_text()
    inside = text.split(BEGIN, 1)[1].split(END, 1)[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in inside.strip().splitlines()[2:]]
    return {tuple(row[:3]): int(row[3].replace(",", "")) for row in rows}


def replace_gate(page, rows):
    text = page.read_text()
    before, rest = text.split(BEGIN, 1)
    after = rest.split(END, 1)[1]
    page.write_text(before + gate_text(rows).rstrip("\n") + after)


def write(root, results):
    page = root / "docs/reference/timing.md"
    gate = []
    for target, entries in results.items():
        for image, entry in entries.items():
            for name, timing in (entry.get("timing", {}) if isinstance(entry, dict) else {}).items():
                if target == GATE_TARGET and name in GATE_INPUTS and not image.endswith("_large"):
                    gate.append((target, image, name, timing["instructions"]["frame"]["worst"]))
    page.write_text(HEADING + GATE + gate_text(gate) + "\n".join(summary(results) + tables(results) + never_run(results)) + "\n")
