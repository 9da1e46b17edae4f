#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/tracking/active_search.hpp"
#include "cairn/tracking/appearance.hpp"
#include "cairn/tracking/candidate_filter.hpp"

namespace cairn {

/// A point that is followed from frame to frame until its depth is known well enough to become a
/// landmark (delayed initialisation).
struct Candidate {
  Appearance appearance;     ///< first view, at its keyframe
  Vector3<float> first_ray;  ///< (x, y, 1) in the first camera
  Vector2<float> pixel;      ///< last measured
  float rho = 0.0F;          ///< 1 / depth (z) in the first camera, 1/m
  int keyframe = 0;          ///< slot of the first frame
  int seen = 1;
  int misses = 0;
};

/// A candidate whose depth is known, in units of the way that the caller's poses made.
struct Promotion {
  Appearance appearance;        ///< T_world_reference: the first camera in the pool's own world
  Rigid<float> T_camera_first;  ///< first camera as seen from the current one
  Vector3<float> ray;           ///< (x, y, 1) in the current camera
  float depth_m = 0.0F;         ///< z in the current camera, if T_camera_first has the right length
  float sigma_depth_m = 0.0F;   ///< of it, from the pixels alone
  Vector2<float> pixel;
  LandmarkId keyframe = kNoLandmark;
};

/// Bounded pool of candidates with a visual odometry of its own: the camera's motion comes from the
/// caller's poses, its rotation and the candidates' depths are corrected together by a
/// CandidateFilter. So it works while the map is still empty and the heading only as good as the
/// odometry. Candidates begin at keyframes, which the caller names and keeps in its own state.
/// Cost per frame: at most 4 patch alignments and one filter update a candidate.
template <int MaxCandidates, int MaxKeyframes>
class CandidatePool {
 public:
  struct Parameters {
    float initial_depth_m = 4.0F;
    float initial_sigma_rho = 0.25F;  ///< 1/m: everything beyond about 1.3 m within 2 sigma
    float sigma_px = 0.3F;
    float promote_relative_sigma = 0.12F;  ///< sigma(rho) / rho
    float min_depth_m = 0.5F;
    float max_depth_m = 25.0F;
    float depth_inflation = 1.5F;   ///< of the depth's sigma at promotion
    float sigma_yaw_rad = 0.002F;   ///< of the caller's rotation since the frame before
    float sigma_pitch_rad = 1e-4F;  ///< same, about the camera's x axis
    float gate = 9.21F;
    float search_step_px = 2.5F;  ///< sideways starts tried when few candidates are found
    int min_views = 6;
    int max_views = 150;
    int max_misses = 2;
    int min_correlation_q10 = 768;
    SearchParameters search;
  };

  int size() const { return candidates_.size(); }
  bool full() const { return candidates_.full(); }
  const Candidate& operator[](int i) const { return candidates_[i]; }
  void clear() {
    candidates_.clear();
    for (Keyframe& keyframe : keyframes_) keyframe.id = kNoLandmark;
    filter_.clear();
    has_pose_ = false;
  }

  /// Makes the frame last given to follow() a keyframe, at which candidates can begin.
  /// kNotInitialised (no frame yet), kFull (see oldest_keyframe), kInvalidArgument (id 0).
  Status begin_keyframe(LandmarkId id) {
    if (!has_pose_) return Status::kNotInitialised;
    if (id == kNoLandmark) return Status::kInvalidArgument;
    const int slot = find_keyframe(kNoLandmark);
    if (slot < 0) return Status::kFull;
    keyframes_[slot] = {id, T_pool_camera_};
    filter_.begin_keyframe(slot);
    return Status::kOk;
  }

  /// Starts following the corner at integer pixel (x, y) of the frame last given to follow(), which
  /// begin_keyframe() named `keyframe`. kFull, kOutOfView, kNotFound (no such keyframe).
  Status add(const ImageView& image, const PinholeCamera<float>& camera, int x, int y,
             LandmarkId keyframe, const Parameters& parameters) {
    const int slot = keyframe == kNoLandmark ? -1 : find_keyframe(keyframe);
    if (slot < 0) return Status::kNotFound;
    if (candidates_.full()) return Status::kFull;
    Candidate candidate;
    const Status status = make_appearance(image, x, y, T_pool_camera_, candidate.appearance);
    if (!ok(status)) return status;
    candidate.pixel = Vector2<float>(static_cast<float>(x), static_cast<float>(y));
    candidate.first_ray = camera.unproject(candidate.pixel);
    candidate.rho = 1.0F / parameters.initial_depth_m;
    candidate.keyframe = slot;
    filter_.begin_candidate(candidates_.size(), square(parameters.initial_sigma_rho));
    candidates_.push_back(candidate);
    return Status::kOk;
  }

  /// Most units of work that following the candidates there are takes without a search.
  int work_to_follow() const { return candidates_.size() * (work::kAlignment + kCorrectionWork); }

  /// Follows every candidate into `image`, taken at the caller's estimate `T_odometry_camera` (only
  /// its motion since the last call counts). Lost candidates are dropped, their number returned.
  /// Where `budget` does not afford work_to_follow(), as coast().
  int follow(const ImageView& image, const PinholeCamera<float>& camera,
             const Rigid<float>& T_odometry_camera, const Parameters& parameters,
             SearchScratch& scratch, WorkBudget& budget) {
    coast(T_odometry_camera, parameters);
    if (!budget.affords(work_to_follow())) return 0;
    budget.spend(candidates_.size() * kCorrectionWork);
    measure_all(image, camera, parameters, budget);
    search_missing(image, camera, parameters, scratch, budget);
    correct(camera, parameters);
    return drop_lost(parameters);
  }

  /// Goes on to the caller's estimate without a look at the image: no candidate is lost for it.
  void coast(const Rigid<float>& T_odometry_camera, const Parameters& parameters) {
    if (has_pose_) {
      T_pool_camera_ = T_pool_camera_ * (T_odometry_last_.inverse() * T_odometry_camera);
      filter_.predict(parameters.sigma_pitch_rad, parameters.sigma_yaw_rad);
    }
    T_odometry_last_ = T_odometry_camera;
    has_pose_ = true;
  }

  /// Takes the next candidate that was seen in this frame and whose depth is known; false when
  /// there is none. Call until false.
  bool promote(const PinholeCamera<float>& camera, const Parameters& parameters,
               Promotion& promotion) {
    for (int i = candidates_.size() - 1; i >= 0; --i) {
      const Candidate& c = candidates_[i];
      if (c.misses > 0 || c.seen < parameters.min_views || !(c.rho > 0.0F)) continue;
      const float sigma = sqrt(filter_.variance(i));
      if (sigma > parameters.promote_relative_sigma * c.rho) continue;
      const float depth = 1.0F / c.rho;
      const bool usable = depth > parameters.min_depth_m && depth < parameters.max_depth_m;
      if (usable) fill(camera, parameters, i, promotion);
      remove(i);
      if (usable) return true;
    }
    return false;
  }

  bool has_keyframe(LandmarkId id) const { return find_keyframe(id) >= 0; }

  /// Forgets keyframes at which no candidate that is left began; where all are in use and
  /// `make_room` is set, also the one with the lowest id and its candidates. Their number.
  int end_keyframes(bool make_room) {
    bool used[MaxKeyframes] = {};
    for (const Candidate& c : candidates_) used[c.keyframe] = true;
    int oldest = 0;
    bool full = true;
    for (int k = 0; k < MaxKeyframes; ++k) {
      if (!used[k]) end_keyframe(k);
      full = full && used[k];
      if (keyframes_[k].id < keyframes_[oldest].id) oldest = k;
    }
    if (!full || !make_room) return 0;
    int dropped = 0;
    for (int i = candidates_.size() - 1; i >= 0; --i) {
      if (candidates_[i].keyframe != oldest) continue;
      remove(i);
      ++dropped;
    }
    end_keyframe(oldest);
    return dropped;
  }

 private:
  static constexpr int kCorrectionWork = 40;
  using Pixels = Vector2<float>[MaxCandidates];
  using Filter = CandidateFilter<MaxKeyframes, MaxCandidates>;

  struct Keyframe {
    LandmarkId id = kNoLandmark;
    Rigid<float> T_pool_camera;
  };

  struct Expected {
    Vector2<float> pixel;
    Vector3<float> p_camera;
    typename Filter::Residual residual;  ///< all but the measured pixel
  };

  int find_keyframe(LandmarkId id) const {
    for (int k = 0; k < MaxKeyframes; ++k) {
      if (keyframes_[k].id == id) return k;
    }
    return -1;
  }

  void end_keyframe(int k) {
    keyframes_[k].id = kNoLandmark;
    filter_.end_keyframe(k);
  }

  void remove(int i) {
    filter_.move_candidate(candidates_.size() - 1, i);
    if (i == candidates_.size() - 1) filter_.end_candidate(i);
    candidates_.remove_unordered(i);
  }

  Rigid<float> camera_from(const Candidate& c) const {
    return T_pool_camera_.inverse() * keyframes_[c.keyframe].T_pool_camera;
  }

  bool expect(const PinholeCamera<float>& camera, int i, Expected& expected) const {
    const Candidate& c = candidates_[i];
    const Rigid<float> T_camera_first = camera_from(c);
    const Vector3<float> scaled =
        T_camera_first.rotation * c.first_ray + c.rho * T_camera_first.translation;
    Matrix<float, 2, 3> jacobian;
    if (!ok(camera.project(scaled, expected.pixel, jacobian))) return false;
    const Matrix3<float> turn = skew(scaled);
    const Matrix3<float> rotation = T_camera_first.rotation.toRotationMatrix();
    const Matrix3<float> first_turn = rotation * skew(c.first_ray);
    expected.residual.slot = i;
    expected.residual.keyframe = c.keyframe;
    expected.residual.by_camera = jacobian * turn.template leftCols<2>();
    expected.residual.by_keyframe = -(jacobian * first_turn.template leftCols<2>());
    expected.residual.by_depth = jacobian * T_camera_first.translation;
    expected.p_camera = scaled * (1.0F / c.rho);
    return camera.contains(expected.pixel, 10.0F);
  }

  bool align(const ImageView& image, const PinholeCamera<float>& camera, const Candidate& c,
             const Expected& expected, const Vector2<float>& shift, const Parameters& parameters,
             Vector2<float>& pixel) const {
    Matrix2<float> warp;
    PatchWarp patch_warp;
    if (!ok(predict_warp(camera, keyframes_[c.keyframe].T_pool_camera, T_pool_camera_,
                         expected.p_camera, warp)) ||
        !to_patch_warp(warp, patch_warp)) {
      return false;
    }
    int x_q8 = round_to_int((expected.pixel.x() + shift.x()) * 256.0F);
    int y_q8 = round_to_int((expected.pixel.y() + shift.y()) * 256.0F);
    PatchAlignment alignment;
    if (!ok(align_patch(image, c.appearance.patch, patch_warp, x_q8, y_q8, alignment)) ||
        !alignment.converged || alignment.correlation < parameters.min_correlation_q10) {
      return false;
    }
    pixel = Vector2<float>(static_cast<float>(x_q8) / 256.0F, static_cast<float>(y_q8) / 256.0F);
    return true;
  }

  /// Candidates found when all are expected `shift` away from their prediction.
  int measure_shifted(const ImageView& image, const PinholeCamera<float>& camera,
                      const Vector2<float>& shift, const Parameters& parameters, bool* found,
                      Pixels& pixels) const {
    int count = 0;
    for (int i = 0; i < candidates_.size(); ++i) {
      Expected expected;
      found[i] = expect(camera, i, expected) &&
                 align(image, camera, candidates_[i], expected, shift, parameters, pixels[i]);
      count += found[i] ? 1 : 0;
    }
    return count;
  }

  void measure_all(const ImageView& image, const PinholeCamera<float>& camera,
                   const Parameters& parameters, WorkBudget& budget) {
    const int round_work = candidates_.size() * work::kAlignment;
    budget.spend(round_work);
    int best = measure_shifted(image, camera, Vector2<float>::Zero(), parameters, found_, pixels_);
    const float steps[] = {-parameters.search_step_px, parameters.search_step_px};
    for (const float step : steps) {
      if (10 * best >= 7 * candidates_.size() || !budget.affords(round_work)) return;
      budget.spend(round_work);
      bool found[MaxCandidates];
      Pixels pixels;
      const int count =
          measure_shifted(image, camera, Vector2<float>(step, 0.0F), parameters, found, pixels);
      if (count <= best) continue;
      best = count;
      for (int i = 0; i < candidates_.size(); ++i) {
        found_[i] = found[i];
        pixels_[i] = pixels[i];
      }
    }
  }

  /// Looks for the candidates that alignment did not find in the window of their unknown depth and
  /// rotation, by descriptor.
  void search_missing(const ImageView& image, const PinholeCamera<float>& camera,
                      const Parameters& parameters, SearchScratch& scratch, WorkBudget& budget) {
    for (int i = 0; i < candidates_.size(); ++i) {
      if (found_[i]) continue;
      if (!budget.affords(work::kLandmarkSearch)) return;
      const Candidate& c = candidates_[i];
      Expected expected;
      Matrix2<float> warp;
      if (!expect(camera, i, expected) ||
          !ok(predict_warp(camera, keyframes_[c.keyframe].T_pool_camera, T_pool_camera_,
                           expected.p_camera, warp))) {
        continue;
      }
      PixelPrediction<float> prediction;
      prediction.pixel = expected.pixel;
      prediction.covariance = filter_.innovation_covariance(expected.residual, parameters.sigma_px);
      prediction.p_camera = expected.p_camera;
      SearchReport report;
      found_[i] = ok(search_landmark(image, prediction, c.appearance, warp, parameters.search,
                                     scratch, pixels_[i], report));
      budget.spend(report.work);
    }
  }

  /// Corrects rotation, keyframes and depths. The turn of the camera is common to all residuals:
  /// those far from their median, for what is known of their depth, are left out.
  void correct(const PinholeCamera<float>& camera, const Parameters& parameters) {
    constexpr float kFarFromMedian = 3.0F;
    Vector2<float> median;
    if (!median_residual(camera, median)) return;
    typename Filter::Correction correction;
    for (int i = 0; i < candidates_.size(); ++i) {
      Expected expected;
      if (!found_[i]) continue;
      found_[i] = expect(camera, i, expected);
      if (!found_[i]) continue;
      expected.residual.pixel = pixels_[i] - expected.pixel;
      const Vector2<float> off = expected.residual.pixel - median;
      const Vector2<float>& slope = expected.residual.by_depth;
      const float allowed = kFarFromMedian + 3.0F * sqrt(filter_.variance(i) * slope.dot(slope));
      found_[i] =
          off.dot(off) <= square(allowed) &&
          filter_.update(expected.residual, parameters.sigma_px, parameters.gate, correction);
    }
    T_pool_camera_.rotation =
        (T_pool_camera_.rotation * rotation_exp(correction.camera())).normalized();
    for (int k = 0; k < MaxKeyframes; ++k) {
      if (keyframes_[k].id == kNoLandmark) continue;
      Quaternion<float>& rotation = keyframes_[k].T_pool_camera.rotation;
      rotation = (rotation * rotation_exp(correction.keyframe(k))).normalized();
    }
    const float smallest = 0.2F / parameters.max_depth_m;
    for (int i = 0; i < candidates_.size(); ++i) {
      Candidate& c = candidates_[i];
      c.rho += correction.depth(i);
      if (c.rho < smallest) c.rho = smallest;
    }
  }

  bool median_residual(const PinholeCamera<float>& camera, Vector2<float>& median) const {
    float u[MaxCandidates];
    float v[MaxCandidates];
    int count = 0;
    for (int i = 0; i < candidates_.size(); ++i) {
      Expected expected;
      if (!found_[i] || !expect(camera, i, expected)) continue;
      insert_sorted(u, count, pixels_[i].x() - expected.pixel.x());
      insert_sorted(v, count, pixels_[i].y() - expected.pixel.y());
      ++count;
    }
    if (count == 0) return false;
    median = Vector2<float>(u[count / 2], v[count / 2]);
    return true;
  }

  static void insert_sorted(float* values, int count, float value) {
    int k = count;
    for (; k > 0 && values[k - 1] > value; --k) values[k] = values[k - 1];
    values[k] = value;
  }

  int drop_lost(const Parameters& parameters) {
    int dropped = 0;
    for (int i = candidates_.size() - 1; i >= 0; --i) {
      Candidate& c = candidates_[i];
      if (found_[i]) {
        c.pixel = pixels_[i];
        ++c.seen;
        c.misses = 0;
      } else {
        ++c.misses;
      }
      if (c.misses > parameters.max_misses || c.seen + c.misses > parameters.max_views) {
        remove(i);
        ++dropped;
      }
    }
    return dropped;
  }

  void fill(const PinholeCamera<float>& camera, const Parameters& parameters, int i,
            Promotion& promotion) const {
    const Candidate& c = candidates_[i];
    promotion.appearance = c.appearance;
    promotion.T_camera_first = camera_from(c);
    promotion.ray = camera.unproject(c.pixel);
    promotion.depth_m = (promotion.T_camera_first * Vector3<float>(c.first_ray / c.rho)).z();
    promotion.sigma_depth_m =
        sqrt(filter_.variance(i)) * parameters.depth_inflation / square(c.rho);
    promotion.pixel = c.pixel;
    promotion.keyframe = keyframes_[c.keyframe].id;
  }

  FixedVector<Candidate, MaxCandidates> candidates_;
  bool found_[MaxCandidates] = {};  ///< this frame's measurements, by candidate
  Pixels pixels_;
  Keyframe keyframes_[MaxKeyframes];
  Filter filter_;
  Rigid<float> T_pool_camera_;
  Rigid<float> T_odometry_last_;
  bool has_pose_ = false;
};

}  // namespace cairn
