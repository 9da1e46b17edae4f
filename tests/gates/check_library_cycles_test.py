#!/usr/bin/env python3
"""check_library_cycles.py finds libraries that need each other, and no others."""
import unittest

import check_library_cycles as check

NM = """
a.o:
0000000000000000 T own
0000000000000010 W inline
                 U own
                 U other
0000000000000000 t local
"""


class LibraryCycles(unittest.TestCase):
    def test_reads_nm(self):
        self.assertEqual(check.symbols(NM), ({"own"}, {"other"}))

    def test_finds_who_needs_whom(self):
        libraries = {"a": ({"f"}, {"g"}), "b": ({"g"}, {"printf"})}
        self.assertEqual(check.needs(libraries), {"a": ["b"], "b": []})

    def test_finds_a_cycle(self):
        self.assertEqual(check.find_cycle({"a": ["b"], "b": ["c"], "c": ["b"]}), ["b", "c", "b"])

    def test_passes_a_diamond(self):
        self.assertIsNone(check.find_cycle({"a": ["b", "c"], "b": ["d"], "c": ["d"], "d": []}))


if __name__ == "__main__":
    unittest.main()
