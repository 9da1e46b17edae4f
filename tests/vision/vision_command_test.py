#!/usr/bin/env python3
"""Runs cairn_sim vision on the images behind the expected outputs and compares every row.

vision_command_test.py CAIRN_SIM SHARED_FOLDER; exit status 77 (skipped) when the folder is absent.
"""

import csv
import pathlib
import subprocess
import sys
import tempfile

IMAGES = {
    "graf1": "homography/graf/img1.png",
    "graf3": "homography/graf/img3.png",
    "churchill1": "homography/churchill/1.png",
    "kitchen000": "seven_scenes_redkitchen/frame-000000.color.jpg",
    "desk00": "desk_tag_board/gray/0000.png",
}


def rows(path):
    with open(path, newline="") as file:
        return list(csv.reader(file))


def main():
    program, shared = sys.argv[1], pathlib.Path(sys.argv[2])
    golden = shared / "golden" / "vision"
    if not golden.is_dir():
        print(f"skipped: no {golden}")
        return 77
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        for name, image in IMAGES.items():
            out = pathlib.Path(folder) / name
            subprocess.run([program, "vision", shared / "data" / image, "--out", out], check=True)
            for kind in ("fast", "freak"):
                got, want = rows(out / f"{kind}.csv"), rows(golden / f"{name}_{kind}.csv")
                same = got[0] == want[0] and sorted(got) == sorted(want)
                print(f"{name} {kind}: {len(want) - 1} rows {'equal' if same else 'DIFFER'}")
                failures += not same
        missing = subprocess.run([program, "vision", pathlib.Path(folder) / "no.png", "--out", folder])
        if missing.returncode != 3:
            print(f"a missing image ended with {missing.returncode}, not 3")
            failures += 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
