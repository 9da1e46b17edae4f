#!/usr/bin/env python3
"""Runs the core compiled to WebAssembly in node and compares it with the host's programs, line by line: the
modules (exercise), replays of input logs, and the page's own module on a clip made of a log.

usage: equals_native.py HOST_BUILD WASM_BUILD LOG...
A LOG whose name contains "handheld" is replayed in hand-held mode, any other in vehicle mode and as a clip.
Exit status 77, with the reason, where emscripten or its build is missing, or older than the sources.
"""
import importlib.util
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
# Without its fetch(): emscripten 3.1.6 takes a node that has one for a browser.
NODE = ["node", "--no-experimental-fetch"]
PROGRAMS = ["exercise", "replay_vehicle", "replay_handheld"]


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(77)


def lines(command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{command[0]}: status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout.splitlines()


def compare(name, expected, got):
    differ = [(a, b) for a, b in zip(expected, got) if a != b]
    for a, b in differ[:5]:
        print(f"host {a}\nwasm {b}")
    good = expected and len(expected) == len(got) and not differ
    print(f"{name}: {len(expected)} and {len(got)} lines, {len(differ)} differ")
    return bool(good)


def need_build(wasm):
    """Skips where the programs are not there, or older than their sources: to build them takes minutes."""
    if shutil.which("emcc") is None:
        skip("no emscripten here (Debian: emscripten, node-acorn)")
    if not (wasm / "CMakeCache.txt").exists():
        skip(f"{wasm} is not there: scripts/web.sh makes it")
    pending = subprocess.run(["ninja", "-C", str(wasm), "-n", "engine", *PROGRAMS], capture_output=True, text=True)
    if "no work to do" not in pending.stdout:
        skip(f"{wasm} is older than the sources: scripts/web.sh renews it")


def missing_for_clips(host):
    """What the test on a clip lacks, or None."""
    if importlib.util.find_spec("PIL") is None:
        return "no imaging library (Debian: python3-pil)"
    if not (host / "bin/unpack_clip").exists():
        return "no unpack_clip in this build (Debian: libstb-dev)"
    return None


def clip_equals_host(host, wasm, log, folder):
    clip, unpacked = folder / "log.clip", folder / "unpacked.log"
    lines([sys.executable, ROOT / "web/make_clip.py", log, clip])
    lines([host / "bin/unpack_clip", clip, unpacked])
    return compare(f"clip of {log.name}", lines([host / "bin/replay_vehicle", unpacked, "--overlay", "yes"]),
                   lines([*NODE, ROOT / "tests/web/replay_clip.js", wasm / "bin/engine.wasm", clip]))


def main():
    host, wasm = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    need_build(wasm)
    good = compare("exercise", lines([host / "bin/exercise"]), lines([*NODE, wasm / "bin/exercise.js"]))
    for log in map(pathlib.Path, sys.argv[3:]):
        program = "replay_handheld" if "handheld" in log.name else "replay_vehicle"
        arguments = [log, "--overlay", "yes"]
        good &= compare(log.name, lines([host / "bin" / program, *arguments]),
                        lines([*NODE, wasm / f"bin/{program}.js", *arguments]))
        if program == "replay_handheld":
            continue
        missing = missing_for_clips(host)
        if missing is not None:
            print(f"clip of {log.name}: left out, {missing}")
            continue
        with tempfile.TemporaryDirectory() as folder:
            good &= clip_equals_host(host, wasm, log, pathlib.Path(folder))
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
