#!/usr/bin/env python3
"""scripts/clang_tidy.py joins sources whose flags are the same and whose file-scope names differ, and asks again of what
has changed."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import clang_tidy  # noqa: E402

SAMPLE = """#include "a.hpp"
#define LOUD 1
namespace cairn {
namespace {
using Pair = std::pair<int, int>;
using detail::Other;
constexpr int kMost = 3;
struct Hidden {
  int inside = 0;
};
int helper(const Hidden& hidden) {
  return hidden.inside;
}
TEST_F(Suite, Name) {
}
}  // namespace
void Class::member(int a) {
}
}
"""


class Units(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name).resolve()
        (self.root / ".clang-tidy").write_text("Checks: '-*'\n")
        (self.root / "core").mkdir()
        (self.root / "build").mkdir()

    def tearDown(self):
        self.folder.cleanup()

    def source(self, name, text, flags="-I. -DA"):
        path = self.root / "core" / name
        path.write_text(text)
        return clang_tidy.Source({"file": str(path), "directory": str(self.root),
                                  "command": f"c++ {flags} -o x.o -c {path}"}, self.root)

    def test_names_are_those_at_file_scope(self):
        self.assertEqual(clang_tidy.names(SAMPLE),
                         {"LOUD", "Pair", "kMost", "Hidden", "helper", "Suite,Name"})

    def test_flags_are_without_source_and_output(self):
        self.assertEqual(self.source("a.cpp", "").flags, ["-I.", "-DA"])

    def test_sources_share_a_unit_unless_flags_or_names_forbid_it(self):
        sources = [self.source("a.cpp", "int one() {\n}\n"), self.source("b.cpp", "int two() {\n}\n"),
                   self.source("c.cpp", "int one() {\n}\n"), self.source("d.cpp", "int four() {\n}\n", "-DB")]
        found = [[source.path.name for source in unit] for unit in clang_tidy.units(sources)]
        self.assertEqual(found, [["a.cpp", "b.cpp"], ["c.cpp"], ["d.cpp"]])

    def test_a_header_that_changes_asks_again(self):
        (self.root / "core/a.hpp").write_text("int a;\n")
        sources = [self.source("a.cpp", '#include "a.hpp"\n')]

        def state():
            checker = clang_tidy.Checker.__new__(clang_tidy.Checker)
            checker.included, checker.common = {}, ""
            return checker.state(sources)

        before = state()
        self.assertEqual(state(), before)
        (self.root / "core/a.hpp").write_text("int b;\n")
        self.assertNotEqual(state(), before)


if __name__ == "__main__":
    unittest.main()
