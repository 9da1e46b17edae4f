#!/usr/bin/env python3
"""Packs a log as a clip, unpacks it, and damages the clip in many ways: what comes out is the log but for its
pictures, which differ little, and damage is refused with where it lies.

usage: clip_test.py UNPACK_CLIP LOG
Exit status 77, with the reason, without the program or the imaging library.
"""
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "web"))

FRAME = 3
HEAD = 20


class Clip(unittest.TestCase):
    unpack = log = None

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.clip = self.folder / "a.clip"
        self.unpacked = self.folder / "a.log"
        self.assertEqual(make_clip.main([str(self.log), str(self.clip), "90"]), 0)

    def run_unpack(self, clip):
        path = self.folder / "b.clip"
        path.write_bytes(clip)
        return subprocess.run([self.unpack, path, self.unpacked], capture_output=True, text=True)

    def test_the_log_comes_back_with_nearly_the_same_pictures(self):
        self.assertEqual(self.run_unpack(self.clip.read_bytes()).returncode, 0)
        before = list(make_clip.records_of(self.log.read_bytes()))
        after = list(make_clip.records_of(self.unpacked.read_bytes()))
        self.assertEqual([kind for kind, _ in before], [kind for kind, _ in after])
        frames = 0
        for (kind, a), (_, b) in zip(before, after):
            if kind != FRAME:
                self.assertEqual(a, b)
                continue
            frames += 1
            self.assertEqual(a[:HEAD], b[:HEAD])
            self.assertLess(sum(abs(p - q) for p, q in zip(a[HEAD:], b[HEAD:])) / len(a[HEAD:]), 3.0)
        self.assertGreater(frames, 0)

    def test_damage_is_refused(self):
        clip = self.clip.read_bytes()
        for at in (0, 7, 9, 20, len(clip) // 2, len(clip) // 2 + 1):
            damaged = bytearray(clip)
            damaged[at] ^= 0x20
            done = self.run_unpack(bytes(damaged))
            self.assertEqual(done.returncode, 3, at)
            self.assertRegex(done.stderr, "no whole clip .*at byte")

    def test_a_clip_that_ends_early_is_refused(self):
        clip = self.clip.read_bytes()
        for size in (0, 5, 8, 100, len(clip) // 2, len(clip) - 1):
            self.assertEqual(self.run_unpack(clip[:size]).returncode, 3, size)

    def test_what_lies_behind_the_end_is_refused(self):
        self.assertEqual(self.run_unpack(self.clip.read_bytes() + b"more").returncode, 3)

    def test_a_picture_of_another_size_is_refused(self):
        """A frame's head that says another size than its JPEG, with a right checksum."""
        clip = bytearray(self.clip.read_bytes()[:8])
        for kind, payload in make_clip.records_of(b"CAIRNLOG" + self.clip.read_bytes()[8:]):
            if kind == make_clip.PACKED_FRAME:
                payload = payload[:12] + struct.pack("<HH", 160, 120) + payload[16:]
            clip += make_clip.record(kind, payload)
        self.assertEqual(self.run_unpack(bytes(clip)).returncode, 3)

    def test_what_is_no_log_is_refused(self):
        other = self.folder / "other"
        other.write_bytes(b"CAIRNLOG" + bytes(100))
        self.assertEqual(make_clip.main([str(other), str(self.clip)]), 3)


if __name__ == "__main__":
    Clip.unpack, Clip.log = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    if not Clip.unpack.exists():
        print("skipped: no unpack_clip in this build (Debian: libstb-dev)")
        sys.exit(77)
    import make_clip
    try:
        import PIL  # noqa: F401
    except ImportError as missing:
        print(f"skipped: {missing} (Debian: python3-pil)")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
