#!/usr/bin/env python3
"""Packs an input log's pictures as JPEG: the clip that the page plays. The form: web/engine/clip_reader.hpp.

usage: make_clip.py LOG CLIP [QUALITY]
QUALITY: of the JPEGs, 1 to 95, default 65. Exit status 2 for a wrong call, 3 for a file that is no whole log.
"""
import io
import pathlib
import struct
import sys
import zlib

FRAME, PACKED_FRAME, END = 3, 5, 4
FRAME_HEAD_BYTES, SIZE_AT = 20, 12


def records_of(log):
    """(type, payload) of every record; ValueError where the log is damaged or not whole."""
    at, kind = 8, None
    if log[:8] != b"CAIRNLOG":
        raise ValueError("no input log")
    while kind != END:
        if at + 8 > len(log):
            raise ValueError("ends early")
        kind, size = struct.unpack_from("<B3xI", log, at)
        end = at + 8 + size
        if end + 4 > len(log) or struct.unpack_from("<I", log, end)[0] != zlib.crc32(log[at:end]):
            raise ValueError(f"damaged at byte {at}")
        yield kind, log[at + 8:end]
        at = end + 4


def packed(payload, quality):
    from PIL import Image  # here, so that reading logs needs no imaging library

    width, height = frame_size(payload)
    jpeg = io.BytesIO()
    Image.frombytes("L", (width, height), payload[FRAME_HEAD_BYTES:]).save(
        jpeg, "JPEG", quality=quality, optimize=True)
    return payload[:FRAME_HEAD_BYTES] + jpeg.getvalue()


def frame_size(payload):
    return struct.unpack_from("<HH", payload, SIZE_AT)


def record(kind, payload):
    body = struct.pack("<B3xI", kind, len(payload)) + payload
    return body + struct.pack("<I", zlib.crc32(body))


def main(arguments):
    if len(arguments) not in (2, 3):
        print(__doc__, file=sys.stderr)
        return 2
    quality = int(arguments[2]) if len(arguments) == 3 else 65
    clip = bytearray(b"CAIRNCLP")
    try:
        for kind, payload in records_of(pathlib.Path(arguments[0]).read_bytes()):
            if kind == FRAME:
                kind, payload = PACKED_FRAME, packed(payload, quality)
            clip += record(kind, payload)
    except ValueError as fault:
        print(f"make_clip: {arguments[0]}: {fault}", file=sys.stderr)
        return 3
    pathlib.Path(arguments[1]).write_bytes(clip)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
