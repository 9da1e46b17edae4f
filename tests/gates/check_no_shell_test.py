#!/usr/bin/env python3
"""check_no_shell.py refuses every way to a shell, and nothing else."""
import unittest

import check_no_shell

OFFENCES = [
    "const int status = std::system(command.c_str());",
    "if (system (text) != 0) return;",
    'std::FILE* pipe = popen(command.c_str(), "w");',
    'execl("/bin/sh", "sh", "-c", text, nullptr);',
    'run_child({"/bin/bash", "-c", text});',
    'run_child({"sh", "-c", text});',
    "os.system(command)",
    "os.popen(command)",
    "subprocess.run(command, shell=True)",
    "subprocess.getoutput(command)",
]
HARMLESS = [
    "throw std::system_error(errno, std::generic_category());",
    "std::chrono::system_clock::now();",
    "#include <system_error>",
    'run_child({"valgrind", "--quiet", program});',
    "posix_spawnp(&child, program, nullptr, nullptr, arguments, environ);",
    "subprocess.run([program, folder], check=True)",
    'options.overlay == "shaded"',
]


class NoShell(unittest.TestCase):
    def test_offences_are_refused(self):
        for line in OFFENCES:
            with self.subTest(line):
                self.assertEqual([number for number, _ in check_no_shell.faults(f"first\n{line}\nlast")], [2])

    def test_the_rest_passes(self):
        for line in HARMLESS:
            with self.subTest(line):
                self.assertEqual(list(check_no_shell.faults(line)), [])


if __name__ == "__main__":
    unittest.main()
