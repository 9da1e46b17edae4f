#!/usr/bin/env python3
"""Writes an input log's pictures as a YUV4MPEG2 video, forwards and backwards, so that it can be played in a loop:
what headless Chromium takes for a camera.

usage: make_y4m.py LOG OUT.y4m [RATE]
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent / "web"))
from make_clip import FRAME, FRAME_HEAD_BYTES, frame_size, records_of  # noqa: E402


def main():
    if len(sys.argv) not in (3, 4):
        print(__doc__, file=sys.stderr)
        return 2
    rate = int(sys.argv[3]) if len(sys.argv) == 4 else 30
    frames, size = [], None
    for kind, payload in records_of(pathlib.Path(sys.argv[1]).read_bytes()):
        if kind == FRAME:
            size = frame_size(payload)
            frames.append(payload[FRAME_HEAD_BYTES:])
    width, height = size
    grey = bytes([128]) * (((width + 1) // 2) * ((height + 1) // 2))
    with open(sys.argv[2], "wb") as out:
        out.write(b"YUV4MPEG2 W%d H%d F%d:1 Ip A1:1 C420jpeg\n" % (width, height, rate))
        for pixels in frames + frames[-2:0:-1]:
            out.write(b"FRAME\n" + pixels + grey + grey)
    return 0


if __name__ == "__main__":
    sys.exit(main())
