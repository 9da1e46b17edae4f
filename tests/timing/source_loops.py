"""The loops of C++ source files: where each body begins, and what its head says."""
import re
from dataclasses import dataclass

NOT_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])\'', re.S)
WORD = re.compile(r"\b(for|while|do)\b")


@dataclass
class Loop:
    file: str  # below core/
    line: int  # of the keyword
    column: int
    body_line: int
    body_column: int
    end_line: int  # behind the body
    head: str  # one line, without the keyword


def blanked(text):
    """Same text with comments and strings as spaces."""
    return NOT_CODE.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)


def place(text, at):
    line = text.count("\n", 0, at) + 1
    return line, at - (text.rfind("\n", 0, at) + 1) + 1


def closing(text, at):
    """Index behind the parenthesis that closes the one at `at`."""
    depth = 0
    for k in range(at, len(text)):
        depth += text[k] == "("
        depth -= text[k] == ")"
        if depth == 0:
            return k + 1
    return len(text)


def next_code(text, at):
    while at < len(text) and text[at].isspace():
        at += 1
    return at


def end_of_body(text, body):
    """Index behind the statement that begins at `body`."""
    if text[body] == "{":
        depth, k = 0, body
        while k < len(text):
            depth += text[k] == "{"
            depth -= text[k] == "}"
            k += 1
            if depth == 0:
                return k
        return k
    nested = WORD.match(text, body)
    if nested and nested[1] != "do":
        return end_of_body(text, next_code(text, closing(text, text.index("(", body))))
    braces = 0
    for k in range(body, len(text)):
        braces += text[k] == "{"
        braces -= text[k] == "}"
        if braces == 0 and text[k] == ";":
            return k + 1
    return len(text)


def loops_of(path, name):
    source = path.read_text()
    text = blanked(source)
    loops, ends_of_do = [], set()
    for found in WORD.finditer(text):
        at = found.start()
        if at in ends_of_do:
            continue
        if found[1] == "do":
            body = next_code(text, found.end())
            if text[body] != "{":
                continue
            tail = next_code(text, end_of_body(text, body))
            ends_of_do.add(tail)
            head = source[tail:closing(text, text.index("(", tail))]
        else:
            opening = next_code(text, found.end())
            if text[opening] != "(":
                continue
            end = closing(text, opening)
            body = next_code(text, end)
            head = source[opening:end]
        line, column = place(text, at)
        body_line, body_column = place(text, body)
        end_line, _ = place(text, end_of_body(text, body))
        loops.append(Loop(name, line, column, body_line, body_column, end_line, " ".join(head.split())))
    return loops


def loops_of_core(root):
    folders = ("core/include/cairn", "core/src")
    paths = sorted(p for folder in folders for p in (root / folder).rglob("*") if p.suffix in (".hpp", ".cpp"))
    return [loop for path in paths for loop in loops_of(path, str(path.relative_to(root / "core")))]
