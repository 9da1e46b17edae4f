#!/usr/bin/env python3
"""Shows that check_links.py finds each kind of fault, and none where there is none."""
import pathlib
import tempfile
import unittest

import check_links


class CheckLinksTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve()
        self.write("README.md", "# Top\n[page](docs/page.md)\n")
        self.write("docs/page.md", "# A page\n\n## Two words\n\n## `run SOURCE`\n\n## Two words\n")

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def faults(self, links):
        self.write("README.md", f"# Top\n[page](docs/page.md)\n{links}\n")
        return check_links.check_pages(self.root)

    def test_good_links_pass(self):
        self.assertEqual(self.faults(
            "[a](docs/page.md#two-words) [b](docs/page.md#two-words-1) [c](docs/page.md#run-source) [d](#top)\n"
            "[e](https://example.org/x.md) [f](docs) ![g](docs/page.md)\n[h]: docs/page.md#a-page"), [])

    def test_missing_file(self):
        self.assertEqual(self.faults("[a](docs/none.md)"), ["README.md:3: docs/none.md: no such file"])

    def test_missing_picture(self):
        self.assertEqual(self.faults("![a](docs/none.png)"), ["README.md:3: docs/none.png: no such file"])

    def test_missing_anchor(self):
        self.assertEqual(self.faults("[a](docs/page.md#two)"),
                         ["README.md:3: docs/page.md#two: no heading has this anchor"])

    def test_missing_target_of_a_definition(self):
        self.assertEqual(self.faults("[a]: docs/none.md"), ["README.md:3: docs/none.md: no such file"])

    def test_link_out_of_the_project(self):
        self.assertEqual(self.faults("[a](../x.md)"), ["README.md:3: ../x.md: leads out of the project"])

    def test_absolute_link(self):
        self.assertEqual(self.faults("[a](/docs/page.md)"), ["README.md:3: /docs/page.md: not relative"])

    def test_code_holds_no_links(self):
        self.assertEqual(self.faults("`f[0](none.md)`\n```\n[a](none.md)\n```\n\n    [b](none.md)"), [])

    def test_link_in_a_list_is_seen(self):
        self.assertEqual(self.faults("- one\n    [a](none.md)"), ["README.md:4: none.md: no such file"])

    def test_page_that_nothing_links_to(self):
        self.write("docs/lonely.md", "# Lonely\n")
        self.assertEqual(self.faults(""), ["docs/lonely.md:1: no chain of links from README.md leads to this page"])

    def test_page_that_a_source_names(self):
        self.write("core/a.hpp", "/// docs/page.md\n/// docs/none.md has more\n")
        self.assertEqual(check_links.check_mentions(self.root, ["core"]),
                         ["core/a.hpp:2: docs/none.md: no such page"])


if __name__ == "__main__":
    unittest.main()
