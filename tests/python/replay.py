#!/usr/bin/env python3
"""Replays an input log by the Python module and prints the lines of tests/target/replay.cpp.

usage: replay.py MODULE_FOLDER LOG
"""
import pathlib
import struct
import sys

import numpy

sys.path.insert(0, sys.argv[1])
import cairn  # noqa: E402

HEADER, ODOMETRY, FRAME, END = 1, 2, 3, 4
HANDHELD, ACKERMANN, WINDOW = 1, 1, 4
FOCAL_VERSION = 5


def records_of(log):
    at = 8
    while at < len(log):
        kind, size = struct.unpack_from("<B3xI", log, at)
        yield kind, log[at + 8:at + 8 + size]
        at += 12 + size


def tracker_of(header):
    """As cairn::start_replay(), from the header's bytes (cairn/runtime/input_log.hpp)."""
    width, height = struct.unpack_from("<HH", header, 6)
    seed, start_t_us = struct.unpack_from("<Qq", header, 16)
    camera = cairn.Camera(width, height, *struct.unpack_from("<9f", header, 32))
    mounting = numpy.array(struct.unpack_from("<7f", header, 68), numpy.float32)
    if header[3] == WINDOW:
        parameters = cairn.WindowParameters()
        parameters.seed = seed
        version, focal_sigma_e4 = struct.unpack_from("<H8xH", header)
        with_focal = version == FOCAL_VERSION
        parameters.focal_sigma = numpy.float32(focal_sigma_e4 if with_focal else 0) / numpy.float32(10000)
        return cairn.WindowTracker(camera, parameters)
    if header[2] == HANDHELD:
        parameters = cairn.HandheldParameters()
        parameters.seed = seed
        parameters.adaptive_fading = header[5] == 1
        parameters.fading_factor = struct.unpack_from("<f", header, 12)[0]
        return cairn.HandheldTracker(camera, parameters)
    speed, turn, wheelbase, period = struct.unpack_from("<4f", header, 96)
    parameters = cairn.VehicleParameters()
    parameters.seed = seed
    parameters.sigma_speed_mps, parameters.sigma_turn = speed, turn
    parameters.wheelbase_m = wheelbase if wheelbase > 0 else 1e-6
    parameters.sample_period_s = period
    start = cairn.VehicleStart(start_t_us, *struct.unpack_from("<5f", header, 116))
    return cairn.VehicleTracker(camera, mounting, start, parameters)


def main():
    tracker = None
    for kind, payload in records_of(pathlib.Path(sys.argv[2]).read_bytes()):
        if kind == HEADER:
            tracker = tracker_of(payload)
        elif kind == ODOMETRY and isinstance(tracker, cairn.VehicleTracker):
            t_us, sort, speed, turn = struct.unpack("<qB3x2f", payload)
            (tracker.add_ackermann if sort == ACKERMANN else tracker.add_twist)(t_us, speed, turn)
        elif kind == FRAME:
            t_us, number, width, height, _ = struct.unpack_from("<qIHHi", payload)
            image = numpy.frombuffer(payload, numpy.uint8, offset=20).reshape(height, width)
            report = tracker.process_frame(image, t_us)
            print(f"frame {number} {t_us} {report['status']} {tracker.hash:016x}")


main()
