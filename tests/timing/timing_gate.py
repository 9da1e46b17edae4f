#!/usr/bin/env python3
"""Replays a few inputs of 640x480 on emulated boards: every frame must equal the host's, the worst
frame must not need more than 2 % more instructions than the table in docs/reference/timing.md says, and no
frame more than its units of work stand for.

--renew writes the table anew instead. Exit status 77 where the emulator cannot count instructions.
"""
import argparse
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
for folder in ("tests/footprint", "tests/target"):
    sys.path.insert(0, str(ROOT / folder))
import frame_timing  # noqa: E402
import inputs  # noqa: E402
import timing_page  # noqa: E402
from cycles import read_counts  # noqa: E402
from targets import Target  # noqa: E402

ALLOWED_GROWTH = 0.02


def replays(target, host, logs, out, plugin):
    for log in logs:
        image = log.images[0]
        _, counts, text = frame_timing.count_blocks(target, image, log.log, out, plugin)
        frames, _ = read_counts(counts)
        _, expected = host.run(f"replay_{image}", [log.log, "--overlay", "yes"])
        per_unit = frame_timing.instructions_per_unit(*frame_timing.stage_counts(target, image, log.log))
        yield (target.name, image, log.name, max(frames)), len(frames), text == expected, per_unit


def judge(row, frames, equal, per_unit, table):
    """Prints what came out for one input; whether it is good."""
    *key, worst = row
    name = " ".join(key)
    if not equal:
        print(f"{name}: NOT EQUAL to the host; compare_runs.py shows where")
    allowed = table.get(tuple(key))
    if allowed is None:
        print(f"{name}: docs/reference/timing.md has no row; timing_gate.py --renew writes it")
        return False
    growth = worst / allowed - 1
    print(f"{name}: {frames} frames, worst {worst} instructions, {100 * growth:+.2f} % against the table")
    if growth > ALLOWED_GROWTH:
        print("  TOO EXPENSIVE: make it cheaper, or renew the table with timing_gate.py --renew and say why")
    if per_unit is not None:
        print(f"  at most {per_unit} of what its units of work stand for")
    within_units = per_unit is None or per_unit <= 1
    if not within_units:
        print("  MORE INSTRUCTIONS THAN ITS UNITS STAND FOR: correct the costs in core/include/cairn/tracking/work_budget.hpp")
    return equal and within_units and growth <= ALLOWED_GROWTH


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--renew", action="store_true")
    parser.add_argument("--host", type=pathlib.Path, default=ROOT / "build/host")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build/host/timing_gate")
    parser.add_argument("targets", nargs="*", default=[timing_page.GATE_TARGET])
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    plugin = frame_timing.build_plugin(args.out)
    refusal = frame_timing.plugin_refusal(plugin)
    if refusal is not None:
        print(f"skipped: {refusal}")
        return 77
    logs = inputs.record(args.host, args.out, timing_page.GATE_INPUTS)
    host = Target(args.host)
    measured = [each for name in args.targets
                for each in replays(Target(ROOT / "build" / name), host, logs, args.out, plugin)]
    page = ROOT / "docs/reference/timing.md"
    if args.renew:
        timing_page.replace_gate(page, [row for row, *_ in measured])
        return 0
    table = timing_page.read_gate(page)
    bad = sum(not judge(*each, table) for each in measured)
    return 1 if bad or not measured else 0


if __name__ == "__main__":
    sys.exit(main())
