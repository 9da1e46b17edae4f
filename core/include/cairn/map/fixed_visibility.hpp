#pragma once

#include "cairn/geometry/fixed_rigid.hpp"
#include "cairn/map/visibility.hpp"

namespace cairn {

/// LandmarkViews<float> without floating point, but without predictions: which landmarks are to be
/// seen. Farther than 128 m away none is.
class FixedLandmarkViews {
 public:
  FixedLandmarkViews(const PinholeCamera<float>& camera, const Rigid<float>& T_map_camera,
                     const VisibilityOptions<float>& options);

  template <int Views>
  bool operator()(const LibraryLandmark<float, Views>& landmark,
                  VisibleLandmark<float>& candidate) const {
    Point point;
    if (!look_at(landmark.p_map, point)) return false;
    FixedRatio best_cosine = min_cosine_;
    bool seen = false;
    for (int v = 0; v < landmark.view_count; ++v) {
      if (!is_like(point, landmark.views[v], best_cosine)) continue;
      candidate.view = v;
      seen = true;
    }
    return seen;
  }

 private:
  using Scale = Fixed<std::int32_t, 16>;
  struct Point {
    FixedCoordinate p_map[3];
    FixedOffset to_camera[3];
    FixedLength depth;
  };

  bool look_at(const Vector3<float>& p_map, Point& point) const;
  /// Whether a view is at a scale to be matched and in a direction nearer than `best_cosine`, which
  /// it then replaces.
  bool is_like(const Point& point, const LandmarkView<float>& view, FixedRatio& best_cosine) const;

  FixedCamera camera_;
  FixedRigid T_map_camera_;
  detail::FixedRotation R_camera_map_;
  FixedPixel focal_;
  FixedPixel margin_;
  Scale min_scale_;
  Scale max_scale_;
  FixedRatio min_cosine_;
  bool usable_ = false;
};

}  // namespace cairn
