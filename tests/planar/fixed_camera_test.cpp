#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "cairn/numeric/random.hpp"
#include "cairn/planar/fixed/camera.hpp"
#include "cairn/planar/observation/camera_view.hpp"

namespace cairn {
namespace {

/// A camera on a tilted vehicle, in fixed point and in double, with the numbers that fit the
/// former.
struct Pair {
  FixedCamera fixed;
  FixedMount mount;
  FixedTilt tilt;
  FixedAngle heading;
  PinholeCamera<double> camera;
  Rigid<double> T_vehicle_camera;
  VehicleTilt<double> tilted;

  explicit Pair(Random& random, bool distorts) {
    const auto within = [&random](double low, double high) {
      return low + (high - low) * random.next() / 4294967296.0;
    };
    fixed.width = 640;
    fixed.height = 480;
    fixed.fx = FixedPixel::nearest(within(150.0, 900.0));
    fixed.fy = FixedPixel::nearest(fixed.fx.to_double() * within(0.9, 1.1));
    fixed.cx = FixedPixel::nearest(within(300.0, 340.0));
    fixed.cy = FixedPixel::nearest(within(220.0, 260.0));
    if (distorts) {
      fixed.k1 = FixedTangent::nearest(within(-0.3, 0.1));
      fixed.k2 = FixedTangent::nearest(within(-0.02, 0.1));
      fixed.k3 = FixedTangent::nearest(within(-0.01, 0.02));
      fixed.p1 = FixedTangent::nearest(within(-0.003, 0.003));
      fixed.p2 = FixedTangent::nearest(within(-0.003, 0.003));
    }
    // A camera that looks ahead, turned by up to 20 degrees about any axis.
    Vector3<double> axis{within(-1, 1), within(-1, 1), within(-1, 1)};
    const double length = std::sqrt(axis.squaredNorm());
    const double half = within(0.0, 0.17);
    const Quaternion<double> turn(std::cos(half), std::sin(half) * axis.x() / length,
                                  std::sin(half) * axis.y() / length,
                                  std::sin(half) * axis.z() / length);
    const Quaternion<double> q = turn * Quaternion<double>(0.5, -0.5, 0.5, -0.5);
    mount.w = FixedRatio::nearest(q.w());
    mount.x = FixedRatio::nearest(q.x());
    mount.y = FixedRatio::nearest(q.y());
    mount.z = FixedRatio::nearest(q.z());
    mount.origin[0] = FixedLength::nearest(within(-1.0, 1.0));
    mount.origin[1] = FixedLength::nearest(within(-0.5, 0.5));
    mount.origin[2] = FixedLength::nearest(within(0.2, 2.0));
    tilt = {FixedAngle::nearest(within(-0.1, 0.1)), FixedAngle::nearest(within(-0.1, 0.1))};
    heading = FixedAngle::nearest(within(-3.0, 3.0));

    camera.fx = fixed.fx.to_double();
    camera.fy = fixed.fy.to_double();
    camera.cx = fixed.cx.to_double();
    camera.cy = fixed.cy.to_double();
    camera.k1 = fixed.k1.to_double();
    camera.k2 = fixed.k2.to_double();
    camera.k3 = fixed.k3.to_double();
    camera.p1 = fixed.p1.to_double();
    camera.p2 = fixed.p2.to_double();
    camera.width = fixed.width;
    camera.height = fixed.height;
    T_vehicle_camera.rotation = {mount.w.to_double(), mount.x.to_double(), mount.y.to_double(),
                                 mount.z.to_double()};
    for (int i = 0; i < 3; ++i) T_vehicle_camera.translation(i) = mount.origin[i].to_double();
    tilted = {tilt.pitch.to_double(), tilt.roll.to_double()};
  }

  detail::FixedCameraView fixed_view(std::uint32_t& saturations) const {
    FixedRatio sine;
    FixedRatio cosine;
    sin_cos(heading, sine, cosine);
    return {fixed, mount, cosine, sine, &tilt, saturations};
  }
  CameraView<double> double_view() const {
    CameraView<double> view(camera, tilted.T_level_vehicle() * T_vehicle_camera, 1.0);
    sin_cos(heading.to_double(), view.frame.sine, view.frame.cosine);
    view.tilts = true;
    return view;
  }
  TiltAxes<double> axes() const {
    TiltAxes<double> axes;
    RelativeFrame<double> frame;
    sin_cos(heading.to_double(), frame.sine, frame.cosine);
    const double pitch[2] = {0.0, 1.0};
    const double roll[2] = {std::cos(tilted.pitch), 0.0};
    frame.to_relative(pitch, axes.pitch);
    frame.to_relative(roll, axes.roll);
    axes.roll[2] = -std::sin(tilted.pitch);
    return axes;
  }
};

void compare(bool distorts) {
  Random random(distorts ? 2 : 1);
  int compared = 0;
  for (int k = 0; k < 3000; ++k) {
    const Pair pair(random, distorts);
    std::uint32_t saturations = 0;
    const detail::FixedCameraView fixed_view = pair.fixed_view(saturations);
    const CameraView<double> view = pair.double_view();
    // A point of the camera's view, in the world's axes from the vehicle.
    const double depth = 0.4 + 40.0 * std::pow(random.next() / 4294967296.0, 2.0);
    const double x = random.next() / 4294967296.0 - 0.5;
    const double y = random.next() / 4294967296.0 - 0.5;
    const Vector3<double> seen(depth * x, depth * y, depth);
    const Vector3<double> body = pair.tilted.T_level_vehicle() * (pair.T_vehicle_camera * seen);
    const double in_body[3] = {body.x(), body.y(), body.z()};
    double relative[3];
    view.frame.to_relative(in_body, relative);
    FixedLength point[3];
    for (int i = 0; i < 2; ++i) point[i] = FixedLength::nearest(relative[i]);
    point[2] = FixedLength::nearest(in_body[2]);
    for (int i = 0; i < 3; ++i) relative[i] = point[i].to_double();

    LinearisedObservation<double, 3> expected;
    Vector3<double> p_camera;
    detail::FixedPixelRows rows;
    const bool visible = view.linearise(relative, {}, expected, p_camera);
    ASSERT_EQ(fixed_view.linearise(point, rows, saturations), visible);
    ASSERT_EQ(saturations, 0U);
    if (!visible) continue;
    ++compared;
    const TiltRows<double> tilt(expected, relative, pair.axes());
    // Positions are right to 1e-6 m, a share of the depth.
    const double share = 2e-6 / p_camera.z() + 4e-8;
    for (int r = 0; r < 2; ++r) {
      const double f = r == 0 ? pair.camera.fx : pair.camera.fy;
      const double per_pixel = p_camera.z() / f;
      ASSERT_NEAR(rows.pixel[r].to_double(), -expected.innovation[r], 2.0 * f * share + 1e-4);
      ASSERT_NEAR(static_cast<double>(rows.per_pixel[r]) * std::pow(0.5, detail::kPixelBits),
                  per_pixel, per_pixel * share + 1e-12);
      for (int i = 0; i < 3; ++i) {
        ASSERT_NEAR(rows.h[r][i].to_double(), expected.h[r][i] * per_pixel, 4.0 * share);
      }
      for (int i = 0; i < 2; ++i) {
        ASSERT_NEAR(rows.tilt[r][i].to_double(), tilt.t[r][i] * per_pixel,
                    4.0 * share * depth + 1e-5);
      }
    }
    for (int i = 0; i < 3; ++i) {
      double depth_row[3];
      for (int j = 0; j < 3; ++j) depth_row[j] = view.R_camera_vehicle(2, j);
      view.frame.row_to_relative(depth_row[0], depth_row[1]);
      ASSERT_NEAR(rows.depth[i].to_double(), depth_row[i], 1e-8);
    }
  }
  EXPECT_GT(compared, 2500);
}

TEST(FixedCamera, PixelAndRowsEqualDouble) {
  compare(false);
}

TEST(FixedCamera, PixelAndRowsOfADistortingLensEqualDouble) {
  compare(true);
}

TEST(FixedCamera, RefusesWhatHasNoPixel) {
  Random random(3);
  Pair pair(random, true);
  std::uint32_t saturations = 0;
  detail::FixedProjection out;
  const auto point = [](double x, double y, double z) {
    return std::array<FixedLength, 3>{FixedLength::nearest(x), FixedLength::nearest(y),
                                      FixedLength::nearest(z)};
  };
  const auto seen = [&](const std::array<FixedLength, 3>& p) {
    const FixedLength at[3] = {p[0], p[1], p[2]};
    return project(pair.fixed, at, out, saturations);
  };
  EXPECT_TRUE(seen(point(0.1, 0.1, 1.0)));
  EXPECT_FALSE(seen(point(0.1, 0.1, 0.04)));
  EXPECT_FALSE(seen(point(0.1, 0.1, -1.0)));
  EXPECT_FALSE(seen(point(2.1, 0.0, 1.0)));
  pair.fixed.k1 = FixedTangent::nearest(-0.5);  // turns back at a radius of about 0.8
  pair.fixed.k2 = FixedTangent();
  pair.fixed.k3 = FixedTangent();
  EXPECT_TRUE(seen(point(0.7, 0.0, 1.0)));
  EXPECT_FALSE(seen(point(0.9, 0.0, 1.0)));
  EXPECT_EQ(saturations, 0U);
  pair.fixed.fx = FixedPixel();
  EXPECT_EQ(pair.fixed.check_numbers(), Status::kBadConfig);
}

}  // namespace
}  // namespace cairn
