#!/usr/bin/env python3
"""Decodes the poses of pose_frame.h: prints them, or plots them live.

usage: poses.py SOURCE [--plot]
SOURCE: a file, "-" for standard input, or a serial port that was set up before (stty -F /dev/ttyACM0
921600 raw). Printed: time (s), state, status, inliers, x y z (m), qw qx qy qz. Damaged packets are
left out and counted on standard error.
"""
import argparse
import struct
import sys

PACKET = struct.Struct("<BBBBq7fH")
STATES = ["initialising", "tracking", "uncertain", "lost"]


def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


def cobs_decode(data):
    """The bytes of one packet without its closing zero; None when the codes do not fit."""
    out, at = bytearray(), 0
    while at < len(data):
        code = data[at]
        if code == 0 or at + code > len(data):
            return None
        out += data[at + 1:at + code]
        at += code
        if code < 255 and at < len(data):
            out.append(0)
    return bytes(out)


def decode(data):
    """(t_us, state, status, inliers, quaternion, position), or None for a damaged packet."""
    packet = cobs_decode(data)
    if packet is None or len(packet) != PACKET.size or crc16(packet[:-2]) != PACKET.unpack(packet)[-1]:
        return None
    version, state, status, inliers, t_us, *pose, _ = PACKET.unpack(packet)
    if version != 1 or state >= len(STATES):
        return None
    return t_us, STATES[state], status, inliers, pose[:4], pose[4:]


class Reader:
    """Cuts a stream of bytes into packets; what comes before the first zero may be half a packet."""

    def __init__(self):
        self.rest = bytearray()
        self.damaged = 0

    def feed(self, data):
        self.rest += data
        *packets, self.rest = self.rest.split(b"\0")
        for packet in packets:
            pose = decode(packet)
            if pose is None:
                self.damaged += 1
            else:
                yield pose


def poses_of(file, reader):
    while data := file.read(64):
        yield from reader.feed(data)


def line(pose):
    t_us, state, status, inliers, q, p = pose
    numbers = " ".join(f"{value:.4f}" for value in [*p, *q])
    return f"{t_us / 1e6:.6f} {state} {status} {inliers} {numbers}"


def plot(poses):
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots()
    axes.set(xlabel="x (m)", ylabel="y (m)", aspect="equal")
    path, = axes.plot([], [], "-")
    now, = axes.plot([], [], "o")
    xs, ys = [], []
    for pose in poses:
        if pose[1] == "lost":
            continue
        xs.append(pose[5][0])
        ys.append(pose[5][1])
        path.set_data(xs, ys)
        now.set_data(xs[-1:], ys[-1:])
        axes.set_title(f"{pose[0] / 1e6:.2f} s, {pose[1]}, {pose[3]} landmarks")
        axes.relim()
        axes.autoscale_view()
        plt.pause(0.001)
    plt.show()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("source")
    parser.add_argument("--plot", action="store_true")
    arguments = parser.parse_args()
    try:
        file = sys.stdin.buffer if arguments.source == "-" else open(arguments.source, "rb", buffering=0)
    except OSError as error:
        sys.exit(f"poses.py: {arguments.source}: {error.strerror}")
    reader = Reader()
    poses = poses_of(file, reader)
    if arguments.plot:
        plot(poses)
    else:
        for pose in poses:
            print(line(pose), flush=True)
    if reader.damaged:
        print(f"{reader.damaged} damaged packets left out", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
