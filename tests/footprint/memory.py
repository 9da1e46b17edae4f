#!/usr/bin/env python3
"""Memory of the replay images of a firmware build: flash, static RAM, worst stack by call graph.

usage: memory.py BUILD_FOLDER SIZE_TOOL BUDGET_FILE BOARD [--renew PAGE]
Fails when an image needs more than its budget (bytes), or when one has no budget. --renew writes the board's rows
of docs/reference/footprint.md.
"""
import json
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "gates"))
import call_graph  # noqa: E402
import footprint_page  # noqa: E402
import page_tables  # noqa: E402

FLASH = {".text", ".ARM.extab", ".ARM.exidx", ".init_array", ".data"}
RAM = {".data", ".bss"}
# Calls through a pointer in a replay: the tick source handed in and, in the port, constructors.
INDIRECT_BYTES = 16


def images(build):
    return sorted(p for p in (build / "bin").glob("replay_*.elf"))


def name_of(image):
    return image.stem.removeprefix("replay_")


def sections(size_tool, image):
    text = subprocess.run([size_tool, "-A", image], capture_output=True, text=True, check=True).stdout
    return {m[1]: int(m[2]) for m in re.finditer(r"^(\.\S+)\s+(\d+)", text, re.M)}


# Which part of the core a symbol's source belongs to; what lies elsewhere (port, replay, libraries) is "rest".
PARTS = [
    ("filter", r"core/(include/cairn|src)/(planar|mono|estimation)/|packed_symmetric"),
    ("map", r"core/(include/cairn|src)/map/|tracking/(candidate|landmark)"),
    ("vision", r"core/(include/cairn|src)/vision/|tracking/(feature_supply|active_search|appearance|patch_search)"),
    ("drawing", r"core/(include/cairn|src)/ar/"),
    ("tracker", r"core/(include/cairn|src)/(tracking|runtime)/"),
    ("math", r"core/(include/cairn|src)/(base|numeric|geometry)/|eigen3/"),
]


def flash_parts(nm_tool, image):
    """Bytes of code and constants by part of the core, by the source that a symbol came from."""
    text = subprocess.run([nm_tool, "-S", "-l", image], capture_output=True, text=True, check=True).stdout
    parts = {name: 0 for name, _ in PARTS}
    parts["rest"] = 0
    counted = set()  # several names may stand for one place
    for address, size, source in re.findall(r"^([0-9a-f]+) ([0-9a-f]+) [tTwWrRvVdD] [^\t\n]*(?:\t(.*))?$", text, re.M):
        if address in counted:
            continue
        counted.add(address)
        found = next((name for name, pattern in PARTS if re.search(pattern, source)), "rest")
        parts[found] += int(size, 16)
    return parts


def stack(build, image):
    """(bytes of the deepest path from main, that path as text, what stands against the figure); 0 where
    the compiler wrote no call graph"""
    if next((build / "core").rglob("*.ci"), None) is None:
        return 0, [], []
    graph = call_graph.graph_of([build / "core", build / "port/CMakeFiles/cairn_port.dir",
                                 build / f"tests/target/CMakeFiles/{image.stem}.dir"])
    faults = [f"recursion: {[graph.name(f) for f in c]}" for c in graph.cycles()]
    if faults:
        return 0, [], faults
    total, path, unknown = graph.deepest("main", call_graph.EXTERNAL, INDIRECT_BYTES)
    return total, [f"{size} {graph.name(function)}" for function, size in path], list(unknown)


def memory_of(build, size_tool, image):
    size = sections(size_tool, image)
    stack_bytes, path, faults = stack(build, image)
    return {
        "flash_bytes": sum(v for k, v in size.items() if k in FLASH),
        "ram_bytes": sum(v for k, v in size.items() if k in RAM),
        "frame_bytes": size.get(".frames", 0),
        "stack_bytes": stack_bytes,
        "stack_path": path,
        "stack_faults": faults,
    }


def revision_of(build):
    done = subprocess.run(["git", "describe", "--always", "--dirty", "--abbrev=7"], cwd=build, capture_output=True,
                          text=True)
    return done.stdout.strip() or "unknown"


def renew(page, build, board, memories):
    """The board's rows of the table of what a build needs."""
    revision = revision_of(build)
    rows = [footprint_page.build_row(board, image, revision, memory["flash_bytes"], memory["ram_bytes"],
                                     memory["stack_bytes"]) for image, memory in memories.items()]
    heading = page_tables.table(footprint_page.BUILD_COLUMNS, [])[0]
    page.write_text(page_tables.with_rows(page.read_text(), heading, board, rows))


def main():
    build, size_tool, budget_file, board = pathlib.Path(sys.argv[1]), *sys.argv[2:5]
    budgets = json.loads(pathlib.Path(budget_file).read_text()).get(board, {})
    bad = 0
    memories = {}
    for image in images(build):
        memory = memories[name_of(image)] = memory_of(build, size_tool, image)
        budget = budgets.get(name_of(image))
        print(f"{name_of(image)}:")
        for key in ("flash_bytes", "ram_bytes", "stack_bytes"):
            allowed = budget[key] if budget else 0
            over = memory[key] > allowed
            bad += over
            print(f"  {key:12s} {memory[key]:8d} of {allowed:8d}{'  OVER' if over else ''}")
        for fault in memory["stack_faults"]:
            print(f"  {fault}")
        bad += len(memory["stack_faults"])
    if sys.argv[5:6] == ["--renew"]:
        renew(pathlib.Path(sys.argv[6]), build, board, memories)
    return 1 if bad or not memories else 0


if __name__ == "__main__":
    sys.exit(main())
