#!/usr/bin/env python3
"""Follows the recorded kitchen from its first frame (a slow start, then a fast pan) and from two frames later
on: to the end, and within the aim from the first frame. Exit status 77 where the recording is missing.

  recorded_test.py CAIRN_SIM SHARED_FOLDER
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

MAX_ATE_M = 0.15
MIN_TRACKED_SHARE = 0.95


def main():
    program, shared = sys.argv[1], Path(sys.argv[2])
    recording = shared / "data/seven_scenes_redkitchen"
    if not recording.is_dir():
        print(f"skipped: no {recording}")
        sys.exit(77)
    failed = False
    for first in (0, 150, 153):
        with tempfile.TemporaryDirectory() as out:
            subprocess.run([program, "run", f"seven-scenes:{recording}", "--filter", "mono", "--no-video",
                            "--first-frame", str(first), "--out", out], check=True, stdout=subprocess.DEVNULL)
            summary = json.loads((Path(out) / "summary.json").read_text(encoding="utf-8"))
        ate = summary["trajectory"]["ate_rmse_m"]
        share = summary["tracked"] / summary["frames"]
        good = ate is not None and ate <= MAX_ATE_M and share >= MIN_TRACKED_SHARE
        print(f"from frame {first}: ATE {ate} m, tracked {share:.3f}, lost {summary['lost']}: "
              f"{'ok' if good else 'FAILED'}")
        failed = failed or not good
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
