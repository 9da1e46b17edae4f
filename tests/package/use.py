#!/usr/bin/env python3
"""Uses Cairn as a user's project does.

usage: use.py ROOT BUILD HOW [TOOLCHAIN]
HOW: package (BUILD is installed to a new folder, found there, linked, and run where it can be),
subdirectory or fetch (the sources are part of the project; the user's own files are compiled).
Exit status 77 when the compiler of TOOLCHAIN is missing.
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

# A user's own, not one of toolchains/.
TOOLCHAIN = """
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_C_FLAGS_INIT "-mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard")
set(CMAKE_CXX_FLAGS_INIT "-mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard -fno-exceptions -fno-rtti")
"""


def run(*command, fails_with=None):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    said = done.stdout + done.stderr
    if fails_with is None and done.returncode:
        sys.exit(f"{' '.join(map(str, command))}: status {done.returncode}\n{said}")
    if fails_with is not None and (done.returncode == 0 or fails_with not in said):
        sys.exit(f"{' '.join(map(str, command))}: expected to fail with '{fails_with}':\n{said}")
    return said


def configure(consumer, build, settings, **expected):
    run("cmake", "-S", consumer, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", *settings, **expected)


def other_version(consumer, folder, wanted, settings):
    """The consumer, asking for another version: refused, by the version that was found."""
    copy = folder / f"consumer-{wanted}"
    shutil.copytree(consumer, copy)
    lists = copy / "CMakeLists.txt"
    lists.write_text(lists.read_text().replace("find_package(cairn 0.2 ", f"find_package(cairn {wanted} "))
    configure(copy, folder / f"build-{wanted}", settings, fails_with="version: 0.2")


def main():
    root, build, how = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]), sys.argv[3]
    for_board = len(sys.argv) > 4
    if for_board and shutil.which("arm-none-eabi-g++") is None:
        print("skipped: arm-none-eabi-g++ is not installed")
        return 77
    consumer = root / "tests/package/consumer"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        settings = [f"-DCAIRN_FROM={how}", f"-DCAIRN_ROOT={root}"]
        if for_board:
            (folder / "toolchain.cmake").write_text(TOOLCHAIN)
            settings.append(f"--toolchain={folder}/toolchain.cmake")
        if how == "package":
            run("cmake", "--install", build, "--prefix", folder / "installed", "--component", "cairn")
            settings += [f"-DCMAKE_PREFIX_PATH={folder}/installed", "-DCMAKE_FIND_ROOT_PATH_MODE_PACKAGE=BOTH"]
            for wanted in ("0.1", "0.9", "1.0"):
                other_version(consumer, folder, wanted, settings)
        configure(consumer, folder / "build", settings)
        run("cmake", "--build", folder / "build", *([] if how == "package" else ["--target", "user"]))
        if how == "package" and not for_board:
            for language in ("cpp", "c"):
                run(folder / "build" / f"pose_{language}")
    print(f"a user's project builds with Cairn by {how}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
