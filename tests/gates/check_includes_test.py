#!/usr/bin/env python3
"""check_includes.py refuses an include that leads upwards in host_sim, and nothing else."""
import pathlib
import unittest

import check_includes


class CoreIncludes(unittest.TestCase):
    def test_the_c_interface_is_the_top(self):
        self.assertIsNone(check_includes.core_fault("c_api", '"', "cairn/runtime/replay.hpp"))
        self.assertIsNone(check_includes.core_fault("c_api", '"', "cairn/cairn.h"))
        for module in ("base", "runtime", "ar"):
            self.assertIsNotNone(check_includes.core_fault(module, '"', "cairn/cairn.h"))

    def test_headers_without_a_folder_have_a_module(self):
        for name, module in [("cairn.h", "c_api"), ("version.hpp", "base")]:
            path = pathlib.Path("core/include/cairn") / name
            self.assertEqual(check_includes.core_module(path), module)


class HostIncludes(unittest.TestCase):
    def test_upwards_is_refused(self):
        for path, name in [
            ("running/runner.cpp", "host_sim/commands/command.hpp"),
            ("running/runner.cpp", "host_sim/reports/run_outputs.hpp"),
            ("recorded/recording.cpp", "host_sim/experiments/consistency/experiment.hpp"),
            ("experiments/consistency/experiment.cpp", "host_sim/experiments/turntable/turntable.hpp"),
            ("world/hall.cpp", "tests/host/temporary_folder.hpp"),
            ("elsewhere/file.cpp", "host_sim/io/text_file.hpp"),
            ("base/statistics.cpp", "host_sim/elsewhere/file.hpp"),
        ]:
            with self.subTest(path + " -> " + name):
                self.assertIsNotNone(check_includes.host_fault(path, name))

    def test_downwards_passes(self):
        for path, name in [
            ("running/runner.cpp", "host_sim/trackers/tracker.hpp"),
            ("experiments/consistency/reference/world_ekf.cpp", "host_sim/experiments/consistency/filter.hpp"),
            ("main.cpp", "host_sim/commands/command.hpp"),
            ("io/camera_file.cpp", "cairn/geometry/camera.hpp"),
            ("io/camera_file.cpp", "yaml-cpp/yaml.h"),
        ]:
            with self.subTest(path + " -> " + name):
                self.assertIsNone(check_includes.host_fault(path, name))

    def test_a_cycle_cannot_be_listed(self):
        with self.assertRaises(SystemExit):
            check_includes.downwards({"a": "b", "b": "a"})


if __name__ == "__main__":
    unittest.main()
