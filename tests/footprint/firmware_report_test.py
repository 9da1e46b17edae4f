#!/usr/bin/env python3
"""What a run of firmware_report.py keeps of an earlier run's result, and what the pages say of it."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import firmware_report  # noqa: E402
import footprint_page  # noqa: E402
import page_tables  # noqa: E402
import timing_page  # noqa: E402


def row(worst):
    return {"worst": worst, "p99": worst, "median": worst, "worst_over_median": 1.0, "hybrid_bound": worst}


def timing(worst):
    return {"hall": {"set": "typical", "instructions": {"frame": row(worst)}}}


def coverage():
    return {"instructions": 10, "uncovered_instructions": 1, "uncovered_blocks": 1, "functions": []}


def result(revision, **more):
    return {"selftest": True, "revision": revision, "vehicle": {"frames": 60, **more}}


class KeepEarlier(unittest.TestCase):
    def test_timing_stays_with_its_commit(self):
        now = result("new")
        firmware_report.keep_earlier(now, result("old", timing=timing(5), coverage=coverage()), False)
        self.assertEqual(now["vehicle"], {"frames": 60, "timing": timing(5), "coverage": coverage()})
        self.assertEqual((now["revision"], now["timing_revision"]), ("new", "old"))

    def test_timing_kept_twice_has_the_first_commit(self):
        second = result("second")
        firmware_report.keep_earlier(second, result("first", timing=timing(5)), False)
        third = result("third")
        firmware_report.keep_earlier(third, second, False)
        self.assertEqual(third["timing_revision"], "first")

    def test_new_timing_replaces_the_earlier(self):
        now = result("new", timing=timing(7))
        firmware_report.keep_earlier(now, result("old", timing=timing(5), coverage=coverage()), True)
        self.assertEqual(now, result("new", timing=timing(7)))

    def test_an_image_that_is_gone_takes_its_timing_with_it(self):
        now = {"selftest": True, "revision": "new"}
        firmware_report.keep_earlier(now, result("old", timing=timing(5)), False)
        self.assertEqual(now, {"selftest": True, "revision": "new"})

    def test_unit_tests_stay_unless_run_again(self):
        earlier = {**result("old"), "unit_tests": {"passed": 4, "run": 4}}
        now = result("new")
        firmware_report.keep_earlier(now, earlier, False)
        self.assertEqual(footprint_page.unit_text(now), "4 of 4 at old")
        again = {**result("new"), "unit_tests": {"passed": 5, "run": 6}}
        firmware_report.keep_earlier(again, earlier, False)
        self.assertEqual(footprint_page.unit_text(again), "5 of 6")

    def test_nothing_earlier(self):
        now = result("new")
        firmware_report.keep_earlier(now, {}, False)
        self.assertEqual(now, result("new"))


class KeepRows(unittest.TestCase):
    EARLIER = ("# Page\n\n| target | flash |\n| --- | ---: |\n| cortex-m7 | 1 |\n| cortex-m55 | 2 |\n"
               "| cortex-m55 | 3 |\n| host-gcc-O0 | 4 |\n\n| target | other |\n| --- | --- |\n| cortex-m55 | 9 |\n")

    def test_rows_of_targets_not_measured_stay_in_their_order(self):
        text = "# New\n\n| target | flash |\n| --- | ---: |\n| cortex-m7 | 5 |\n| riscv64-linux | 6 |\n\nEnd.\n"
        kept = page_tables.keep_rows(self.EARLIER, text, ["cortex-m7", "riscv64-linux"])
        self.assertEqual(kept, "# New\n\n| target | flash |\n| --- | ---: |\n| cortex-m7 | 5 |\n| cortex-m55 | 2 |\n"
                               "| cortex-m55 | 3 |\n| riscv64-linux | 6 |\n| host-gcc-O0 | 4 |\n\nEnd.\n")

    def test_rows_of_one_target_are_replaced_in_one_table(self):
        text = page_tables.with_rows(self.EARLIER, "| target | flash |", "cortex-m55",
                                     ["| cortex-m55 | 7 |", "| cortex-m55 | 8 |"])
        self.assertEqual(text, self.EARLIER.replace("| cortex-m55 | 2 |\n| cortex-m55 | 3 |",
                                                    "| cortex-m55 | 7 |\n| cortex-m55 | 8 |"))

    def test_rows_of_a_target_that_is_new(self):
        text = page_tables.with_rows(self.EARLIER, "| target | flash |", "cortex-m4f", ["| cortex-m4f | 7 |"])
        self.assertEqual(text, self.EARLIER.replace("| cortex-m7 | 1 |", "| cortex-m7 | 1 |\n| cortex-m4f | 7 |"))

    def test_a_table_at_the_end_of_the_page(self):
        text = "| target | flash |\n| --- | ---: |\n| cortex-m7 | 5 |\n"
        kept = page_tables.keep_rows(self.EARLIER, text, ["cortex-m7", "cortex-m55"])
        self.assertEqual(kept, text + "| host-gcc-O0 | 4 |\n")

    def test_rows_under_another_heading_go(self):
        text = "| target | flash | RAM |\n| --- | ---: | ---: |\n| cortex-m7 | 5 | 6 |\n"
        self.assertEqual(page_tables.keep_rows(self.EARLIER, text, ["cortex-m7"]), text)

    def test_no_earlier_page(self):
        text = "| target | flash |\n| --- | ---: |\n| cortex-m7 | 5 |\n\n| image | targets |\n| --- | --- |\n| a | b |\n"
        self.assertEqual(page_tables.keep_rows("", text, ["cortex-m7"]), text)


class Pages(unittest.TestCase):
    """The written pages, in a folder of their own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for path in ("docs/reference", "tests/footprint", "tests/target"):
            (self.root / path).mkdir(parents=True)
        (self.root / "tests/footprint/budget.json").write_text("{}")
        (self.root / "tests/target/inputs.json").write_text(
            '{"inputs": [{"name": "hall", "source": "hall"}, {"name": "noise", "source": "stress:noise"}]}')

    def page(self, name):
        return (self.root / "docs/reference" / f"{name}.md").read_text()

    def test_timing_says_its_commit(self):
        now = result("new")
        firmware_report.keep_earlier(now, result("old", timing=timing(5)), False)
        timing_page.write(self.root, {"cortex-m7": now})
        self.assertIn("| cortex-m7 | old | vehicle | 1 | 5 | hall |", self.page("timing"))
        self.assertIn("| cortex-m7 | vehicle | hall | typical | 5 | 5 | 5 | 1.00 | 5 | - | - |", self.page("timing"))

    def test_timing_keeps_boards_that_were_not_timed_and_the_gate(self):
        timing_page.write(self.root, {"cortex-m7": result("a", timing=timing(5), coverage=coverage()),
                                      "cortex-m4f": result("a", timing=timing(6))})
        timing_page.write(self.root, {"cortex-m4f": result("b", timing=timing(7))})
        text = self.page("timing")
        self.assertIn("| cortex-m7 | a | vehicle | 1 | 5 | hall |", text)
        self.assertIn("| cortex-m4f | b | vehicle | 1 | 7 | hall |", text)
        self.assertEqual(text.count("| cortex-m4f | "), 3)
        self.assertEqual(timing_page.read_gate(self.root / "docs/reference/timing.md"),
                         {("cortex-m7", "vehicle", "hall"): 5})

    def test_timing_keeps_the_gates_rows_of_images_that_it_did_not_time(self):
        timing_page.write(self.root, {"cortex-m7": result("a", timing=timing(5))})
        page = self.root / "docs/reference/timing.md"
        timing_page.replace_gate(page, [("cortex-m7", "vehicle", "hall", 5),
                                        ("cortex-m7", "window", "lost-window", 9)])
        timing_page.write(self.root, {"cortex-m7": result("b", timing=timing(6))})
        self.assertEqual(timing_page.read_gate(page), {("cortex-m7", "vehicle", "hall"): 6,
                                                       ("cortex-m7", "window", "lost-window"): 9})

    def test_targets_say_which_inputs_differ(self):
        def replayed(**equal):
            return {"ram_bytes": {}, "frames": 60 * len(equal),
                    "inputs": {name: {"frames": 60, "hash_equal": same} for name, same in equal.items()}}
        about = {"compiler": "GCC", "revision": "a", "selftest": True, "modules": 7, "modules_equal": True}
        footprint_page.targets(self.root, {
            "cortex-m7": {**about, "vehicle": replayed(hall=True, noise=True), "vehicle_large": replayed(hall=True)},
            "cortex-m33": {**about, "vehicle": replayed(hall=True, noise=False)}})
        text = self.page("targets")
        self.assertIn("| 7 equal | - | 120 equal | - | - | - | 60 equal | - |\n", text)
        self.assertIn("| 7 equal | - | **differs**: noise | - | - | - | - | - |\n", text)
        self.assertIn("| hall | 60 | `hall` | vehicle, vehicle_large |\n| noise | 60 | `stress:noise` | vehicle |\n",
                      text)


if __name__ == "__main__":
    unittest.main()
