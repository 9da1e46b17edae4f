#!/usr/bin/env python3
"""What the Python module takes, gives and refuses.

usage: module_test.py MODULE_FOLDER
"""
import sys
import unittest

try:
    import numpy as np
except ImportError:
    print("skipped: no numpy here")
    sys.exit(77)

sys.path.insert(0, sys.argv.pop(1))
import cairn  # noqa: E402

MOUNTING = np.array([0.5, -0.5, 0.5, -0.5, 0.35, 0.0, 1.0], np.float32)


def camera():
    return cairn.Camera(320, 240, 250.0, 250.0, 159.5, 119.5)


def picture(seed=1):
    """Blocks of grey with fine noise: where neighbours are equally good corners, none is one."""
    rng = np.random.default_rng(seed)
    blocks = rng.integers(20, 220, (20, 27)).repeat(12, axis=0).repeat(12, axis=1)[:, :320]
    return (blocks + rng.integers(0, 9, blocks.shape)).astype(np.uint8)


class Images(unittest.TestCase):
    def setUp(self):
        self.tracker = cairn.HandheldTracker(camera())

    def test_other_types_and_shapes_are_named(self):
        with self.assertRaisesRegex(TypeError, "image: expected uint8, got float64"):
            self.tracker.process_frame(picture().astype(float), 0)
        with self.assertRaisesRegex(ValueError, r"image: expected the shape \(n, n\), got \(240, 320, 3\)"):
            self.tracker.process_frame(np.zeros((240, 320, 3), np.uint8), 0)
        with self.assertRaisesRegex(ValueError, "process_frame: invalid_argument"):
            self.tracker.process_frame(picture()[:100], 0)

    def test_a_view_with_gaps_is_the_same_picture(self):
        wide = np.repeat(picture(), 2, axis=1)
        other = cairn.HandheldTracker(camera())
        self.tracker.process_frame(picture(), 0)
        other.process_frame(wide[:, ::2], 0)
        self.assertEqual(self.tracker.hash, other.hash)

    def test_a_window_takes_the_same_pictures(self):
        window = cairn.WindowTracker(camera())
        report = window.process_frame(picture(), 0)
        self.assertEqual((report["status"], report["state"]), ("ok", "initialising"))
        self.assertGreater(report["landmarks"], 20)
        self.assertEqual(window.covariance().shape, (6, 6))
        self.assertTrue(window.add_angular_rate(1000, 0.1, 0.2, 0.3))
        self.assertFalse(window.add_angular_rate(1000, 0.1, 0.2, 0.3))
        self.assertEqual(window.gyro()["trust"], "unproven")
        self.assertEqual(window.gyro()["refused"], 1)
        with self.assertRaisesRegex(ValueError, "duplicate"):
            window.process_frame(picture(), 0)
        parameters = cairn.WindowParameters()
        parameters.focal_sigma = -1.0
        with self.assertRaisesRegex(ValueError, "WindowTracker: bad_config"):
            cairn.WindowTracker(camera(), parameters)

    def test_a_frame_in_the_past_is_refused_and_changes_nothing(self):
        self.tracker.process_frame(picture(), 1000)
        before = self.tracker.hash
        for t_us, why in ((1000, "duplicate"), (10, "time_backwards")):
            with self.assertRaisesRegex(ValueError, why):
                self.tracker.process_frame(picture(), t_us)
        self.assertEqual(self.tracker.health()["time_errors"], 2)
        self.assertEqual(self.tracker.process_frame(picture(), 33000)["t_us"], 33000)
        self.assertNotEqual(self.tracker.hash, before)


class Vehicle(unittest.TestCase):
    def test_odometry_moves_the_pose(self):
        vehicle = cairn.VehicleTracker(camera(), MOUNTING, cairn.VehicleStart(0, 1.0, 2.0, 0.0))
        for i in range(1, 11):
            self.assertEqual(vehicle.add_twist(100000 * i, 0.5, 0.0), "ok")
        pose, covariance = vehicle.pose()
        np.testing.assert_allclose(pose, [1.5, 2.0, 0.0], atol=1e-4)
        self.assertEqual(covariance.shape, (3, 3))
        self.assertGreater(covariance[0, 0], 0.0)

    def test_what_cannot_be_is_refused(self):
        with self.assertRaisesRegex(ValueError, "VehicleTracker: bad_config"):
            cairn.VehicleTracker(cairn.Camera(320, 240, 0.0, 250.0, 159.5, 119.5), MOUNTING)
        with self.assertRaisesRegex(ValueError, r"T_vehicle_camera: expected the shape \(7\), got \(6,\)"):
            cairn.VehicleTracker(camera(), MOUNTING[:6])
        vehicle = cairn.VehicleTracker(camera(), MOUNTING)
        with self.assertRaisesRegex(ValueError, "odometry: non_finite_input"):
            vehicle.add_twist(100000, float("nan"), 0.0)
        with self.assertRaisesRegex(ValueError, "load_map: "):
            vehicle.load_map(b"no map")

    def test_a_map_comes_back(self):
        vehicle = cairn.VehicleTracker(camera(), MOUNTING)
        vehicle.load_map(vehicle.save_map())


class Filters(unittest.TestCase):
    def test_a_sighting_narrows_the_pose(self):
        for Filter in (cairn.GroupIekfSlam, cairn.EkfSlam):
            slam = Filter((0.0, 0.0, 0.0), np.zeros((3, 3)) + 1e-8 * np.eye(3))
            R = 1e-4 * np.eye(2)
            for i, place in enumerate(((3.0, 1.0), (2.0, -2.0), (-1.0, 2.0))):
                slam.add_landmark(i + 1, place, R)
            slam.predict_twist(1.0, 0.0, 1.0, 0.2, 0.1)
            wide = slam.covariance
            seen = np.array([[1.9, 1.0], [0.9, -2.0], [-2.1, 2.0]])
            report = slam.update_points(np.array([1, 2, 3], np.uint32), seen, R)
            self.assertEqual((report["seen"], report["gated"]), (3, 0))
            self.assertLess(np.trace(slam.covariance), 0.1 * np.trace(wide))
            np.testing.assert_allclose(slam.pose, [1.1, 0.0, 0.0], atol=0.02)
            ids, positions, covariances = slam.landmarks()
            self.assertEqual(list(ids), [1, 2, 3])
            np.testing.assert_allclose(positions[0], [3.0, 1.0], atol=0.02)
            self.assertEqual(covariances.shape, (3, 2, 2))

    def test_what_cannot_be_is_refused(self):
        slam = cairn.GroupIekfSlam((0.0, 0.0, 0.0), 1e-6 * np.eye(3))
        with self.assertRaisesRegex(TypeError, "ids: expected uint32, got int64"):
            slam.update_points(np.array([1]), np.zeros((1, 2)), np.eye(2))
        with self.assertRaisesRegex(ValueError, "points: expected the shape"):
            slam.update_points(np.array([1], np.uint32), np.zeros((2, 2)), np.eye(2))
        with self.assertRaisesRegex(ValueError, "add_landmark: invalid_argument"):
            slam.add_landmark(0, (1.0, 1.0), np.eye(2))
        with self.assertRaisesRegex(ValueError, "initialise: "):
            cairn.EkfSlam((0.0, 0.0, 0.0), -np.eye(3))


class Vision(unittest.TestCase):
    def test_corners_of_a_square_are_its_corners(self):
        image = np.random.default_rng(1).integers(0, 9, (60, 80), np.uint8)
        image[20:40, 30:50] += 200
        corners = cairn.detect_fast(image, 40)
        places = np.array([(30, 20), (49, 20), (30, 39), (49, 39)])
        distances = np.abs(corners[:, None, :2] - places).max(axis=2)
        self.assertTrue((distances.min(axis=1) <= 2).all())
        self.assertTrue((distances.min(axis=0) <= 2).all())

    def test_a_descriptor_finds_itself(self):
        image = picture()
        corners = cairn.detect_fast(image, 30)
        descriptors, bins, described = cairn.describe_freak(image, corners)
        self.assertFalse(described.all())
        self.assertTrue(described.any())
        own = descriptors[described]
        matches = cairn.match_hamming(own, own)
        self.assertTrue((matches[:, 1] == 0).all())

    def test_bounds(self):
        self.assertEqual(len(cairn.detect_fast(picture(), 30, capacity=5)), 5)
        with self.assertRaisesRegex(ValueError, "detect_fast: invalid_argument"):
            cairn.detect_fast(picture(), 0)
        with self.assertRaisesRegex(ValueError, "queries: expected the shape"):
            cairn.match_hamming(np.zeros((1, 32), np.uint8), np.zeros((1, 64), np.uint8))


if __name__ == "__main__":
    unittest.main()
