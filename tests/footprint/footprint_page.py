"""Writes docs/reference/footprint.md and docs/reference/targets.md from the results of firmware_report.py."""
import json
import re

from page_tables import BOARDS, images_of, line, renew, table

NEEDED = BOARDS[:1]

FOOTPRINT = """# Footprint

Bytes of the replay images: tracker, virtual objects, port and replay program together.
`scripts/firmware.sh` measures and writes this page; `tests/footprint/budget.json` is what CI allows.

Flash: code, constants and initial values. RAM: static data without stack and input frame; of it
filter (state and covariance), map (landmarks and seeds) and vision (detector, search, scratch);
tracker is the object that holds them. Stack: deepest path of the call graph from `main`, and the
painted high-water mark of the replays. Heap: none ([how that is held](no-heap.md)). Clang compiles for
size ([why](../results/frame-cost.md#compilers)) and writes no call graph, so its stack is the painted one only.

| image | tracker | configuration |
| --- | --- | --- |
| `vehicle_tiny`, `handheld_tiny` | vehicle / hand-held | 320x240; 16 landmarks / 16 features |
| `vehicle`, `handheld` | | 640x480; 64 / 32 |
| `vehicle_large`, `handheld_large` | | 1280x960; 128 / 50 |

`window`, the default of hand-held mode, and `window_tiny` are in the first table alone. The others are of an earlier
commit, that of [the targets](targets.md), until `scripts/firmware.sh` is run.

## What a build needs

By `tests/footprint/memory.py` with `--renew`, from a board's build alone.

"""
BUILD_COLUMNS = ["target", "image", "measured at", "flash:", "RAM:", "stack:"]
IMAGE_COLUMNS = ["target", "image", "flash:", "RAM:", "filter:", "map:", "vision:", "tracker:", "input frame:",
                 "stack:", "painted:"]
TARGETS = """# Targets that were compared with the host

Written by `scripts/firmware.sh`. For each target: the port's self-test, one hash per module of the core
(`exercise`), and for each replayed frame one hash over pose, covariance, landmarks and counters and one
over the picture with the virtual objects drawn into it. All are compared with the host's, `g++ -O3`: a replay
program's column gives the number of equal frames of its [inputs](#inputs), and the inputs that differ. `tiny`,
`large`: [configurations](footprint.md). `measured at` is the commit that was compared, `unit tests` those of
`scripts/firmware.sh --all`: test programs, gates and faults, with their own commit where it is another. The image
`window`, the default of hand-held mode, is compared by CI alone: its tiny configuration on a Cortex-M7 by GCC, its
default one by the [frame gate](timing.md#gate).

"""
INPUTS = """
## Inputs

`tests/target/inputs.json`, recorded anew by each run. Each stress scene drives one part of a frame towards its
worst case ([what they are](command-line.md#stress-scenes)).

"""
REPLAYS = ["vehicle", "handheld", "vehicle_tiny", "handheld_tiny", "vehicle_large", "handheld_large"]


def compiler_of(root, target):
    """Compiler, its version, and the options of optimisation and CPU, as the build used them."""
    build = root / "build" / target
    about = next((build / "CMakeFiles").glob("*/CMakeCXXCompiler.cmake")).read_text()
    kind = re.search(r'CMAKE_CXX_COMPILER_ID "(.*)"', about)[1].replace("GNU", "GCC")
    version = re.search(r'CMAKE_CXX_COMPILER_VERSION "(.*)"', about)[1]
    commands = json.loads((build / "compile_commands.json").read_text())
    core = next(c["command"] for c in commands if c["file"].endswith("core/src/numeric/math.cpp"))
    kept = [flag for flag in core.split() if re.match(r"-O|-m", flag)]
    return f"{kind} {version} {' '.join(kept)}"


def flash_rows(results):
    """Flash by part of the core."""
    rows = ["", "## Flash by part", "", "By the source that a function or table came from; code that was inlined counts "
            "where it ended up. `math`: elementary functions, camera, Eigen's kernels; `rest`: port, replay program, "
            "compiler's library, and tables without a source line.", ""]
    parted = [(target, image, entry["flash_parts"]) for target, image, entry in images_of(results)
              if "flash_parts" in entry]
    if not parted:
        return []
    names = list(parted[0][2])
    return rows + table(["target", "image", *(f"{name}:" for name in names)],
                        [[target, image, *(parts[name] for name in names)] for target, image, parts in parted])


def budget_rows(budgets):
    """Targets that share an image's budget share its row."""
    sharing = {}
    for target, images in budgets.items():
        for image, budget in images.items():
            sharing.setdefault((image, budget["flash_bytes"], budget["ram_bytes"], budget["stack_bytes"]),
                               []).append(target)
    return ["", "## Budgets of CI, bytes", "",
            *table(["image", "flash:", "RAM:", "stack:", "targets"],
                   [[*row, ", ".join(names)] for row, names in sharing.items()])]


def build_row(target, image, revision, flash, ram, stack):
    return line([target, image, revision, flash, ram, stack or "-"])


def build_rows(results):
    for target, image, entry in images_of(results):
        if "flash_bytes" in entry:
            yield build_row(target, image, results[target]["revision"], entry["flash_bytes"],
                            entry["ram_bytes"]["total"], entry["stack_bytes"])


def image_rows(results):
    for target, image, entry in images_of(results):
        if "flash_bytes" in entry:
            ram = entry["ram_bytes"]
            yield [target, image, entry["flash_bytes"], ram["total"], ram["filter"], ram["map"], ram["vision"],
                   ram["tracker"], entry["frame_buffer_bytes"], entry["stack_bytes"] or "-",
                   entry.get("stack_painted_bytes") or "-"]


def deepest_rows(results):
    first = next(iter(results))
    rows = []
    for image in ("vehicle", "handheld"):
        path = results[first].get(image, {}).get("stack_path")
        if path:
            steps = [step.split(" ", 1) for step in path]
            rows += ["", f"## Deepest path of `{image}` on {first}", "",
                     *table(["frame:", "function"], [[size, f"`{name.replace('|', ' ')}`"] for size, name in steps])]
    return rows


def footprint(root, results):
    rows = [*table(BUILD_COLUMNS, []), *build_rows(results), "", "## Parts of the images", "",
            *table(IMAGE_COLUMNS, image_rows(results)), *flash_rows(results),
            *budget_rows(json.loads((root / "tests/footprint/budget.json").read_text())), *deepest_rows(results)]
    renew(root / "docs/reference/footprint.md", FOOTPRINT + "\n".join(rows) + "\n", results)


def unit_text(entries):
    units = entries.get("unit_tests")
    if units is None:
        return "-"
    at = f" at {units['revision']}" if "revision" in units else ""
    return f"{units['passed']} of {units['run']}{at}"


def replay_text(entry):
    """What one replay program's frames came to."""
    if entry is None:
        return "-"
    different = [name for name, outcome in entry["inputs"].items() if not outcome["hash_equal"]]
    if different:
        return f"**differs**: {', '.join(different)}"
    return f"{entry['frames']:,} equal" if entry["inputs"] else "-"


def target_rows(results):
    for target, entries in results.items():
        yield [target, f"`{entries['compiler']}`", entries["revision"], "good" if entries["selftest"] else "**bad**",
               f"{entries['modules']} equal" if entries["modules_equal"] else "**differ**", unit_text(entries),
               *(replay_text(entries.get(image)) for image in REPLAYS)]


def input_rows(results, sources):
    """Each input with its frames and the programs that replay it; `sources`: entries of inputs.json."""
    frames, programs = {}, {}
    for _, image, entry in images_of(results):
        for name, outcome in entry["inputs"].items():
            frames[name] = outcome["frames"]
            programs.setdefault(name, {})[image] = None
    for each in sources:
        if each["name"] in frames:
            yield [each["name"], frames[each["name"]], f"`{each['source']}`", ", ".join(programs[each["name"]])]


def targets(root, results):
    sources = json.loads((root / "tests/target/inputs.json").read_text())["inputs"]
    columns = ["target", "compiler", "measured at", "self-test", "modules", "unit tests",
               *(image.replace("_", " ") + ":" for image in REPLAYS)]
    text = (TARGETS + "\n".join(table(columns, target_rows(results))) + "\n" + INPUTS
            + "\n".join(table(["input", "frames:", "source", "replayed by"], input_rows(results, sources))) + "\n")
    renew(root / "docs/reference/targets.md", text, results)


def write(root, results):
    footprint(root, results)
    targets(root, results)
