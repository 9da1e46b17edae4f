#!/usr/bin/env python3
"""No two libraries need each other, directly or by way of others: a user's program links them in one pass.

A library needs another that defines a symbol which it uses and does not define itself.

usage: check_library_cycles.py NM LIBRARY...
"""
import pathlib
import subprocess
import sys


def symbols(text):
    """Defined and undefined names in what `nm` prints. Weak ones, such as inline functions, are in
    every library that uses them and bind none to another."""
    defined, used = set(), set()
    for line in text.splitlines():
        words = line.split()
        if len(words) >= 2 and words[-2] == "U":
            used.add(words[-1])
        elif len(words) == 3 and words[1] in "TDBR":
            defined.add(words[2])
    return defined, used - defined


def needs(libraries):
    """`libraries`: name -> (defined, used). Name -> names of the libraries that it needs."""
    return {name: sorted(other for other, (defined, _) in libraries.items() if other != name and used & defined)
            for name, (_, used) in libraries.items()}


def find_cycle(needed):
    """A list of names, the last of which is the first, or None."""
    done = set()

    def follow(path):
        for name in needed[path[-1]]:
            if name in path:
                return [*path[path.index(name):], name]
            if name not in done:
                cycle = follow([*path, name])
                if cycle:
                    return cycle
        done.add(path[-1])
        return None

    return next((cycle for cycle in (follow([name]) for name in needed) if cycle), None)


def main():
    nm, *paths = sys.argv[1:]
    libraries = {
        pathlib.Path(path).name: symbols(subprocess.run([nm, path], check=True, capture_output=True, text=True).stdout)
        for path in paths
    }
    needed = needs(libraries)
    for name, others in needed.items():
        print(f"{name}: {', '.join(others) or 'none'}")
    cycle = find_cycle(needed)
    if cycle:
        print("cycle: " + " -> ".join(cycle))
    return 1 if cycle or len(libraries) < 2 or not any(needed.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
