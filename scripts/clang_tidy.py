#!/usr/bin/env python3
"""Runs clang-tidy over the sources of a compilation database, several in one translation unit.

usage: clang_tidy.py BUILD [-j N] [--again] [--checks CHECKS] [PATH...]
PATH: only sources below it. Most of a source's time is that of its headers: sources of one folder with the same flags
and no file-scope name in common share a unit; one that does not compile is halved. A unit that passed is not checked
again until a file that it includes, its flags or a .clang-tidy changes; --again checks all. Fails where clang-tidy does.
"""
import argparse
import collections
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import time

LARGEST_UNIT = 10
FOLDERS = ("core", "examples", "host_sim", "port", "tests", "web")
NAME = [re.compile(pattern) for pattern in (
    r"(?:typedef|using)\s+(\w+)\s*=",
    r"(?:template\s*<.*>\s*)?(?:class|struct|union|enum(?:\s+class)?)\s+(\w+)",
    r"#\s*define\s+(\w+)",
    r"(?:\w*TEST\w*|RC_GTEST\w*|TYPED_TEST\w*)\(([^)]*)",
    r"[^(={]*?(?<!::)\b(\w+)\s*(?:\[[^\]]*\]\s*)*[({=;]",
)]
ERROR = re.compile(r"\[clang-diagnostic-error\]")


def names(text):
    """What a source defines at file scope, the namespaces' content being unindented."""
    found = set()
    for line in text.splitlines():
        if not line or line[0] in " \t}/)" or line.startswith(("#include", "namespace", "using namespace")):
            continue
        if re.match(r"using\s+[\w:]+;", line):
            continue
        for pattern in NAME:
            match = pattern.match(line)
            if match:
                found.add(re.sub(r"\s", "", match[1]))
                break
    return found - {"extern", "TYPED_TEST_SUITE"}


def flags(entry):
    """The arguments of a compiler's call but for source and output."""
    arguments = entry.get("arguments") or shlex.split(entry["command"])
    words = iter(arguments[1:])
    kept = []
    for word in words:
        if word in ("-o", "-MF", "-MT", "-MQ"):
            next(words)
        elif word not in ("-c", "-MD", "-MMD", entry["file"]):
            kept.append(word)
    return kept


class Source:
    def __init__(self, entry, root):
        self.path = pathlib.Path(entry["file"])
        self.flags = flags(entry)
        self.folder = self.path.relative_to(root).parts[0]
        self.names = names(self.path.read_text())
        places = [word[2:] for word in self.flags if word.startswith("-I") and len(word) > 2]
        self.places = [pathlib.Path(entry["directory"], place) for place in places]


class Checker:
    def __init__(self, root, build, checks, again):
        self.root, self.again = root, again
        self.units = build / "units"
        self.passed = build / "passed"
        self.checks = [f"--checks={checks}"] if checks else []
        self.included = {}
        configurations = [root / ".clang-tidy", *(root / folder / ".clang-tidy" for folder in FOLDERS)]
        version = subprocess.run(["clang-tidy", "--version"], capture_output=True, text=True, check=True).stdout
        self.common = version + "".join(p.read_text() for p in configurations if p.exists()) + "".join(self.checks)
        for folder in FOLDERS:  # clang-tidy looks for its configuration above a unit
            (self.units / folder).mkdir(parents=True, exist_ok=True)
            configuration = root / folder / ".clang-tidy"
            copy = self.units / folder / ".clang-tidy"
            if configuration.exists():
                copy.write_text(configuration.read_text())
            else:
                copy.unlink(missing_ok=True)
        self.passed.mkdir(exist_ok=True)

    def includes(self, path, places):
        """Files of the tree that one includes, and their content's hash."""
        if path not in self.included:
            text = path.read_bytes()
            wanted = re.findall(rb'^\s*#\s*include\s+"([^"]+)"', text, re.M)
            self.included[path] = (hashlib.sha256(text).hexdigest(), [name.decode() for name in wanted])
        found = []
        for name in self.included[path][1]:
            for place in [path.parent, *places]:
                if (place / name).is_file():
                    found.append((place / name).resolve())
                    break
        return found

    def state(self, sources):
        """Hash of all that decides whether the sources pass."""
        seen, waiting = set(), [source.path for source in sources]
        while waiting:
            path = waiting.pop()
            if path not in seen:
                seen.add(path)
                waiting += self.includes(path, sources[0].places)
        text = "\n".join([self.common, " ".join(sources[0].flags), *(str(source.path) for source in sources),
                          *(self.included[path][0] for path in sorted(seen))])
        return hashlib.sha256(text.encode()).hexdigest()

    def check(self, sources):
        """(clang-tidy's text, whether it is content, whether it was asked) for sources in one unit."""
        stamp = self.passed / self.state(sources)
        if stamp.exists() and not self.again:
            return "", True, False
        unit = sources[0].path
        if len(sources) > 1:
            unit = self.units / sources[0].folder / f"{stamp.name[:16]}{sources[0].path.suffix}"
            unit.write_text("".join(f'#include "{source.path}"  // NOLINT\n' for source in sources))
        # What shadows a name of another source of the unit shadows nothing.
        extra = [f"-iquote{sources[0].path.parent}", *(["-Wno-shadow"] if len(sources) > 1 else [])]
        run = subprocess.run(["clang-tidy", "--quiet", *self.checks, str(unit), "--", *sources[0].flags, *extra],
                             capture_output=True, text=True)
        if len(sources) > 1 and ERROR.search(run.stdout):
            half = len(sources) // 2
            parts = [self.check(sources[:half]), self.check(sources[half:])]
            return "".join(text for text, _, _ in parts), all(good for _, good, _ in parts), True
        if run.returncode == 0:
            stamp.touch()
        return run.stdout, run.returncode == 0, True


def units(sources):
    """Sources that share a unit: same flags and folder, no name in common."""
    groups = collections.defaultdict(list)
    for source in sources:
        groups[source.path.parent, source.path.suffix, *source.flags].append(source)
    for group in groups.values():
        open_units = []
        for source in group:
            for unit, taken in open_units:
                if len(unit) < LARGEST_UNIT and not taken & source.names:
                    unit.append(source)
                    taken |= source.names
                    break
            else:
                open_units.append(([source], set(source.names)))
        yield from (unit for unit, _ in open_units)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("-j", type=int, default=os.cpu_count())
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--checks")
    parser.add_argument("paths", nargs="*", type=pathlib.Path)
    arguments = parser.parse_intermixed_args()
    root = pathlib.Path(__file__).resolve().parents[1]
    build = arguments.build.resolve()
    wanted = [path.resolve() for path in arguments.paths] or [root / folder for folder in FOLDERS]
    entries = {entry["file"]: entry for entry in json.loads((build / "compile_commands.json").read_text())}
    sources = [Source(entry, root) for file, entry in sorted(entries.items())
               if any(pathlib.Path(file).is_relative_to(path) for path in wanted)]
    if not sources:
        print("clang_tidy.py: no source to check", file=sys.stderr)
        return 2
    checker = Checker(root, build, arguments.checks, arguments.again)
    work = list(units(sources))
    start, asked, refused = time.monotonic(), 0, 0
    with concurrent.futures.ThreadPoolExecutor(arguments.j) as pool:
        for text, good, ran in pool.map(checker.check, work):
            asked += ran
            refused += not good
            if not good:
                print(text, flush=True)
    print(f"clang-tidy: {len(sources)} sources in {len(work)} units, {asked} checked in "
          f"{time.monotonic() - start:.0f} s, {refused} refused")
    return 1 if refused else 0


if __name__ == "__main__":
    sys.exit(main())
