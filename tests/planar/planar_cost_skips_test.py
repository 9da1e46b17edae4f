#!/usr/bin/env python3
"""planar_cost_test.py is skipped with the reason where valgrind cannot run, and fails where the program does.

planar_cost_skips_test.py PLANAR_COST
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

TEST = pathlib.Path(__file__).resolve().parent / "planar_cost_test.py"


class Skips(unittest.TestCase):
    program = ""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def stub(self, name, line):
        path = self.folder / name
        path.write_text(f"#!/bin/sh\n{line}\n")
        path.chmod(0o755)
        return path

    def run_test(self, program):
        return subprocess.run([sys.executable, TEST, program], capture_output=True, text=True,
                              env={**os.environ, "PATH": str(self.folder)})

    def skipped_with(self, reason):
        run = self.run_test(self.program)
        self.assertEqual(run.returncode, 77, run.stdout + run.stderr)
        self.assertIn(reason, run.stdout)

    def test_no_valgrind(self):
        self.skipped_with("skipped: valgrind is not installed")

    def test_valgrind_ends_as_a_shell_says_it(self):
        self.stub("valgrind", "exit 132")
        self.skipped_with("it ends with code 132 (SIGILL)")

    def test_valgrind_dies(self):
        self.stub("valgrind", "kill -ILL $$")
        self.skipped_with("it ends with code -4 (SIGILL)")

    def test_valgrind_refuses(self):
        self.stub("valgrind", "echo 'valgrind: cannot start' >&2; exit 1")
        self.skipped_with("it ends with code 1: valgrind: cannot start")

    def test_the_program_itself_fails(self):
        self.stub("valgrind", "exit 132")
        self.assertEqual(self.run_test(self.stub("program", "exit 3")).returncode, 1)


if __name__ == "__main__":
    Skips.program = sys.argv.pop(1)
    unittest.main()
