#!/usr/bin/env python3
"""Shows that the gates bite: puts one offence after the other into a scratch copy of the core and
expects the build or a gate to refuse it, and lets a harmless source pass.

usage: offences.py ROOT TOOLCHAIN_FILE NM
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

# name -> (what must appear in the refusal, source)
OFFENCES = {
    "vector": ("heap", """
        #include <vector>
        int offence(int n) { std::vector<int> v; for (int i = 0; i < n; ++i) v.push_back(i); return v[0]; }
        """),
    "new": ("heap", "int* offence(int n) { return new int[static_cast<unsigned>(n)]; }"),
    "malloc": ("the core uses no heap", """
        #include <cstdlib>
        void* offence() { return std::malloc(8); }
        """),
    "throw": ("error: exception handling disabled", "int offence(int n) { if (n > 3) throw n; return n; }"),
    "rtti": ("error: .dynamic_cast. not permitted", """
        struct Base { virtual int f() { return 1; } protected: ~Base() = default; };
        struct Derived : Base { int g = 0; };
        int offence(Base* b) { return dynamic_cast<Derived*>(b)->g; }
        """),
    "sinf": ("libm", "#include <cmath>\nfloat offence(float x) { return std::sin(x); }"),
    "powf": ("libm", "#include <cmath>\nfloat offence(float x, float y) { return std::pow(x, y); }"),
    "recursion": ("recursion", """
        int offence(int n) { return n < 2 ? n : offence(n - 1) + 3 * offence(n - 2); }
        """),
    "mutual_recursion": ("recursion", """
        int other(int n);
        __attribute__((noinline)) int offence(int n) { return n < 2 ? n : 2 * other(n - 1) + 1; }
        __attribute__((noinline)) int other(int n) { return n < 2 ? n : 3 * offence(n - 1) + other(n / 2); }
        """),
    "eigen_product": ("Eigen|heap|frame of", """
        #include <Eigen/Core>
        using M = Eigen::Matrix<float, 16, 16>;
        void offence(const M& a, const M& b, M& c) { c = a * b; }
        """),
    "run_time_frame": ("frame of run-time size", """
        int offence(int n) { auto* p = static_cast<volatile char*>(__builtin_alloca(n)); p[0] = 1; return p[0]; }
        """),
    "large_frame": ("frame of", """
        int offence(int n) { volatile char block[5000]; block[n] = 1; return block[n / 2]; }
        """),
    "double_promotion": ("error: .*double-promotion", "bool offence(float x) { return x > 0.1; }"),
    "global_state": ("keeps state", "int calls = 0;\nint offence() { return ++calls; }"),
    "function_static": ("keeps state", "int offence() { static int calls = 0; return ++calls; }"),
    "stdio": ("stdio", "#include <cstdio>\nvoid offence() { std::printf(\"%d\", 3); }"),
    "two_draws": ("several random draws", """
        #include "cairn/numeric/random.hpp"
        int less(int a, int b) { return a - b; }
        int offence(cairn::Random& random) { return less(random.below(3), random.below(4)); }
        """),
    "include_upwards": ("numeric may not use vision", '#include "cairn/vision/image.hpp"'),
    "include_port": ("error: cairn/port/port.h: No such file", '#include "cairn/port/port.h"'),
    "include_iostream": ("not a header that the core may use", "#include <iostream>"),
}
HARMLESS = "#include <cmath>\nfloat offence(float x) { return std::sqrt(std::fabs(x)); }"


class Scratch:
    def __init__(self, root, toolchain, nm, folder):
        self.root, self.nm, self.folder = root, nm, folder
        self.build = folder / "build"
        for part in ("core", "port", "toolchains"):
            shutil.copytree(root / part, folder / part)
        shutil.copy(root / "CMakeLists.txt", folder)
        # One module is enough to carry an offence, and quick to build.
        for lists in (folder / "core" / "src").glob("*/CMakeLists.txt"):
            lists.write_text("")
        self.source = folder / "core" / "src" / "numeric" / "offence.cpp"
        (folder / "core/src/numeric/CMakeLists.txt").write_text(
            "target_sources(cairn_core PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/offence.cpp)\n")
        self.source.write_text(HARMLESS)
        self.run("cmake", "-S", folder, "-B", self.build, "-G", "Ninja", f"--toolchain={toolchain}",
                 "-DCMAKE_BUILD_TYPE=Release", "-DCAIRN_BUILD_TESTS=OFF", "-DCAIRN_BUILD_EXAMPLES=OFF",
                 "-DCAIRN_INSTALL=OFF", must_pass=True)

    def run(self, *command, must_pass=False):
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
        if must_pass and done.returncode:
            sys.exit(f"offences: {command[0]} failed:\n{done.stdout}{done.stderr}")
        return done.returncode == 0, done.stdout + done.stderr

    def refusal(self, source):
        """What build and gates say against `source`; empty when they let it pass."""
        self.source.write_text(source + "\n")
        gates = self.root / "tests" / "gates"
        steps = [
            ("cmake", "--build", self.build, "--target", "cairn_core"),
            (sys.executable, gates / "check_symbols.py", "--nm", self.nm,
             self.build / "core" / "libcairn_core.a"),
            (sys.executable, gates / "call_graph.py", "--largest-frame", "4096", self.build / "core"),
            (sys.executable, gates / "check_includes.py", self.folder),
            (sys.executable, gates / "check_draws.py", self.folder / "core"),
        ]
        said = ""
        for step in steps:
            passed, text = self.run(*step)
            if not passed:
                said += text
            if not passed and step[0] == "cmake":
                break
        return said


def main():
    root, toolchain, nm = map(pathlib.Path, sys.argv[1:4])
    failed = []
    with tempfile.TemporaryDirectory() as folder:
        scratch = Scratch(root, toolchain, nm, pathlib.Path(folder))
        said = scratch.refusal(HARMLESS)
        if said:
            failed.append(f"a harmless source was refused:\n{said}")
        for name, (expected, source) in OFFENCES.items():
            said = scratch.refusal(source)
            lines = [line for line in said.splitlines() if re.search(expected, line)]
            print(f"{name:18s} {lines[0].strip()[:150] if lines else 'PASSED THE GATES'}")
            if not lines:
                failed.append(f"{name}: expected a refusal with '{expected}', got:\n{said}")
    print("\n".join(failed))
    print(f"{len(OFFENCES)} offences, {len(failed)} not refused as expected")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
