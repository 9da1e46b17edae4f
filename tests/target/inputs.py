"""Input logs that the firmware is compared and timed on: the list in inputs.json.

An entry gives `name`, `set` (typical or worst), `images` (replay programs without replay_) and how to
make its log: `source` with `frames` and `arguments` for `cairn_sim run`, or `command`, a list in
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
    return [host / "bin/cairn_sim", "run", entry["source"], *entry.get("arguments", []),
            "--max-frames", str(entry["frames"]), "--no-video", "--out", out, "--record", log]


def record(host, folder, names=None):
    """Makes the logs of all entries (or of `names`) in `folder` with the programs of the build `host`."""
    entries = json.loads((ROOT / "tests/target/inputs.json").read_text())["inputs"]
    inputs = []
    for entry in entries:
        if names is not None and entry["name"] not in names:
            continue
        if "needs" in entry and not (ROOT / entry["needs"]).exists():
            print(f"{entry['name']}: left out, {entry['needs']} is not there")
            continue
        log = folder / f"{entry['name']}.log"
        log.parent.mkdir(parents=True, exist_ok=True)
        command = [str(c) for c in command_of(entry, host, log, folder / entry["name"])]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{entry['name']}: {' '.join(command)} failed:\n{done.stdout}{done.stderr}")
        inputs.append(Input(entry["name"], entry["set"], entry["images"], log))
    return inputs
