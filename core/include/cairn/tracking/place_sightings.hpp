#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/geometry/pose_ransac.hpp"
#include "cairn/geometry/pose_refinement.hpp"
#include "cairn/tracking/window_archive.hpp"

namespace cairn {

/// What images show of a place: the landmarks of a WindowArchive that a camera at a pose should see
/// are sought by their templates, and the pose is moved to where most of them agree.
template <class Config>
class PlaceSightings {
 public:
  using Archive = WindowArchive<Config>;
  using Library = typename Archive::Library;
  using Features = typename Archive::Features;
  static constexpr int kMaxSought = 60;  ///< landmarks that are sought to confirm a place

  /// A landmark of the library that an image shows, and where.
  struct Seen {
    int slot = -1;
    Vector2<float> pixel = Vector2<float>::Zero();
  };
  /// What an image shows of a place.
  struct Place {
    Rigid<float> T_map_camera;
    Matrix<float, 6, 6> covariance = Matrix<float, 6, 6>::Zero();
    FixedVector<Seen, kMaxSought> seen;
    int sought = 0;
  };

  struct Parameters {
    int narrow_radius_px = 3;  ///< in the shrunk image, once the landmarks agreed on a pose
    int least_q15 = 19661;     ///< correlation in the shrunk image, 0.6
    float inlier_px = 6.0F;
    float chance_share = 0.3F;      ///< of the landmarks sought, that a wrong pose may find too
    float position_sigma = 0.015F;  ///< of the pose, at most, relative to the landmarks' distance

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = narrow_radius_px >= 1 && narrow_radius_px <= kMaxSearchRadius &&
                        least_q15 >= 0 && least_q15 <= 1 << 15 && is_positive(inlier_px) &&
                        chance_share >= 0.0F && chance_share < 1.0F && is_positive(position_sigma);
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  const Place& place() const { return place_; }
  /// The pose at which landmarks are sought next.
  void move_to(const Rigid<float>& T_map_camera) { place_.T_map_camera = T_map_camera; }

  /// Landmarks that a camera at the place's pose should see, `most` at most and spread over the
  /// library, are sought at most `radius` from where they should be. Cost: seek_work().
  void seek(FrameContext& frame, const Features& features, const Archive& archive,
            const Parameters& parameters, int radius, int most);
  static int seek_work(int radius, int most) {
    return kVisit / 2 + most * work::warped_search(radius);
  }

  /// Seeks twice, first within `radius`, and moves the pose to where most landmarks agree. How many
  /// more do than a wrong pose finds. Cost: look_work().
  float look(FrameContext& frame, const Features& features, const Archive& archive,
             const Parameters& parameters, int radius);
  static int look_work(int radius) {
    return kVisit + 2 * refinement_work(kMaxSought) + kWidelySought * work::warped_search(radius) +
           kMaxSought * work::warped_search(3);
  }
  /// After look(): whether the landmarks determine where the camera is. Those that are close
  /// together, or in a plane, leave it free to move about them.
  bool pose_is_sure(const Library& library, const Parameters& parameters) const;

  /// What was seen, as observations for P3P and refinement; they hold until the next call of
  /// observe() or look().
  void observe(const Library& library);
  const PoseObservation<float>* observations() const { return observations_; }
  /// Units that refine_pose() takes with so many observations.
  static int refinement_work(int count) { return work::kRefinement * count / 24; }

 private:
  static constexpr int kWidelySought = 24;  ///< of kMaxSought, before they agree on a pose
  static constexpr int kVisit = Archive::LibraryConfig::kLibraryLandmarks * work::kLibrarySlot;

  bool refine(FrameContext& frame, const Library& library, float inlier_px);

  Place place_;
  PoseObservation<float> observations_[kMaxSought];
  std::uint8_t inlier_[kMaxSought];
};

template <class Config>
void PlaceSightings<Config>::seek(FrameContext& frame, const Features& features,
                                  const Archive& archive, const Parameters& parameters, int radius,
                                  int most) {
  constexpr int kStride = 97;  // coprime to any library: what is left out is spread
  const int size = archive.library().size();
  place_.seen.clear();
  place_.sought = 0;
  frame.work.spend(size * work::kLibrarySlot / 2);
  for (int i = 0; i < size && place_.sought < most; ++i) {
    Seen seen;
    seen.slot = (i * kStride) % size;
    Vector2<float> expected;
    if (!archive.expected_pixel(frame.camera, seen.slot, place_.T_map_camera, expected)) continue;
    ++place_.sought;
    frame.work.spend(work::warped_search(radius));
    if (archive.find(frame, features, seen.slot, place_.T_map_camera, expected, radius,
                     parameters.least_q15, seen.pixel)) {
      static_cast<void>(place_.seen.push_back(seen));
    }
  }
}

template <class Config>
float PlaceSightings<Config>::look(FrameContext& frame, const Features& features,
                                   const Archive& archive, const Parameters& parameters,
                                   int radius) {
  constexpr float kNone = -1e6F;
  seek(frame, features, archive, parameters, radius, kWidelySought);
  if (!refine(frame, archive.library(), parameters.inlier_px)) return kNone;
  seek(frame, features, archive, parameters, parameters.narrow_radius_px, kMaxSought);
  if (!refine(frame, archive.library(), parameters.inlier_px)) return kNone;
  return static_cast<float>(place_.seen.size()) -
         parameters.chance_share * static_cast<float>(place_.sought);
}

template <class Config>
bool PlaceSightings<Config>::pose_is_sure(const Library& library,
                                          const Parameters& parameters) const {
  const Vector3<float>& centre = place_.T_map_camera.translation;
  float distances = 0.0F;
  for (const Seen& seen : place_.seen) {
    distances += sqrt((library[seen.slot].p_map - centre).squaredNorm());
  }
  const float mean = distances / static_cast<float>(place_.seen.size());
  return place_.covariance.template topLeftCorner<3, 3>().trace() <
         square(parameters.position_sigma * mean);
}

template <class Config>
void PlaceSightings<Config>::observe(const Library& library) {
  constexpr float kSigma_px = 2.0F;
  for (int i = 0; i < place_.seen.size(); ++i) {
    const Seen& seen = place_.seen[i];
    const auto& landmark = library[seen.slot];
    observations_[i] = {landmark.p_map, landmark.covariance, seen.pixel, kSigma_px};
  }
}

/// Keeps the inliers of what was seen.
template <class Config>
bool PlaceSightings<Config>::refine(FrameContext& frame, const Library& library, float inlier_px) {
  constexpr int kLeast = 6;
  FixedVector<Seen, kMaxSought>& seen = place_.seen;
  if (seen.size() < kLeast) return false;
  observe(library);
  PoseRefinementOptions<float> options;
  options.max_iterations = 10;
  options.min_inliers = kLeast;
  PoseEstimate<float> estimate;
  frame.work.spend(refinement_work(seen.size()));
  if (!ok(refine_pose(frame.camera, observations_, seen.size(), options, place_.T_map_camera,
                      estimate, inlier_))) {
    return false;
  }
  place_.covariance = estimate.covariance;
  const Rigid<float> T_camera_map = place_.T_map_camera.inverse();
  int kept = 0;
  for (int i = 0; i < seen.size(); ++i) {
    Vector2<float> pixel;
    if (inlier_[i] == 0 ||
        !ok(frame.camera.project(T_camera_map * library[seen[i].slot].p_map, pixel)) ||
        (pixel - seen[i].pixel).squaredNorm() > square(inlier_px)) {
      continue;
    }
    seen[kept++] = seen[i];
  }
  seen.resize(kept);
  return true;
}

}  // namespace cairn
