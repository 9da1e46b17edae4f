"""Writes docs/reference/footprint.md and docs/reference/targets.md from the results of firmware_report.py."""
import json
import re

BOARDS = ["cortex-m7", "cortex-m4f", "cortex-m33", "cortex-m55", "cortex-m7-clang"]
LINUX = ["aarch64-linux", "armhf-linux", "riscv64-linux"]
HOSTS = [f"host-{compiler}-{level}" for compiler in ("gcc", "clang") for level in ("O0", "O2", "O3")]
ORDER = BOARDS + LINUX + HOSTS
NEEDED = BOARDS[:1]

FOOTPRINT = """# Footprint

Bytes of the replay images: tracker, virtual objects, port and replay program together.
`scripts/firmware.sh` measures and writes this page; `tests/footprint/budget.json` is what CI allows.

Flash: code, constants and initial values. RAM: static data without stack and input frame; of it
filter (state and covariance), map (landmarks and candidates) and vision (detector, search, scratch);
tracker is the object that holds them. Stack: deepest path of the call graph from `main`, and the
painted high-water mark of the replays. Heap: none ([how that is held](no-heap.md)). Clang
compiles for size ([why](../how-to/build-firmware.md)) and writes no call graph, so its stack is the painted
one alone.

| image | tracker | configuration |
| --- | --- | --- |
| `vehicle_tiny`, `handheld_tiny` | vehicle / hand-held | 320x240; 16 landmarks / 16 features |
| `vehicle`, `handheld` | | 640x480; 64 / 32 |
| `vehicle_large`, `handheld_large` | | 1280x960; 128 / 50 |

## Images

| target | image | flash | RAM | filter | map | vision | tracker | input frame | stack | painted |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
"""
TARGETS = """# Targets that were compared with the host

Written by `scripts/firmware.sh`. For each target: the port's self-test, one hash per module of the core
(`exercise`), and for each replayed frame one hash over pose, covariance, landmarks and counters and one
over the picture with the virtual objects drawn into it. All compared with the host's, `g++ -O3`.
The inputs are recorded anew by each run (`tests/target/inputs.json`); `measured at` is the commit that
was compared, `unit tests` those of `scripts/firmware.sh --all`: test programs, gates and faults, with
their own commit where it is another.

"""


def keep_rows(earlier, text, measured):
    """`text` with the rows of targets that were not measured as `earlier`, the page of before, has them: in tables
    of the same heading, whose first column is the target."""
    kept = {}
    heading = None
    for line in earlier.splitlines():
        if not line.startswith("|"):
            heading = None
        elif line.startswith("| target |"):
            heading = line
        elif target_of(line) in ORDER and target_of(line) not in measured:
            kept.setdefault(heading, []).append(line)
    out, rows, heading = [], [], None
    for line in [*text.splitlines(), ""]:
        if heading is not None and target_of(line) in ORDER:
            rows.append(line)
            continue
        if rows and not line.startswith("|"):
            out += sorted(rows + kept.get(heading, []), key=lambda row: ORDER.index(target_of(row)))
            rows = []
        heading = line if line.startswith("| target |") else heading if line.startswith("|") else None
        out.append(line)
    return "\n".join(out[:-1]) + "\n"


def target_of(line):
    return line.split("|")[1].strip() if line.startswith("|") else None


def renew(page, text, measured):
    page.write_text(keep_rows(page.read_text() if page.exists() else "", text, measured))


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


def images_of(results):
    for target, entries in results.items():
        for image, entry in entries.items():
            if isinstance(entry, dict) and "ram_bytes" in entry:
                yield target, image, entry


def flash_rows(results):
    """Flash by part of the core."""
    rows = ["", "## Flash by part", "", "By the source that a function or table came from; code that was inlined counts "
            "where it ended up. `math`: elementary functions, camera, Eigen's kernels; `rest`: port, replay program, "
            "compiler's library, and tables without a source line.", ""]
    names = None
    for target, image, entry in images_of(results):
        if "flash_parts" not in entry:
            continue
        if names is None:
            names = list(entry["flash_parts"])
            rows += ["| target | image | " + " | ".join(names) + " |", "| --- | --- |" + " ---: |" * len(names)]
        rows.append(f"| {target} | {image} | " + " | ".join(str(entry["flash_parts"][name]) for name in names) + " |")
    return rows if names else []


def budget_rows(budgets):
    """Targets that share an image's budget share its row."""
    rows = ["", "## Budgets of CI, bytes", "", "| image | flash | RAM | stack | targets |",
            "| --- | ---: | ---: | ---: | --- |"]
    sharing = {}
    for target, images in budgets.items():
        for image, budget in images.items():
            sharing.setdefault((image, budget["flash_bytes"], budget["ram_bytes"], budget["stack_bytes"]),
                               []).append(target)
    return rows + [f"| {' | '.join(map(str, row))} | {', '.join(names)} |" for row, names in sharing.items()]


def footprint(root, results):
    rows = []
    for target, image, entry in images_of(results):
        if "flash_bytes" not in entry:
            continue
        ram = entry["ram_bytes"]
        figures = [entry["flash_bytes"], ram["total"], ram["filter"], ram["map"], ram["vision"],
                   ram["tracker"], entry["frame_buffer_bytes"], entry["stack_bytes"] or "-",
                   entry.get("stack_painted_bytes") or "-"]
        rows.append(f"| {target} | {image} | " + " | ".join(map(str, figures)) + " |")
    rows += flash_rows(results)
    rows += budget_rows(json.loads((root / "tests/footprint/budget.json").read_text()))
    first = next(iter(results))
    for image in ("vehicle", "handheld"):
        path = results[first].get(image, {}).get("stack_path")
        if not path:
            continue
        rows += ["", f"## Deepest path of `{image}` on {first}", "", "| frame | function |", "| ---: | --- |"]
        for step in path:
            size, name = step.split(" ", 1)
            rows.append(f"| {size} | `{name.replace('|', ' ')}` |")
    renew(root / "docs/reference/footprint.md", FOOTPRINT + "\n".join(rows) + "\n", results)


def unit_text(entries):
    units = entries.get("unit_tests")
    if units is None:
        return "-"
    at = f" at {units['revision']}" if "revision" in units else ""
    return f"{units['passed']} of {units['run']}{at}"


def targets(root, results):
    names = []
    for _, _, entry in images_of(results):
        names += [name for name in entry["inputs"] if name not in names]
    rows = ["| target | compiler | measured at | self-test | modules | unit tests | " + " | ".join(names) + " |",
            "| --- | --- | --- | --- | --- | --- |" + " ---: |" * len(names)]
    for target, entries in results.items():
        cells = {}
        for _, image, entry in images_of({target: entries}):
            for name, outcome in entry["inputs"].items():
                text = f"{outcome['frames']} equal" if outcome["hash_equal"] else "**differs**"
                cells[name] = f"{cells[name]}, {text}" if name in cells else text
        rows.append(f"| {target} | `{entries['compiler']}` | {entries['revision']} | "
                    f"{'good' if entries['selftest'] else '**bad**'} | "
                    f"{str(entries['modules']) + ' equal' if entries['modules_equal'] else '**differ**'} | "
                    f"{unit_text(entries)} | "
                    + " | ".join(cells.get(name, "-") for name in names) + " |")
    renew(root / "docs/reference/targets.md", TARGETS + "\n".join(rows) + "\n", results)


def write(root, results):
    footprint(root, results)
    targets(root, results)
