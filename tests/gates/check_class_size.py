#!/usr/bin/env python3
"""No class of the core has more private member functions than a reader holds in mind: what has more is several parts.

usage: check_class_size.py LIMIT FOLDER
Prints the classes with most, and fails where one has more than LIMIT. Overloads count each. A limit that no class
reaches is too high, and fails.
"""
import pathlib
import re
import sys

NO_TEXT = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])'|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", re.S | re.M)
CLASS = re.compile(r"^(?:template\s*<.*>\s*)?(?:class|struct)\s+(?:\[\[[^\]]*\]\]\s*|alignas\([^)]*\)\s*)?([A-Za-z_][\w:]*)"
                   r"(?!.*[()]\s*(?:const)?$)", re.S)
ACCESS = re.compile(r"\s*(public|protected|private)\s*:(?!:)")
NO_FUNCTION = re.compile(r"^(using|typedef|friend|static_assert|enum)\b")
FUNCTION = re.compile(r"(\boperator\b[^;{]*?\(|(?<![\w.])~?(?!(?:sizeof|alignof|decltype|noexcept|__attribute__)\b)"
                      r"[A-Za-z_]\w*\s*\()")


def plain(text):
    """Text without comments, strings and preprocessor lines; lines stay."""
    return NO_TEXT.sub(lambda m: "\n" * m[0].count("\n"), text)


def end_of_block(text, at):
    """Place of the brace that closes the one at `at`."""
    depth = 0
    for place in range(at, len(text)):
        depth += (text[place] == "{") - (text[place] == "}")
        if depth == 0:
            return place
    raise ValueError(f"unbalanced braces near: {text[at:at + 60]!r}")


def is_function(statement):
    head = re.sub(r"__attribute__\s*\(\(.*?\)\)|\[\[.*?\]\]", "", statement).strip()
    head = re.sub(r"^template\s*<.*?>\s*(?=[\w:~])", "", head, flags=re.S)
    if NO_FUNCTION.match(head):
        return False
    found = FUNCTION.search(head)
    equals = re.search(r"(?<!operator)=", head)
    return bool(found) and (equals is None or found.start() < equals.start() or "operator" in found[0])


def classes(text):
    """(name, private member functions) of each class and struct of a source without comments."""
    counts = {}

    def walk(begin, end, name, access):
        start = at = begin
        while at < end:
            found = ACCESS.match(text, at) if start == at else None
            if found and name:
                access = found[1]
                start = at = found.end()
                continue
            letter = text[at]
            if letter == ";":
                count(text[start:at], name, access)
                start = at = at + 1
            elif letter == "{":
                head = text[start:at].strip()
                close = end_of_block(text, at)
                inner = CLASS.match(head)
                if inner:
                    full = f"{name}::{inner[1]}" if name else inner[1]
                    counts.setdefault(full, 0)
                    walk(at + 1, close, full, "private" if re.search(r"\bclass\b", head) else "public")
                    start = close + 1
                elif re.match(r"^(inline\s+)?namespace\b|^extern\b", head):
                    walk(at + 1, close, name, access)
                    start = close + 1
                elif is_function(head):
                    count(head, name, access)
                    start = close + 1
                at = close + 1  # an initialiser goes on to its semicolon
            else:
                at += 1

    def count(statement, name, access):
        if name and access == "private" and is_function(statement.strip()):
            counts[name] += 1

    walk(0, len(text), "", "public")
    return counts


def sizes(folder):
    """(private member functions, class, file), most first."""
    found = []
    for path in sorted(p for p in pathlib.Path(folder).rglob("*") if p.suffix in (".hpp", ".cpp", ".h")):
        found += [(count, name, path) for name, count in classes(plain(path.read_text())).items()]
    return sorted(found, key=lambda row: (-row[0], row[1], str(row[2])))


def main(arguments):
    usable = len(arguments) == 2 and arguments[0].isdigit() and pathlib.Path(arguments[1]).is_dir()
    found = sizes(arguments[1]) if usable else []
    if not found:
        print(f"no class in {arguments[1]}" if usable else __doc__, file=sys.stderr)
        return 2
    limit = int(arguments[0])
    faults = [f"{path}: {name} has {count} private member functions, at most {limit}: make it of parts"
              for count, name, path in found if count > limit]
    if found[0][0] < limit:
        faults.append(f"no class has more than {found[0][0]}: lower the limit of {limit}")
    for count, name, path in found[:10]:
        print(f"{count:3} {name} ({path})")
    print("\n".join([*faults, f"{len(found)} classes, {len(faults)} faults"]))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
