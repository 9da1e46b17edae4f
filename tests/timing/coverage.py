"""Which instructions of the core no measured frame ran: a bound that rests on observed counts says
nothing about them.
"""
import bisect
import re
import subprocess

import cycles

ENDS_BLOCK = re.compile(rf"^(b{cycles.CONDITION}?|bl|blx|bx|cbz|cbnz|tb[bh])(\.[nw])?$")
# Not part of a frame: set-up, and what the replay program itself does.
OUTSIDE = re.compile(r"::initialise\(|start_replay|InputLog|LogHeader|::validate\(|decode_|crc32|make_cairn"
                     r"|make_ring_part|^orient|^add_edges|Hash64|::hash|add_to_hash|to_string|cairn_test::|_GLOBAL__"
                     r"|::(\w+)(<.*>)?::\1\(\)$")  # the last: constructors of objects at rest
REPLAY = re.compile(r"::replay\(|::process\(|^main$|print_")


def functions_of(elf):
    """[(first address, end, readable name)] in order of address."""
    text = subprocess.run(["arm-none-eabi-nm", "-CSn", "--defined-only", elf], capture_output=True,
                          text=True, check=True).stdout
    found = re.findall(r"^([0-9a-f]+) ([0-9a-f]+) [tTwW] (.*)$", text, re.M)
    return [(int(a, 16) & ~1, (int(a, 16) & ~1) + int(size, 16), name) for a, size, name in found]


def lines_of(elf, addresses):
    """address -> (function, file:line) of the innermost piece of the core's own source."""
    text = subprocess.run(["arm-none-eabi-addr2line", "-aifC", "-e", elf], capture_output=True, text=True,
                          input="\n".join(f"0x{a:x}" for a in addresses), check=True).stdout
    places, address, frames = {}, None, []
    rows = text.splitlines() + ["0x0"]
    k = 0
    while k < len(rows):
        if re.match(r"^0x[0-9a-f]+$", rows[k]):
            if address is not None:
                own = [f for f in frames if "/core/" in f[1]]
                if own and not REPLAY.search(own[0][0]) and not any(OUTSIDE.search(f[0]) for f in frames):
                    places[address] = (own[0][0], own[0][1].split("/core/", 1)[1].split(" ")[0])
            address, frames = int(rows[k], 16), []
            k += 1
        else:
            frames.append((rows[k], rows[k + 1]))
            k += 2
    return places


def blocks_of(code, addresses, functions):
    """Straight pieces of code as lists of addresses; data between functions is left out."""
    starts = [f[0] for f in functions]
    block, last_function = [], None
    for at in addresses:
        operation, _ = code[at]
        k = bisect.bisect_right(starts, at) - 1
        function = k if k >= 0 and at < functions[k][1] else None
        if function is None or operation.startswith((".", "<")):
            if block:
                yield block
            block = []
            continue
        if function != last_function and block:
            yield block
            block = []
        last_function = function
        block.append(at)
        if ENDS_BLOCK.match(operation):
            yield block
            block = []
    if block:
        yield block


def report(elf, executed_blocks, path):
    """Writes the list of blocks that never ran to `path` and sums it up by function."""
    code = cycles.disassemble(elf)
    addresses = sorted(code)
    ran = set()
    for address, count in executed_blocks:
        start = bisect.bisect_left(addresses, address)
        ran.update(addresses[start:start + count])
    blocks = list(blocks_of(code, addresses, functions_of(elf)))
    pieces = []  # runs of unexecuted instructions inside a block: a branch target may split it
    for block in blocks:
        rest = [at for at in block if at not in ran]
        if rest:
            pieces.append(rest)
    places = lines_of(elf, [piece[0] for piece in pieces])
    covered = lines_of(elf, sorted({block[0] for block in blocks} - {p[0] for p in pieces}))
    total = sum(len(block) for block in blocks if block[0] in covered or block[0] in places)
    by_function, listed = {}, []
    for piece in pieces:
        if piece[0] not in places:
            continue
        function, line = places[piece[0]]
        by_function[function] = by_function.get(function, 0) + len(piece)
        listed.append((line, f"{line}  0x{piece[0]:x}  {len(piece)} instructions  {function}"))
    path.write_text("\n".join(text for _, text in sorted(listed)) + "\n")
    ordered = sorted(by_function.items(), key=lambda item: (-item[1], item[0]))
    return {"instructions": total, "uncovered_instructions": sum(by_function.values()),
            "uncovered_blocks": len(listed), "list": str(path),
            "functions": [{"name": name, "instructions": count} for name, count in ordered[:20]]}
