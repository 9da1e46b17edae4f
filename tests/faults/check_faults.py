#!/usr/bin/env python3
"""Runs one fault class in its short form and compares what fails with the known gaps.

usage: check_faults.py CAIRN_SIM KNOWN_GAPS FAULT

KNOWN_GAPS has a line `FAULT|injected` for every injection that the core is known not to stand; its
reason is in docs/results/faults.md. One that fails and is not known, and one that is known and does
not fail any more, end with code 1.
"""
import csv
import pathlib
import subprocess
import sys
import tempfile


def known_gaps(path, fault):
    lines = pathlib.Path(path).read_text(encoding="utf-8").splitlines()
    gaps = [line.split("|", 1) for line in lines if line and not line.startswith("#")]
    return {injected for name, injected in gaps if name == fault}


def main(program, gaps_file, fault):
    with tempfile.TemporaryDirectory() as folder:
        table = pathlib.Path(folder) / "faults.csv"
        run = subprocess.run([program, "inject", "--brief", "--fault", fault, "--out", str(table)],
                             capture_output=True, text=True, check=False)
        print(run.stdout, run.stderr, sep="")
        if not table.exists():
            sys.exit(f"no results: exit code {run.returncode}")
        with open(table, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    failed = {row["injected"] for row in rows if row["result"] == "FAIL"}
    if run.returncode != (1 if failed else 0):
        sys.exit(f"exit code {run.returncode} with {len(failed)} failures")
    known = known_gaps(gaps_file, fault)
    problems = [f"fails: {name}" for name in sorted(failed - known)]
    problems += [f"known gap that is closed, take it from {gaps_file}: {name}"
                 for name in sorted(known - failed)]
    for problem in problems:
        print(problem)
    sys.exit(1 if problems else 0)


main(*sys.argv[1:])
