"""Writes docs/reference/timing.md from the results of frame_timing.py."""
import frame_timing
from page_tables import renew, table

HEADING = """# Timing of a frame on the boards

Written by `scripts/firmware.sh --timing`. Instructions that a whole frame (tracking and drawing) takes on
the emulated boards: exact, and the same in every run. Inputs: `tests/target/inputs.json`, recorded anew
by each run. Those of the set `worst` are stress scenes; each drives one part of a frame towards its worst
case ([what they are](command-line.md#stress-scenes)).

- worst, p99, median: over the frames of one input. Stages by the board's timer, to two instructions;
  whole frames by counting every executed instruction.
- hybrid bound: every block of code at the largest count that any one frame of the input had, all added
  up. It is above every observed frame, but not a proven bound: code that never ran counts nothing (see
  "Never run").
- modelled: cycles of the worst frame, and of the hybrid bound, by LLVM's model of the Cortex-M7 (dual
  issue, latencies; each block drained at its end). Caches, flash wait states, bus contention and
  mispredicted branches are not in the model: expect 30 to 50 % either way on silicon. Not calibrated on
  a board.
- The image `window`, the default of hand-held mode, is in the gate's table alone.
- measured at: the commit, of the tables *Frames*, *Stages* and *Never run* too; the gate's rows are as new as the
  code, to 2 %. Runs without `--timing` leave these tables as they were; runs with it leave the rows
  of boards that the build folder has not timed.

The paper's desktop PC takes 41.57 ms a frame; that is 19.95 M cycles at 480 MHz and 24.94 M at 600 MHz.
"""
GATE = """
## Gate

CI replays these inputs on the emulated boards and fails when a worst frame needs more than 2 % more
instructions than this table says. Renew it with `tests/timing/timing_gate.py --renew` (after
`scripts/test.sh`) and commit it together with the change that made the frame more expensive.

"""
# What CI replays: whole frames of the default configuration; few, so that it stays short.
GATE_TARGET = "cortex-m7"
GATE_INPUTS = {"hall", "hall-handheld", "seven-scenes", "map-in-view-vehicle", "lost-full-library-vehicle",
               "crowded-full-library-vehicle", "evolved-vehicle", "noise-handheld", "scene-cut-handheld",
               "seven-scenes-window", "map-in-view-window", "no-consensus-window", "lost-window"}
STAGES = [stage for stage in frame_timing.STAGES if stage != "frame"]
BEGIN, END = "<!-- gate -->", "<!-- end of gate -->"


def thousands(value):
    return f"{value:,}" if value is not None else "-"


def timed_images(results):
    """(target, image, entry) of every image that was timed."""
    for target, entries in results.items():
        for image, entry in entries.items():
            if isinstance(entry, dict) and "timing" in entry:
                yield target, image, entry


def timings_of(results):
    """(target, image, input, timing)"""
    for target, image, entry in timed_images(results):
        for name, timing in entry["timing"].items():
            yield target, image, name, timing


def milliseconds(timing, what):
    """At 480 and 600 MHz."""
    keys = [f"{what}_ms_{mhz}mhz" for mhz in (480, 600)]
    return " / ".join(f"{timing[key]:.2f}" for key in keys) if keys[0] in timing else "-"


def frames(results):
    rows = []
    for target, image, name, timing in timings_of(results):
        frame = timing["instructions"]["frame"]
        ratio = frame["worst_over_median"]
        rows.append([target, image, name, timing["set"], thousands(frame["worst"]), thousands(frame["p99"]),
                     thousands(frame["median"]), f"{ratio:.2f}" if ratio else "-", thousands(frame["hybrid_bound"]),
                     milliseconds(timing, "modelled"), milliseconds(timing, "modelled_hybrid")])
    return ["", "## Frames", "", "Whole frames of each input, in instructions; modelled in ms at 480 / 600 MHz.", "",
            *table(["target", "image", "input", "set", "worst:", "p99:", "median:", "worst/median:", "hybrid bound:",
                    "modelled worst:", "modelled hybrid:"], rows)]


def stages(results):
    rows = []
    for target, image, name, timing in timings_of(results):
        counts = timing["instructions"]
        rows.append([target, image, name, *(f"{thousands(counts[stage]['worst'])} / {thousands(counts[stage]['median'])}"
                                            if stage in counts else "-" for stage in STAGES)])
    return ["", "## Stages", "", "Instructions of each stage, worst / median of an input's frames. The worst of two stages "
            "need not fall in one frame.", "",
            *table(["target", "image", "input", *(f"{stage.replace('_', ' ')}:" for stage in STAGES)], rows)]


def most_expensive(results):
    rows = []
    for target, image, entry in timed_images(results):
        timings = entry["timing"]
        of_frame = {name: timing["instructions"]["frame"] for name, timing in timings.items()}
        worst = max(of_frame, key=lambda name: of_frame[name]["worst"])
        shares = [timing["instructions_per_unit"] for timing in timings.values() if timing.get("instructions_per_unit")]
        rows.append([target, results[target].get("timing_revision", results[target]["revision"]), image, len(timings),
                     thousands(of_frame[worst]["worst"]), worst, max(shares, default="-"),
                     thousands(max(frame["hybrid_bound"] for frame in of_frame.values())),
                     f"{max(frame['worst_over_median'] or 0 for frame in of_frame.values()):.2f}",
                     largest_ms(timings, "modelled"), largest_ms(timings, "modelled_hybrid")])
    return ["", "## Most expensive frames", "", "Over all inputs of an image. Budget: 20 M instructions (goal 12 M), hybrid bound "
            "24 M, 41.57 ms at 600 MHz, worst/median 2.5. Share of units: instructions of a frame, without drawing, divided by "
            "what its [units of work](../explanation/work-limit.md) stand for (1,000 instructions of the Cortex-M7 each); the "
            "largest of all frames. Modelled in ms at 480 / 600 MHz.", "",
            *table(["target", "measured at", "image", "inputs:", "worst frame:", "of input", "share of units:",
                    "hybrid bound:", "worst/median:", "modelled worst:", "modelled hybrid:"], rows)]


def largest_ms(timings, what):
    modelled = [timing for timing in timings.values() if f"{what}_ms_600mhz" in timing]
    return milliseconds(max(modelled, key=lambda timing: timing[f"{what}_ms_600mhz"], default={}), what)


def never_run(results):
    rows = []
    for target, image, entry in timed_images(results):
        if "coverage" in entry:
            report = entry["coverage"]
            largest = ", ".join(f"`{short(each['name'])}` {each['instructions']}" for each in report["functions"][:5])
            rows.append([target, image, thousands(report["instructions"]), thousands(report["uncovered_instructions"]),
                         report["uncovered_blocks"], largest])
    return ["", "## Never run", "", "Instructions of the core that no frame of an image's inputs ran: refusals, "
            "rare branches, and what these inputs do not provoke. The bounds above do not cover them.", "",
            *table(["target", "image", "instructions of the core:", "never run:", "blocks:", "largest"], rows)]


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
    lines = table(["target", "image", "input", "worst frame:"],
                  [[target, image, name, f"{worst:,}"] for target, image, name, worst in rows])
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
    """`results` of the targets that were timed, as frame_timing.measure left them."""
    page = root / "docs/reference/timing.md"
    # Rows of images that were not timed here stay: the gate's own --renew writes them.
    before = read_gate(page) if page.exists() else {}
    worst = {key: count for key, count in before.items() if key[2] in GATE_INPUTS}
    worst.update({(target, image, name): timing["instructions"]["frame"]["worst"]
                  for target, image, name, timing in timings_of(results)
                  if target == GATE_TARGET and name in GATE_INPUTS and not image.endswith("_large")})
    gate = [(*key, count) for key, count in worst.items()]
    parts = [*most_expensive(results), *frames(results), *stages(results), *never_run(results)]
    renew(page, HEADING + GATE + gate_text(gate) + "\n".join(parts) + "\n", results)
