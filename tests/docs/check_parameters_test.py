#!/usr/bin/env python3
"""Shows that check_parameters.py reads members of every kind, and finds each kind of fault."""
import pathlib
import tempfile
import unittest

import check_parameters

HEADER = """
template <class T>
struct Options {
  static constexpr int kMost = 3;
  enum class Kind { kOne, kTwo };
  Options() { inner.a = 2; }  // sets
  Status validate() const { return a > 0 ? kOk : kBad; }
  bool holds(int x) const;
  T a = T(0.5);      ///< first
  int b = 7;
  Inner<T> inner;
  typename Outer::Inner other;
  Bits bits = {0.99F, 16};
  const std::uint8_t* flags = nullptr;
  Matrix<T, 6, 6> m = Matrix<T, 6, 6>::Zero();
};
"""
ROWS = {"a": "`0.5`", "b": "`7` (tracker: 8)", "inner": "", "other": "", "bits": "`{0.99, 16}`", "flags": "`nullptr`",
        "m": "`Zero()`"}


class CheckParametersTest(unittest.TestCase):
    def faults(self, header=HEADER, **changed):
        rows = {**ROWS, **changed}
        page = "# P\n\n### `Some::Options`\n`core/options.hpp`, struct.\n\n| parameter | meaning | unit | default |\n"
        page += "".join(f"| `{name}` | x | m | {cell} |\n" for name, cell in rows.items() if cell is not None)
        with tempfile.TemporaryDirectory() as name:
            root = pathlib.Path(name)
            (root / "docs/reference").mkdir(parents=True)
            (root / "core").mkdir()
            (root / "core/options.hpp").write_text(header)
            (root / check_parameters.PAGE).write_text(page)
            return [fault.split(": ", 2)[2] for fault in check_parameters.check(root)]

    def test_equal_passes(self):
        self.assertEqual(self.faults(), [])

    def test_member_without_a_row(self):
        self.assertEqual(self.faults(b=None), ["no row for b"])

    def test_row_without_a_member(self):
        self.assertEqual(self.faults(c="`1`"), ["c is not in core/options.hpp"])

    def test_other_default(self):
        self.assertEqual(self.faults(a="`0.6`"), ["a: the page says 0.6, the header 0.5"])

    def test_missing_default(self):
        self.assertEqual(self.faults(flags=""), ["flags: the page says no default, the header nullptr"])

    def test_missing_struct(self):
        self.assertEqual(self.faults(header="struct Other {};"), ["core/options.hpp has no such struct"])


if __name__ == "__main__":
    unittest.main()
