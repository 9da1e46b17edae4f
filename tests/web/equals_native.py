#!/usr/bin/env python3
"""Runs the core compiled to WebAssembly in node and compares it with the host's programs, line by line: the
modules (exercise), replays of input logs, and the page's own module on a clip made of a log.

usage: equals_native.py HOST_BUILD WASM_BUILD LOG...
A LOG whose name contains "handheld" is replayed in hand-held mode, any other in vehicle mode and as a clip.
Exit status 77, with the reason, where emscripten or one of its builds is missing.
"""
import os
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


def build(wasm):
    """Brings the programs up to date; skips where they cannot be built."""
    if shutil.which("emcc") is None:
        skip("no emscripten here (Debian: emscripten, node-acorn)")
    if not (wasm / "CMakeCache.txt").exists():
        skip(f"{wasm} is not there: scripts/web.sh makes it")
    environment = dict(os.environ, NODE_PATH="/usr/share/nodejs")
    done = subprocess.run(["cmake", "--build", str(wasm), "--target", "engine", *PROGRAMS, "-j1"], env=environment,
                          capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{wasm} does not build:\n{done.stdout}{done.stderr}")


def imaging():
    try:
        import PIL  # noqa: F401
    except ImportError as missing:
        skip(f"{missing} (Debian: python3-pil)")


def clip_equals_host(host, wasm, log, folder):
    clip, unpacked = folder / "log.clip", folder / "unpacked.log"
    lines([sys.executable, ROOT / "web/make_clip.py", log, clip])
    lines([host / "bin/unpack_clip", clip, unpacked])
    return compare(f"clip of {log.name}", lines([host / "bin/replay_vehicle", unpacked, "--overlay", "yes"]),
                   lines([*NODE, ROOT / "tests/web/replay_clip.js", wasm / "bin/engine.wasm", clip]))


def main():
    host, wasm = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    build(wasm)
    good = compare("exercise", lines([host / "bin/exercise"]), lines([*NODE, wasm / "bin/exercise.js"]))
    for log in map(pathlib.Path, sys.argv[3:]):
        program = "replay_handheld" if "handheld" in log.name else "replay_vehicle"
        arguments = [log, "--overlay", "yes"]
        good &= compare(log.name, lines([host / "bin" / program, *arguments]),
                        lines([*NODE, wasm / f"bin/{program}.js", *arguments]))
        if program == "replay_vehicle":
            if not (host / "bin/unpack_clip").exists():
                skip("no unpack_clip in this build (Debian: libstb-dev)")
            imaging()
            with tempfile.TemporaryDirectory() as folder:
                good &= clip_equals_host(host, wasm, log, pathlib.Path(folder))
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
