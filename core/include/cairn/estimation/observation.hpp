#pragma once

#include <cstdint>

#include "cairn/geometry/types.hpp"

namespace cairn {

/// Identity of a landmark or feature, unique within one map for its whole life; 0 means none.
using LandmarkId = std::uint32_t;
inline constexpr LandmarkId kNoLandmark = 0;

/// Where a filter expects to see one of its landmarks, and how surely: the input of active search.
template <class T>
struct PixelPrediction {
  LandmarkId id = kNoLandmark;
  int slot = -1;                          ///< the filter's own index, valid until the map changes
  Vector2<T> pixel = Vector2<T>::Zero();  ///< predicted pixel
  Matrix2<T> covariance = Matrix2<T>::Zero();  ///< innovation covariance S = H P H^T + R, px^2
  Vector3<T> p_camera = Vector3<T>::Zero();  ///< expected point, camera frame, m (direction if far)
};

/// A landmark found in the image.
template <class T>
struct PixelMatch {
  LandmarkId id = kNoLandmark;
  int slot = -1;
  Vector2<T> pixel = Vector2<T>::Zero();  ///< measured pixel
  int descriptor_distance = 0;            ///< Hamming distance of the match, 0..512
  bool inlier = false;                    ///< set by the update: used by the filter
};

/// What an update did.
struct UpdateReport {
  int matches = 0;
  int hypotheses = 0;       ///< RANSAC hypotheses of one match evaluated
  int triples = 0;          ///< and of three matches
  int low_innovation = 0;   ///< inliers of the best hypothesis, first partial update
  int high_innovation = 0;  ///< rescued, second partial update
  int gated = 0;            ///< rejected by the gate
  float nis = 0.0F;         ///< normalised innovation squared of the used matches, summed
  int nis_dof = 0;
};

/// Counts a further update of the same frame in.
inline void add(const UpdateReport& update, UpdateReport& total) {
  total.matches += update.matches;
  total.hypotheses += update.hypotheses;
  total.triples += update.triples;
  total.low_innovation += update.low_innovation;
  total.high_innovation += update.high_innovation;
  total.gated += update.gated;
  total.nis += update.nis;
  total.nis_dof += update.nis_dof;
}

}  // namespace cairn
