#pragma once

#include <cstdint>

#include "cairn/geometry/fixed_camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/tracking/mount_offset.hpp"

namespace cairn {

/// One point seen in two frames: tangents of its rays, x/z and y/z, by the assumed camera.
struct TwoViews {
  FixedTangent first[2];
  FixedTangent second[2];
};

/// Two frames of a vehicle's camera, and how far the points that both see lie from their epipolar
/// lines: residuals divided by their standard deviations (Sampson's approximation, whose
/// denominator is differentiated too: without that, noise in the views makes the focal length too
/// long), with their derivatives, summed as normal equations with Huber's weights. What is done for
/// each point is done in integers, the same on every target, for cores without a floating-point
/// unit; what is done once, in float.
class EpipolarPair {
 public:
  static constexpr int kMotions = 3;  ///< roll, pitch and yaw of the vehicle between the frames
  static constexpr int kParts = MountOffset::kParts;

  /// The camera as it is taken for by now.
  struct Camera {
    Matrix3<float> rotation_vehicle_camera;
    Vector3<float> origin_m;  ///< in the vehicle's frame
    float focal_px = 1.0F;
    float view_scale = 1.0F;  ///< of TwoViews: assumed focal length over that of now
    float sigma_px = 1.0F;    ///< standard deviation of a view, > 0; at least focal_px / 16,000
  };
  /// Sums over the points, of sigma^-2 and by radians; the motion's own prior is not in them.
  struct Equations {
    float information[kParts][kParts] = {};
    float mixed[kParts][kMotions] = {};
    Matrix3<float> motion = Matrix3<float>::Zero();
    float right[kParts] = {};  ///< derivatives times residuals
    Vector3<float> right_motion = Vector3<float>::Zero();
    float squares = 0.0F;  ///< of residuals
    float rows = 0.0F;     ///< points
    float outliers = 0.0F;
  };

  /// `T_second_first`: the vehicle's motion by odometry, points of its frame then to its frame now,
  /// m; `sigma_motion`: of roll, pitch and yaw in that motion, rad, > 0.
  EpipolarPair(const Camera& camera, const Rigid<float>& T_second_first,
               const float (&sigma_motion)[kMotions]);

  /// Distance in the image between where the second view is and where it would be without
  /// translation, px: what tells the direction of travel. Views beyond 76 degrees: 0.
  float flow_px(const TwoViews& views) const;
  /// Without effect where the camera did not move, for views beyond 76 degrees, and for those at
  /// the direction of travel, which leaves no line. Cost on a Cortex-M7: some 4,000 instructions.
  void add(const TwoViews& views);
  /// Corrects the motion by what was added, which has then to be added again: derivatives taken at
  /// a wrong motion would make offsets too small.
  void refine_motion();

  Equations equations() const;
  /// Of roll, pitch and yaw: 1 / variance, and the correction that refine_motion() made, rad.
  const Vector3<float>& prior_information() const { return prior_; }
  const Vector3<float>& correction() const { return correction_; }

 private:
  static constexpr int kAll = kParts + kMotions;
  static constexpr int kSums = kAll * (kAll + 1) / 2;

  /// With 26 fraction bits.
  struct Vector {
    std::int32_t x = 0;
    std::int32_t y = 0;
    std::int32_t z = 0;
  };
  struct Lines;
  struct Row;

  static Vector vector_of(const Vector3<float>& v);
  static Vector cross(const Vector& a, const Vector& b);
  static std::int64_t dot(const Vector& a, const Vector& b);
  static Vector sum(const Vector& a, const Vector& b);
  static Vector difference(const Vector& a, const Vector& b);
  static Vector turn(const Vector (&rows)[3], const Vector& v);

  void take_rotation();
  bool ray(const FixedTangent (&view)[2], Vector& out) const;
  bool lines_of(const TwoViews& views, Lines& out) const;
  bool derive_by_motion(const Lines& lines, Row& row) const;
  bool derive_by_camera(const Lines& lines, Row& row) const;
  std::int64_t variance_of(const Row& row) const;

  Matrix3<float> rotation_vehicle_camera_;
  Matrix3<float> R_;  ///< first camera to second
  Vector3<float> prior_;
  Vector3<float> correction_ = Vector3<float>::Zero();
  float focal_px_;  ///< of now

  Vector axes_[3];                ///< the vehicle's, seen by the camera
  Vector rows_[3];                ///< of R
  Vector columns_[3];             ///< of R
  Vector t_;                      ///< direction of the first camera in the second
  std::int32_t scale_ = 0;        ///< of views, 28 fraction bits
  std::int32_t focal_ = 0;        ///< in standard deviations of a view, 8 fraction bits
  std::int32_t sigma_[kMotions];  ///< of the motion, rad, 28 fraction bits
  bool moved_ = false;
  bool refined_ = false;

  std::int64_t information_[kSums] = {};  ///< lower triangle, 16 fraction bits
  std::int64_t right_[kAll] = {};         ///< 20 fraction bits
  std::int64_t squares_ = 0;              ///< 24 fraction bits
  int added_ = 0;
  int outliers_ = 0;
};

}  // namespace cairn
