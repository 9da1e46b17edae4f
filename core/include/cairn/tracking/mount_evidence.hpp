#pragma once

#include <cstdint>

#include "cairn/geometry/rigid.hpp"

namespace cairn {

/// How far a camera and its mount are from what the tracker was told.
struct MountOffset {
  /// Angles turn the camera about the vehicle's axes, rad: yaw to the left, pitch nose down, roll
  /// to the right. kFocal: natural logarithm of the true focal length over the assumed one.
  enum Part : std::uint8_t { kYaw, kPitch, kRoll, kFocal };
  static constexpr int kParts = 4;

  float value[kParts] = {};
  float sigma[kParts] = {};   ///< standard deviations; what cannot be told from pictures is large
  bool suspect[kParts] = {};  ///< surely off by more than a careful calibration leaves

  bool any_suspect() const {
    return suspect[kYaw] || suspect[kPitch] || suspect[kRoll] || suspect[kFocal];
  }
};

/// One point seen in two frames.
struct TwoViews {
  Vector2<float> first = Vector2<float>::Zero();   ///< x/z, y/z by the assumed camera
  Vector2<float> second = Vector2<float>::Zero();  ///< same, in the later frame
};

/// Estimates a MountOffset from points seen twice, without their depths: by the mount, the camera
/// and the motion that odometry tells, the second view lies on a line in the image (epipolar
/// constraint). A wrong mount or camera leaves distances from that line.
///
/// Weighted least squares (Huber) on those distances, divided by their standard deviations
/// (Sampson's approximation, whose denominator is differentiated too: without that, noise in the
/// views makes the focal length too long). The vehicle's own roll, pitch and yaw between the two
/// frames are unknowns of each pair of frames and are eliminated from it. What is older than half a
/// minute fades.
class MountEvidence {
 public:
  static constexpr int kMotions = 3;  ///< roll, pitch and yaw of the vehicle

  /// Starts anew. `rotation_vehicle_camera`: the assumed mount; `focal_px`: the assumed focal
  /// length; `sigma_px`: standard deviation of a view, > 0.
  void reset(const Quaternion<float>& rotation_vehicle_camera, float focal_px, float sigma_px);

  /// Begins a pair of frames. `T_second_first`: the vehicle's motion by odometry, points of its
  /// frame then to its frame now, m; `camera_m`: the camera in the vehicle's frame;
  /// `sigma_motion`: of roll, pitch and yaw in that motion, rad, > 0.
  void begin_pair(const Rigid<float>& T_second_first, const Vector3<float>& camera_m,
                  const float (&sigma_motion)[kMotions]);
  /// Distance in the image between where the second view is and where it would be without
  /// translation, px: what tells the direction of travel.
  float flow_px(const TwoViews& views) const;
  void add(const TwoViews& views);
  /// Corrects the pair's motion by what was added, which has then to be added again: derivatives
  /// taken at a wrong motion would make the offsets too small.
  void refine_motion();
  /// Takes the pair in, unless a third of its points disagree; the one before was `step_s` older.
  /// Cost: some 2,000 operations.
  void end_pair(float step_s);

  const MountOffset& offset() const { return offset_; }

 private:
  static constexpr int kParts = MountOffset::kParts;
  static constexpr int kAll = kParts + kMotions;

  struct Row {
    float residual_px = 0.0F;
    float by[kAll] = {};  ///< derivatives, offset first
  };
  /// Normal equations of one pair.
  struct Pair {
    Matrix3<float> rotation_vehicle_camera = Matrix3<float>::Identity();  ///< as estimated by now
    Matrix3<float> R = Matrix3<float>::Identity();  ///< first camera to second
    Vector3<float> t = Vector3<float>::Zero();      ///< first camera in the second, m
    float scale = 1.0F;                             ///< of views, by the estimated focal length
    float variance[kMotions] = {};
    Vector3<float> motion = Vector3<float>::Zero();  ///< its correction, contained in R
    float information[kAll * (kAll + 1) / 2] = {};   ///< lower triangle
    float right[kAll] = {};
    float squares = 0.0F;
    float rows = 0.0F;
    float outliers = 0.0F;
    bool refined = false;
  };

  Vector3<float> ray(const Vector2<float>& view) const {
    return {pair_.scale * view.x(), pair_.scale * view.y(), 1.0F};
  }
  /// Place of element (i, k) of a symmetric matrix in its lower triangle.
  static int at(int i, int k) { return i >= k ? i * (i + 1) / 2 + k : k * (k + 1) / 2 + i; }
  bool row_of(const TwoViews& views, Row& row) const;
  /// Normal equations of the motion at the offset and motion of now; false where they are singular.
  bool motion_equations(Matrix3<float>& inverse, Vector3<float>& residual) const;
  void solve();
  void relinearise();

  Matrix3<float> assumed_ = Matrix3<float>::Identity();  ///< camera to vehicle
  float focal_px_ = 1.0F;
  float sigma_px_ = 1.0F;
  Pair pair_;
  float information_[kParts][kParts] = {};
  float right_[kParts] = {};
  float squares_ = 0.0F;  ///< of normalised residuals
  float rows_ = 0.0F;
  float linearised_[kParts] = {};  ///< offset around which most of the sums were taken
  MountOffset offset_;
};

}  // namespace cairn
