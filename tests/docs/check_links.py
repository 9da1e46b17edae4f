#!/usr/bin/env python3
"""Checks the links of the documentation.

usage: check_links.py ROOT [SOURCE_FOLDER ...]

Every relative link and picture of the pages of the top folder, of docs/ and of examples/ must lead to a file inside ROOT, and its
anchor to a heading of that file, by GitHub's rules. Every one of these pages must be reachable from README.md. Every
page that a C or C++ source in a SOURCE_FOLDER names (docs/....md) must exist.
Exit status 1 and one line per fault, FILE:LINE: what is wrong; 2 for a wrong call.
"""
import pathlib
import re
import sys
import urllib.parse

LINK = re.compile(r"!?\[(?:[^\]\[]|\[[^\]]*\])*\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
DEFINITION = re.compile(r"^ {0,3}\[[^\]]+\]:\s*<?([^\s>]+)>?")
HEADING = re.compile(r"^ {0,3}(#{1,6})\s+(.*?)\s*#*\s*$")
FENCE = re.compile(r"^ {0,3}(```|~~~)")
EXTERNAL = re.compile(r"^[a-z][a-z0-9+.-]*:", re.IGNORECASE)
MENTION = re.compile(r"\bdocs/[\w./-]*\w\.md\b")
SOURCES = {".hpp", ".h", ".cpp", ".c"}


def prose_lines(text):
    """(number, line) of a page without its fenced and indented code, inline code left blank."""
    fence, after_blank, in_code = None, True, False
    for number, line in enumerate(text.splitlines(), 1):
        mark = FENCE.match(line)
        if mark and fence is None:
            fence = mark[1]
        elif mark and mark[1] == fence:
            fence = None
        elif fence is None:
            indented = line.startswith("    ")
            in_code = indented and (after_blank or in_code)
            if not in_code:
                yield number, re.sub(r"(`+)(.+?)\1", lambda code: " " * len(code[0]), line)
            after_blank = not line.strip()


def slug(heading):
    """GitHub's anchor of a heading's text."""
    text = re.sub(r"!?\[((?:[^\]\[]|\[[^\]]*\])*)\]\([^)]*\)", r"\1", heading)
    text = re.sub(r"[`*]", "", text).strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def anchors_of(text):
    """Anchors of every heading; a repeated one gets -1, -2 and so on."""
    found, seen, fence = set(), {}, None
    for line in text.splitlines():
        mark = FENCE.match(line)
        if mark:
            fence = mark[1] if fence is None else None if mark[1] == fence else fence
        heading = HEADING.match(line) if fence is None and not mark else None
        if heading is None:
            continue
        name = slug(heading[2])
        count = seen.get(name, 0)
        seen[name] = count + 1
        found.add(f"{name}-{count}" if count else name)
    return found


def links_of(text):
    """(line number, target) of every link."""
    for number, line in prose_lines(text):
        for match in LINK.finditer(line):
            yield number, match[1]
        definition = DEFINITION.match(line)
        if definition:
            yield number, definition[1]


def pages_of(root):
    return [page for top in (root.glob("*.md"), (root / "docs").rglob("*.md"), (root / "examples").rglob("*.md"))
            for page in sorted(top)]


def fault_of(root, page, target, pages):
    """(fault or None, the file the link leads to or None)."""
    path, _, anchor = urllib.parse.unquote(target).partition("#")
    if path.startswith("/"):
        return f"{target}: not relative", None
    file = (page.parent / path).resolve() if path else page
    if root != file and root not in file.parents:
        return f"{target}: leads out of the project", None
    if not file.exists():
        return f"{target}: no such file", None
    if anchor and file.suffix == ".md":
        if file not in pages:
            pages[file] = file.read_text()
        if anchor not in anchors_of(pages[file]):
            return f"{target}: no heading has this anchor", file
    return None, file


def check_pages(root):
    faults, pages, leads_to = [], {page: page.read_text() for page in pages_of(root)}, {}
    for page in list(pages):
        leads_to[page] = set()
        for number, target in links_of(pages[page]):
            if EXTERNAL.match(target):
                continue
            fault, file = fault_of(root, page, target, pages)
            if fault:
                faults.append(f"{page.relative_to(root)}:{number}: {fault}")
            if file is not None:
                leads_to[page].add(file)
    return faults + orphans(root, leads_to)


def orphans(root, leads_to):
    start = root / "README.md"
    reached, waiting = {start}, [start]
    while waiting:
        for file in leads_to.get(waiting.pop(), ()):
            if file not in reached:
                reached.add(file)
                waiting.append(file)
    return [f"{page.relative_to(root)}:1: no chain of links from README.md leads to this page"
            for page in leads_to if page not in reached]


def check_mentions(root, folders):
    faults = []
    for folder in folders:
        for source in sorted((root / folder).rglob("*")):
            if source.suffix not in SOURCES or not source.is_file():
                continue
            for number, line in enumerate(source.read_text(errors="replace").splitlines(), 1):
                for name in MENTION.findall(line):
                    if not (root / name).is_file():
                        faults.append(f"{source.relative_to(root)}:{number}: {name}: no such page")
    return faults


def main(arguments):
    if not arguments or not (pathlib.Path(arguments[0]) / "README.md").is_file():
        print(__doc__, file=sys.stderr)
        return 2
    root = pathlib.Path(arguments[0]).resolve()
    faults = check_pages(root) + check_mentions(root, arguments[1:])
    for fault in faults:
        print(fault)
    print(f"check_links: {len(pages_of(root))} pages, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
