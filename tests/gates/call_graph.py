#!/usr/bin/env python3
"""Worst stack and forbidden shapes from GCC's call graphs (-fcallgraph-info=su, *.ci).

Without --entry every function is checked: no recursion, no frame of run-time size, none above
--largest-frame. With --entry also the deepest path from that function; calls through pointers and
calls out of the graph count what --indirect and --extern say and fail where nothing is said.

usage: call_graph.py [--entry NAME] [--indirect BYTES] [--extern NAME=BYTES]... [--limit BYTES]
                     [--largest-frame BYTES] [--reference TEXT] FILE_OR_FOLDER...

--reference: functions with TEXT in their readable name (such as "T = double") are references for the
host and may have any frame of fixed size.
"""
import argparse
import pathlib
import re
import sys

NODE = re.compile(r'node: \{ title: "([^"]*)" label: "([^"]*)"')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)"')
FRAME = re.compile(r"(\d+) bytes \(([a-z,]+)\)")
INDIRECT = "__indirect_call"


def title_of(text):
    """One name for a function wherever it is named: GCC puts the file before weak functions (such as
    explicit instantiations) in the file that defines them, and names complete constructors (C1),
    whose body is that of the base constructor (C2)."""
    name = text.rsplit(":", 1)[-1]
    if not name.startswith("_Z") or "_GLOBAL__N_1" in name or name.startswith("_ZL"):
        return text
    return re.sub(r"([CD])1E", r"\g<1>2E", name)


class Graph:
    def __init__(self):
        self.frames = {}   # function -> bytes
        self.names = {}    # function -> readable name
        self.calls = {}    # function -> set of functions
        self.dynamic = set()

    def read(self, file):
        text = file.read_text()
        for title, label in NODE.findall(text):
            title = title_of(title)
            frame = FRAME.search(label)
            if frame:
                self.frames[title] = max(self.frames.get(title, 0), int(frame[1]))
                self.names[title] = label.split("\\n")[0]
                if frame[2] == "dynamic":
                    self.dynamic.add(title)
        for source, target in EDGE.findall(text):
            self.calls.setdefault(title_of(source), set()).add(title_of(target))

    def name(self, function):
        return self.names.get(function, function)[:120]

    def cycles(self):
        """Strongly connected components of more than one function, or one that calls itself."""
        index, low, on_stack, stack, found = {}, {}, set(), [], []
        for root in self.frames:
            if root in index:
                continue
            work = [(root, iter(sorted(self.calls.get(root, ()))))]
            index[root] = low[root] = len(index)
            stack.append(root)
            on_stack.add(root)
            while work:
                function, callees = work[-1]
                for callee in callees:
                    if callee not in self.frames:
                        continue
                    if callee not in index:
                        index[callee] = low[callee] = len(index)
                        stack.append(callee)
                        on_stack.add(callee)
                        work.append((callee, iter(sorted(self.calls.get(callee, ())))))
                        break
                    if callee in on_stack:
                        low[function] = min(low[function], index[callee])
                else:
                    work.pop()
                    if work:
                        low[work[-1][0]] = min(low[work[-1][0]], low[function])
                    if low[function] == index[function]:
                        component = []
                        while True:
                            member = stack.pop()
                            on_stack.discard(member)
                            component.append(member)
                            if member == function:
                                break
                        if len(component) > 1 or function in self.calls.get(function, ()):
                            found.append(component)
        return found

    def deepest(self, entry, external, indirect):
        """(bytes, path, faults) of the deepest path from `entry`; the graph has no cycles."""
        memo, faults = {}, set()

        def own(function, caller):
            if function in self.frames:
                return None
            if function == INDIRECT:
                if indirect is None:
                    faults.add(f"call through a pointer in {self.name(caller)}")
                return indirect or 0
            for pattern, size in external:
                if pattern.fullmatch(function):
                    return size
            faults.add(f"nothing known about {function}, called by {self.name(caller)}")
            return 0

        order, seen, work = [], set(), [(entry, False)]
        while work:
            function, done = work.pop()
            if done:
                order.append(function)
            elif function not in seen and function in self.frames:
                seen.add(function)
                work.append((function, True))
                work.extend((callee, False) for callee in sorted(self.calls.get(function, ())))
        for function in order:
            best, path = 0, []
            for callee in sorted(self.calls.get(function, ())):
                leaf = own(callee, function)
                size, below = (leaf, [(callee, leaf)]) if leaf is not None else memo[callee]
                if size > best:
                    best, path = size, below
            memo[function] = (self.frames[function] + best,
                              [(function, self.frames[function])] + path)
        return memo[entry] + (sorted(faults),)


def graph_of(paths):
    graph = Graph()
    for path in map(pathlib.Path, paths):
        # A compiler cache hands back the object without its call graph.
        for built in path.rglob("*.obj") if path.is_dir() else []:
            if not built.with_suffix(".ci").exists() and not built.with_suffix("").with_suffix(".ci").exists():
                sys.exit(f"{built}: no call graph beside it; build without a compiler cache")
        for file in sorted(path.rglob("*.ci")) if path.is_dir() else [path]:
            graph.read(file)
    return graph


# Of newlib and libgcc, written by hand in assembler: read from their disassembly, rounded up.
EXTERNAL = [
    (re.compile(r"mem(cpy|move|set|cmp)|__aeabi_mem\w+|(floor|sqrt|fabs)f?|strlen"), 40),
    (re.compile(r"__aeabi_\w+|__popcountsi2|__popcountdi2"), 64),
]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--entry")
    parser.add_argument("--indirect", type=int)
    parser.add_argument("--extern", action="append", default=[])
    parser.add_argument("--limit", type=int)
    parser.add_argument("--largest-frame", type=int)
    parser.add_argument("--reference")
    parser.add_argument("paths", nargs="+")
    args = parser.parse_args()

    graph = graph_of(args.paths)
    if not graph.frames:
        print("no call graph found: built without -fcallgraph-info=su?")
        return 1
    faults = [f"recursion: {' -> '.join(graph.name(f) for f in c)}" for c in graph.cycles()]
    faults += [f"frame of run-time size: {graph.name(f)}" for f in sorted(graph.dynamic)]
    if args.largest_frame is not None:
        faults += [f"frame of {size} bytes, allowed {args.largest_frame}: {graph.name(f)}"
                   for f, size in sorted(graph.frames.items()) if size > args.largest_frame
                   and not (args.reference and args.reference in graph.names.get(f, ""))]
    if args.entry and not any("recursion" in f for f in faults):
        external = [(re.compile(re.escape(n)), int(b)) for n, b in (e.split("=") for e in args.extern)]
        total, path, unknown = graph.deepest(args.entry, external + EXTERNAL, args.indirect)
        faults += unknown
        print(f"worst stack from {args.entry}: {total} bytes")
        for function, size in path:
            print(f"  {size:6d}  {graph.name(function)}")
        if args.limit is not None and total > args.limit:
            faults.append(f"stack of {total} bytes, allowed {args.limit}")
    for fault in faults:
        print(fault)
    print(f"{len(graph.frames)} functions, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
