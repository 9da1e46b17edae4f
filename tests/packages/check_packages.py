#!/usr/bin/env python3
"""The package descriptions against the sources: one name and version, files that exist, and CMake files that
a build system's functions can run. None is checked against a registry.

usage: check_packages.py ROOT VERSION
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

ROOT, VERSION = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
sys.path.insert(0, str(ROOT / "packages"))
import make  # noqa: E402
import write_pdsc  # noqa: E402


def text(name):
    return (ROOT / name).read_text()


def options_of_the_core():
    """Definitions that cairn_numerics gives its users."""
    found = re.search(r"target_compile_definitions\(cairn_numerics INTERFACE\n(.*?)\n  \$<", text("toolchains/cairn_options.cmake"), re.S)
    return set(found[1].split())


def configure(lists):
    """Runs a CMake project; the targets' files that it prints."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "CMakeLists.txt").write_text(lists)
        done = subprocess.run(["cmake", "-S", folder, "-B", folder / "build", "-G", "Ninja"], capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout + done.stderr


class Versions(unittest.TestCase):
    def test_one_version(self):
        self.assertEqual(json.loads(text("library.json"))["version"], VERSION)
        self.assertIn(f"\nversion={VERSION}\n", text("packages/library.properties"))
        self.assertIn(f'version: "{VERSION}"\n', text("idf_component.yml"))
        pack = xml.etree.ElementTree.fromstring(text("packages/Cairn.Cairn.pdsc"))
        self.assertEqual(pack.find("releases/release").get("version"), VERSION)
        self.assertEqual({c.get("Cversion") for c in pack.iter("component")}, {VERSION})
        self.assertIn(f"\nversion: {VERSION}\n", text("CITATION.cff"))
        self.assertIn(f"\n## {VERSION}\n", text("CHANGELOG.md"))


class PlatformIo(unittest.TestCase):
    package = json.loads(text("library.json"))

    def test_keys_that_the_registry_needs(self):
        for key in ("name", "version", "description", "keywords", "license"):
            self.assertTrue(self.package[key], key)

    def test_files_exist(self):
        build = self.package["build"]
        for name in [build["includeDir"], build["srcDir"], *self.package["export"]["include"]]:
            self.assertTrue((ROOT / name).exists(), name)
        for header in self.package["headers"]:
            self.assertTrue((ROOT / build["includeDir"] / header).is_file(), header)

    def test_options_of_the_core(self):
        flags = set(self.package["build"]["flags"])
        self.assertLessEqual({f"-D{name}" for name in options_of_the_core()}, flags)
        self.assertLessEqual({"-ffp-contract=off", "-fno-fast-math", "-fno-math-errno"}, flags)


class Arduino(unittest.TestCase):
    def test_the_library(self):
        keys = dict(line.split("=", 1) for line in text("packages/library.properties").splitlines())
        for key in ("name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url",
                    "architectures"):
            self.assertTrue(keys.get(key), key)
        with tempfile.TemporaryDirectory() as name:
            out = pathlib.Path(name) / "Cairn"
            make.arduino(ROOT, out)
            self.assertTrue((out / "library.properties").is_file())
            self.assertTrue((out / "src" / keys["includes"]).is_file())
            sources = {p.relative_to(out / "src/core") for p in (out / "src/core").rglob("*.cpp")}
            self.assertEqual(sources, {p.relative_to(ROOT / "core/src") for p in (ROOT / "core/src").rglob("*.cpp")})
            # As the IDE compiles it: src/ alone is searched, no options of the library's own.
            compiler, eigen = os.environ["CXX"], os.environ["EIGEN"]
            for source in ("c_api/objects.cpp", "geometry/camera.cpp"):
                done = subprocess.run([compiler, "-std=gnu++17", "-fsyntax-only", "-I", out / "src", "-isystem", eigen,
                                       out / "src/core" / source], capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLessEqual({name.split("=")[0] for name in options_of_the_core()},
                             set(re.findall(r"#define (\w+)", make.ARDUINO_EIGEN)))


class Cmsis(unittest.TestCase):
    pack = xml.etree.ElementTree.fromstring(text("packages/Cairn.Cairn.pdsc"))

    def test_name_and_files(self):
        self.assertEqual((self.pack.findtext("vendor"), self.pack.findtext("name")), ("Cairn", "Cairn"))
        for file in [*(f.get("name") for f in self.pack.iter("file")), self.pack.findtext("license")]:
            self.assertTrue((ROOT / file).exists(), file)
        conditions = {c.get("id") for c in self.pack.iter("condition")}
        self.assertLessEqual({c.get("condition") for c in self.pack.iter("component")}, conditions)

    def test_every_source_is_listed(self):
        description = text("packages/Cairn.Cairn.pdsc")
        self.assertEqual(write_pdsc.with_sources(description, ROOT), description,
                         "run packages/write_pdsc.py")


class Idf(unittest.TestCase):
    def test_the_component(self):
        said = configure(f"""
cmake_minimum_required(VERSION 3.25)
project(idf LANGUAGES CXX)
set(ESP_PLATFORM 1)
set(COMPONENT_LIB component)
function(idf_component_register)
  cmake_parse_arguments(arg "" "" "SRCS;INCLUDE_DIRS;REQUIRES" ${{ARGN}})
  add_library(component STATIC ${{arg_SRCS}})
  target_include_directories(component PUBLIC ${{arg_INCLUDE_DIRS}})
  list(LENGTH arg_SRCS count)
  message("sources ${{count}} includes ${{arg_INCLUDE_DIRS}} requires ${{arg_REQUIRES}}")
endfunction()
set(CAIRN_C_CONFIG tiny)
add_subdirectory({ROOT} cairn)
get_target_property(definitions component COMPILE_DEFINITIONS)
message("definitions ${{definitions}}")
""")
        count = len(list((ROOT / "core/src").rglob("*.cpp")))
        self.assertIn(f"sources {count} includes core/include requires eigen", said)
        definitions = set(re.search(r"^definitions (\S+)", said, re.M)[1].split(";"))
        self.assertLessEqual(options_of_the_core() | {"CAIRN_CONFIG_TINY"}, definitions)
        self.assertIn("espressif/eigen", text("idf_component.yml"))


class Zephyr(unittest.TestCase):
    def test_the_module(self):
        module = dict(re.findall(r"^\s*(\w+): (\S+)$", text("zephyr/module.yml"), re.M))
        self.assertEqual(module["name"], "cairn")
        self.assertTrue((ROOT / module["cmake"] / "CMakeLists.txt").is_file())
        self.assertTrue((ROOT / module["kconfig"]).is_file())

    def test_cmake_uses_the_symbols_of_kconfig(self):
        symbols = set(re.findall(r"^(?:menu)?config (\w+)|^choice (\w+)", text("zephyr/Kconfig"), re.M))
        symbols = {a or b for a, b in symbols}
        used = set(re.findall(r"CONFIG_(CAIRN\w*)", text("zephyr/CMakeLists.txt")))
        self.assertLessEqual(used, symbols)

    def test_an_application_gets_the_libraries(self):
        said = configure(f"""
cmake_minimum_required(VERSION 3.25)
project(zephyr LANGUAGES C CXX)
add_library(zephyr_interface INTERFACE)
add_library(app STATIC {ROOT}/port/template/port.c)
set(CONFIG_CAIRN y)
set(CONFIG_CAIRN_CONFIG_TINY y)
set(CONFIG_CAIRN_EIGEN_INCLUDE_DIR {os.environ["EIGEN"]})
add_subdirectory({ROOT}/zephyr module)
get_target_property(libraries app LINK_LIBRARIES)
message("app links ${{libraries}}")
""")
        self.assertRegex(said, "app links .*cairn_c_tiny;cairn_core")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
