"""Modelled cycles of counted blocks, by llvm-mca's Cortex-M7 model: each block as a loop (steady state)
and as a single pass (pipeline drained), plus one cycle per block for the branch. Caches, flash wait
states and mispredicted branches are not in the model: expect 30 to 50 % more or less on silicon.
"""
import bisect
import re
import subprocess

CONDITION = "(eq|ne|cs|cc|hs|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le|al)"
BRANCH = re.compile(rf"^(b|bl|cbz|cbnz|b{CONDITION})(\.[nw])?$")


def read_counts(path):
    """(instructions per frame, [(address, instructions, count in worst frame, largest count)])"""
    frames, blocks = [], []
    for line in open(path):
        field = line.strip().split(",")
        if field[0] == "F":
            frames.append(int(field[2]))
        else:
            blocks.append((int(field[1], 16), int(field[2]), int(field[4]), int(field[5])))
    return frames, blocks


def disassemble(image):
    text = subprocess.run(
        ["llvm-objdump", "-d", "--no-show-raw-insn", "--triple=thumbv7em-none-eabihf",
         "--mcpu=cortex-m7", image], capture_output=True, text=True, check=True).stdout
    code = {}
    for line in text.splitlines():
        found = re.match(r"^\s+([0-9a-f]+):\s+(\S+)\s*(.*)$", line)
        if found:
            code[int(found[1], 16)] = (found[2], re.sub(r"\s*(@|<).*$", "", found[3]).strip())
    return code


def without_condition(operation):
    found = re.match(rf"^([a-z0-9]+?){CONDITION}((\.[a-z0-9]+)*)$", operation)
    return found[1] + found[3] if found else operation


IT = re.compile(r"^it[te]{0,3}$")


def open_conditions(code, addresses, start):
    """How many instructions from `start` on an IT before it covers: a block may begin inside."""
    for back in range(1, 5):
        if start < back:
            break
        operation = code[addresses[start - back]][0]
        if IT.match(operation):
            return max(0, len(operation) - back)
    return 0


def block_text(code, addresses, address, count):
    """Instructions of a block in a form that the model accepts: it lacks IT and compares of floats,
    and books 100 cycles for any call."""
    start = bisect.bisect_left(addresses, address)
    lines, conditional = [], open_conditions(code, addresses, start)
    for at in addresses[start:start + count]:
        operation, arguments = code[at]
        if IT.match(operation):
            conditional = len(operation) - 1
            lines.append("\tnop")
            continue
        if conditional:
            operation = without_condition(operation)
            conditional -= 1
        if BRANCH.match(operation):
            arguments = arguments.rsplit(",", 1)[0] + ", target" if "," in arguments else "target"
        if re.match(r"^bl(\.w)?$", operation):
            operation = "b"
        elif re.match(r"^blx(ns)?$", operation):
            operation, arguments = "bx", "lr"
        if operation.startswith(("vcmp", "bkpt", ".", "<")):
            operation, arguments = "nop", ""
        lines.append(f"\t{operation}\t{arguments}")
    return lines


def simulate(texts, iterations):
    source = []
    for k, lines in enumerate(texts):
        source += [f"# LLVM-MCA-BEGIN r{k}"] + lines + [f"# LLVM-MCA-END r{k}"]
    done = subprocess.run(
        ["llvm-mca", "-mtriple=thumbv7em-none-eabihf", "-mcpu=cortex-m7",
         f"-iterations={iterations}", "-instruction-info=false", "-resource-pressure=false"],
        input="\n".join(source) + "\n", capture_output=True, text=True)
    cycles = {int(m[1]): int(m[2]) for m in
              re.finditer(r"Code Region - r(\d+)\n.*?Total Cycles:\s+(\d+)", done.stdout, re.S)}
    # The model stops at the first instruction it does not know: then there are fewer regions.
    if len(cycles) != len(texts):
        raise RuntimeError(f"llvm-mca knew {len(cycles)} of {len(texts)} blocks: {done.stderr[:300]}")
    return cycles


def modelled(image, counts_path):
    """{worst: cycles of the worst frame, hybrid: of every block at its largest count}, each (steady,
    one pass)."""
    _, blocks = read_counts(counts_path)
    code = disassemble(image)
    addresses = sorted(code)
    texts = [block_text(code, addresses, b[0], b[1]) for b in blocks]
    once, ten, thirty = simulate(texts, 1), simulate(texts, 10), simulate(texts, 30)
    total = {"worst": [0.0, 0.0], "hybrid": [0.0, 0.0]}
    for k, (_, _, in_worst, largest) in enumerate(blocks):
        steady = (thirty[k] - ten[k]) / 20 + 1
        single = max(once[k] + 1, steady)
        for name, count in (("worst", in_worst), ("hybrid", largest)):
            total[name][0] += count * steady
            total[name][1] += count * single
    return total
