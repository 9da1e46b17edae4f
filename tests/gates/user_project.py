#!/usr/bin/env python3
"""Follows docs/how-to/add-to-your-firmware.md to the letter: a project of its own with a toolchain file of
its own takes the page's CMake and C++, and the file compiles with the tracker in a section without
contents.

usage: user_project.py ROOT NM
"""
import pathlib
import re
import subprocess
import sys
import tempfile

TOOLCHAIN = """
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_C_FLAGS_INIT "-mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard")
set(CMAKE_CXX_FLAGS_INIT "-mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard -fno-exceptions -fno-rtti")
"""
# An object library: the page's own code is compiled, the core's sources are not.
PROJECT = """
cmake_minimum_required(VERSION 3.25)
project(user_project LANGUAGES C CXX)
add_library(firmware OBJECT main.cpp)
target_compile_options(firmware PRIVATE -Wall -Wextra -Werror)
"""


def code_blocks(page):
    """The indented blocks of a page; blank lines between indented ones belong to them."""
    found = re.findall(r"(?:^    .*\n|^\n(?=    ))+", page.read_text(), re.M)
    return [re.sub(r"^    ", "", block, flags=re.M).strip("\n") + "\n" for block in found]


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"user_project: {command[0]} failed:\n{done.stdout}{done.stderr}")
    return done.stdout


def main():
    root, nm = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    blocks = code_blocks(root / "docs/how-to/add-to-your-firmware.md")
    cmake = [block for block in blocks if "add_subdirectory" in block]
    code = [block for block in blocks if "add_subdirectory" not in block]
    if len(cmake) != 1 or not code:
        sys.exit("user_project: the page has no CMake or no C++ to follow")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "cairn").symlink_to(root, target_is_directory=True)
        (folder / "toolchain.cmake").write_text(TOOLCHAIN)
        (folder / "CMakeLists.txt").write_text(PROJECT + cmake[0])
        (folder / "main.cpp").write_text("\n".join(code))
        run("cmake", "-S", folder, "-B", folder / "build", "-G", "Ninja",
            f"--toolchain={folder}/toolchain.cmake", "-DCMAKE_BUILD_TYPE=Release")
        run("cmake", "--build", folder / "build", "--target", "firmware")
        built = next((folder / "build").rglob("main.cpp.obj"))
        symbols = run(nm, "-S", "-C", built)
    tracker = re.search(r"^\S+ (\S+) (\S) tracker$", symbols, re.M)
    if tracker is None or tracker[2] != "b":
        print(f"the tracker is not in memory without contents:\n{symbols}")
        return 1
    print(f"the page's firmware compiles; its tracker takes {int(tracker[1], 16)} bytes of memory, none of flash")
    return 0


if __name__ == "__main__":
    sys.exit(main())
