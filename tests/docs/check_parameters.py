#!/usr/bin/env python3
"""Compares docs/reference/parameters.md with the headers.

usage: check_parameters.py ROOT

A section of the page is headed by a struct, names its header, and has one row for each member with its default. A
member without a row, a row without a member, and another default are faults: exit status 1 and one line for each.
"""
import pathlib
import re
import sys

PAGE = "docs/reference/parameters.md"
SECTION = re.compile(r"^### `(?P<name>[\w:]+)`\n`(?P<header>core/[\w/.]+\.hpp)`", re.M)
ROW = re.compile(r"^\| `(\w+)` \|[^|]*\|[^|]*\| (?:`([^`]*)`)?", re.M)
MEMBER = re.compile(r"^(?:static constexpr )?(?:const )?(?:typename )?[\w:]+(?:<.*>)?(?:::\w+)?(?: const)?\*?\s+\*?(\w+)"
                    r"(?:\s*=\s*(.*)|\s*(\{.*\}))?$", re.S)


def body_of(text, name):
    """The inside of `struct name`, without nested braces of functions and types; None where there is none."""
    found = re.search(rf"\bstruct {name}\b[^;{{]*{{", text)
    if found is None:
        return None
    depth, kept = 1, []
    for letter in re.sub(r"//[^\n]*", "", text[found.end():]):
        if letter == "{":
            depth += 1
        elif letter == "}":
            depth -= 1
            if depth == 0:
                break
        kept.append(letter)
    return "".join(kept)


def statements(body):
    """Statements of the struct itself; a function, constructor or nested type ends with its brace."""
    depth, start, found = 0, 0, []
    for at, letter in enumerate(body):
        depth += (letter == "{") - (letter == "}")
        if depth == 0 and letter in ";}":
            statement = body[start:at + (letter == "}")].strip()
            initialiser = letter == "}" and re.search(r"=\s*{[^{}]*}$", statement)
            if initialiser:
                continue
            if letter == ";" and statement:
                found.append(statement)
            start = at + 1
    return found


def plain(default):
    """A default as the page writes it: without suffixes, casts, template brackets and qualifiers."""
    text = re.sub(r"static_cast<\w+>", "", default)
    text = re.sub(r"\b[A-Z]\w*(?:<[^>]*>)?::(?=[kZ]\w)", "", text)
    text = re.sub(r"\bT\(([^()]*)\)|\bScalar\(([^()]*)\)", lambda m: m[1] or m[2], text)
    text = re.sub(r"^\((.*)\)$", r"\1", text.strip())
    text = re.sub(r"(?<=[\d.])[FU]\b", "", text)
    text = re.sub(r"\b(\d+)\.0\b", r"\1", text)
    return " ".join(text.split())


def members_of(text, name):
    body = body_of(text, name)
    if body is None:
        return None
    members = {}
    for statement in statements(body):
        if re.match(r"(using|friend|static_assert|enum|struct|template|\[\[)\b", statement) or "operator" in statement:
            continue
        fixed = statement.startswith("static constexpr")
        if fixed and not name.endswith("Config"):
            continue
        match = MEMBER.match(" ".join(statement.split()))
        if match and not re.search(r"\)\s*(const)?$", statement.split("=")[0].strip()):
            members[match[1]] = plain(match[2]) if match[2] else None
    return members


def check(root):
    page = (root / PAGE).read_text()
    sections = list(SECTION.finditer(page))
    faults = [] if sections else [f"{PAGE}: no section names a header"]
    for section, following in zip(sections, [*sections[1:], None]):
        where = f"{PAGE}: {section['name']}"
        header = root / section["header"]
        members = members_of(header.read_text(), section["name"].split("::")[-1]) if header.is_file() else None
        if members is None:
            faults.append(f"{where}: {section['header']} has no such struct")
            continue
        text = page[section.end():following.start() if following else len(page)]
        rows = {name: default for name, default in ROW.findall(text)}
        faults += [f"{where}: no row for {name}" for name in members if name not in rows]
        faults += [f"{where}: {name} is not in {section['header']}" for name in rows if name not in members]
        faults += [f"{where}: {name}: the page says {rows[name] or 'no default'}, the header {default}"
                   for name, default in members.items() if default and name in rows and rows[name] != default]
    return faults


def main(arguments):
    if len(arguments) != 1 or not (pathlib.Path(arguments[0]) / PAGE).is_file():
        print(__doc__, file=sys.stderr)
        return 2
    faults = check(pathlib.Path(arguments[0]))
    print("\n".join([*faults, f"check_parameters: {len(faults)} faults"]))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
