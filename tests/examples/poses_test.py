#!/usr/bin/env python3
"""What uart_pose sends is what poses.py reads: every frame, the pose that the tracker has, through damage.

usage: poses_test.py EXAMPLES UART_POSE MINIMAL LOG
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

EXAMPLES, UART_POSE, MINIMAL, LOG = sys.argv[1:5]
sys.path.insert(0, str(pathlib.Path(EXAMPLES) / "uart_pose"))
import poses  # noqa: E402


def sent_bytes():
    with tempfile.TemporaryDirectory() as name:
        sent = pathlib.Path(name) / "sent"
        subprocess.run([UART_POSE], env={**os.environ, "CAIRN_LOG": LOG, "CAIRN_SENT": str(sent)}, check=True)
        return sent.read_bytes()


SENT = sent_bytes()


def read(data, piece=64):
    reader = poses.Reader()
    found = []
    for at in range(0, len(data), piece):
        found += reader.feed(data[at:at + piece])
    return found, reader.damaged


class Poses(unittest.TestCase):
    def test_cobs_of_the_paper(self):
        for coded, plain in [("0101", "00"), ("010101", "0000"), ("03112202 33".replace(" ", ""), "11220033"),
                             ("0511223344", "11223344"), ("0211010101", "11000000")]:
            self.assertEqual(poses.cobs_decode(bytes.fromhex(coded)), bytes.fromhex(plain))
        self.assertIsNone(poses.cobs_decode(bytes.fromhex("0511")))

    def test_every_frame_comes_through(self):
        out = subprocess.run([MINIMAL], env={**os.environ, "CAIRN_LOG": LOG}, capture_output=True, text=True,
                             check=True).stdout.splitlines()
        found, damaged = read(SENT)
        self.assertEqual(damaged, 0)
        self.assertEqual(len(found), len(out))
        self.assertGreaterEqual(len(found), 30)
        self.assertTrue(all(a[0] < b[0] for a, b in zip(found, found[1:])))
        # The camera stands 0.35 m ahead of the vehicle and 1 m above the floor, which is what
        # minimal prints.
        for pose, line in zip(found, out):
            x, y, _ = map(float, line.split())
            distance = ((pose[5][0] - x) ** 2 + (pose[5][1] - y) ** 2) ** 0.5
            self.assertAlmostEqual(distance, 0.35, delta=0.002)
            self.assertAlmostEqual(pose[5][2], 1.0, delta=1e-4)

    def test_pieces_of_any_size_give_the_same(self):
        self.assertEqual(read(SENT, 1), read(SENT, 1000))

    def test_a_damaged_byte_costs_one_packet(self):
        data = SENT[:44 * 5]
        for at in range(44, 44 * 4):
            damaged = bytearray(data)
            damaged[at] ^= 0x20
            found, count = read(bytes(damaged))
            self.assertGreaterEqual(len(found), 3, at)  # a lost closing zero costs its neighbour too
            self.assertGreaterEqual(count, 1)
            self.assertTrue(set(p[0] for p in found) <= set(p[0] for p in read(data)[0]))

    def test_a_reader_may_come_late(self):
        found, damaged = read(SENT[20:])
        self.assertEqual((len(found), damaged), (len(read(SENT)[0]) - 1, 1))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
