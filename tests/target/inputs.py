"""Input logs that the firmware is compared and timed on: the list in inputs.json.

An entry gives `name`, `set` (typical or worst), `images` (replay programs without replay_) and how to
make its log: `source`, with `frames` and `arguments` where needed, for `cairn_sim run`, or `command`, a list in
which {bin}, {log} and {out} are replaced. `needs`: a path without which the entry is left out.
Paths are relative to the project's root. Logs are made anew whenever they are asked for, by the code
as it is.
"""
import json
import pathlib
import subprocess
import sys
from dataclasses import dataclass

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


@dataclass
class Input:
    name: str
    set: str
    images: list
    log: pathlib.Path


def command_of(entry, host, log, out):
    if "command" in entry:
        places = {"{bin}": str(host / "bin"), "{log}": str(log), "{out}": str(out)}
        for place, value in places.items():
            entry["command"] = [part.replace(place, value) for part in entry["command"]]
        return entry["command"]
    frames = ["--max-frames", str(entry["frames"])] if "frames" in entry else []
    return [host / "bin/cairn_sim", "run", entry["source"], *entry.get("arguments", []), *frames,
            "--no-video", "--force", "--out", out, "--record", log]


def entries_of(names=None):
    """The entries of inputs.json (or those of `names`) whose data are there."""
    for entry in json.loads((ROOT / "tests/target/inputs.json").read_text())["inputs"]:
        if names is not None and entry["name"] not in names:
            continue
        if "needs" in entry and not (ROOT / entry["needs"]).exists():
            print(f"{entry['name']}: left out, {entry['needs']} is not there")
            continue
        yield entry


def input_of(entry, folder):
    return Input(entry["name"], entry["set"], entry["images"], folder / f"{entry['name']}.log")


def recorded(folder):
    """The inputs whose logs record() left in `folder`."""
    return [each for each in (input_of(entry, folder) for entry in entries_of()) if each.log.exists()]


def record(host, folder, names=None):
    """Makes the logs of all entries (or of `names`) in `folder` with the programs of the build `host`."""
    made = []
    for entry in entries_of(names):
        new = input_of(entry, folder)
        folder.mkdir(parents=True, exist_ok=True)
        command = [str(c) for c in command_of(entry, host, new.log, folder / entry["name"])]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{entry['name']}: {' '.join(command)} failed:\n{done.stdout}{done.stderr}")
        made.append(new)
    return made
