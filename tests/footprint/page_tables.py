"""Tables of the reference pages whose first column is the target."""

BOARDS = ["cortex-m7", "cortex-m4f", "cortex-m33", "cortex-m55", "cortex-m7-clang"]
LINUX = ["aarch64-linux", "armhf-linux", "riscv64-linux"]
HOSTS = [f"host-{compiler}-{level}" for compiler in ("gcc", "clang") for level in ("O0", "O2", "O3")]
ORDER = BOARDS + LINUX + HOSTS


def images_of(results):
    """(target, image, entry) of every replay image that was measured."""
    for target, entries in results.items():
        for image, entry in entries.items():
            if isinstance(entry, dict) and "ram_bytes" in entry:
                yield target, image, entry


def table(columns, rows):
    """Lines of a table. A column's name that ends in ':' is set to the right, for figures."""
    rules = ["---:" if name.endswith(":") else "---" for name in columns]
    return [line([name.rstrip(":") for name in columns]), line(rules), *(line(row) for row in rows)]


def line(cells):
    return f"| {' | '.join(map(str, cells))} |"


def target_of(text):
    return text.split("|")[1].strip() if text.startswith("|") else None


def tables_of(lines):
    """(heading, lines) of each stretch of a page: a table of targets, or what lies between (heading None)."""
    heading, stretch = None, []
    for text in lines:
        ends = heading is not None and not text.startswith("|")
        begins = text.startswith("| target |")
        if (ends or begins) and stretch:
            yield heading, stretch
            stretch = []
        heading = text if begins else None if ends else heading
        stretch.append(text)
    if stretch:
        yield heading, stretch


def keep_rows(earlier, text, measured):
    """`text` with the rows of targets that were not measured as `earlier`, the page of before, has them: in tables
    of the same heading, whose first column is the target."""
    kept = {heading: [row for row in rows if target_of(row) in ORDER and target_of(row) not in measured]
            for heading, rows in tables_of(earlier.splitlines()) if heading is not None}
    out = []
    for heading, lines in tables_of(text.splitlines()):
        if heading is None:
            out += lines
            continue
        rows = [row for row in lines if target_of(row) in ORDER] + kept.get(heading, [])
        out += [row for row in lines if target_of(row) not in ORDER]
        out += sorted(rows, key=lambda row: ORDER.index(target_of(row)))
    return "\n".join(out) + "\n"


def with_rows(text, heading, target, rows):
    """The page `text` with `rows` in place of the target's in every table of this heading."""
    out = []
    for found, lines in tables_of(text.splitlines()):
        if found == heading:
            body = [row for row in lines if target_of(row) in ORDER and target_of(row) != target] + rows
            lines = [row for row in lines if target_of(row) not in ORDER]
            lines += sorted(body, key=lambda row: ORDER.index(target_of(row)))
        out += lines
    return "\n".join(out) + "\n"


def renew(page, text, measured):
    page.write_text(keep_rows(page.read_text() if page.exists() else "", text, measured))
