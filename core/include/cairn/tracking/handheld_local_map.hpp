#pragma once

#include "cairn/tracking/handheld_estimate.hpp"
#include "cairn/tracking/handheld_frame.hpp"

namespace cairn {

/// Keeps the features of a hand-held filter: new ones at corners in empty parts of the image, with
/// the filter's prior of the inverse depth, and the removal of those that are not found again or
/// have left the view.
template <class Config>
class HandheldLocalMap {
 public:
  using Supply = FeatureSupply<Config::kMaxImageWidth>;
  using Estimate = HandheldEstimate<Config::kMaxFeatures>;
  using Frame = HandheldFrame<Config>;

  struct Parameters {
    typename Supply::Parameters supply;
    int target_features = Config::kMaxFeatures;  ///< kept measured per frame
    int max_new_features_per_frame = 6;
    int max_weak_frames = 3;           ///< in a row, in which features still begin
    int min_sightings_to_archive = 6;  ///< of a feature that leaves the filter

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = ok(supply.validate()) && target_features >= 1 &&
                        max_new_features_per_frame >= 0 && max_weak_frames >= 0 &&
                        min_sightings_to_archive >= 1;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    parameters_ = parameters;
    supply_ = Supply{};
  }
  void begin_frame(const ImageView& image) { supply_.begin(image.width, image.height); }
  const Parameters& parameters() const { return parameters_; }

  /// Removes the features that are rarely found or gone. Those gone that were seen often enough go
  /// to archive(slot, landmark) first.
  template <class Archive>
  void remove_unreliable(Frame& frame, Estimate& estimate, Archive archive);

  /// Adds features. Returns how many. Cost: cells_per_frame cells of corner detection.
  int add_features(Frame& frame, Estimate& estimate);

 private:
  bool add_feature(Frame& frame, Estimate& estimate, const Corner& corner,
                   const Rigid<float>& T_world_camera);

  Parameters parameters_;
  Supply supply_;
};

template <class Config>
template <class Archive>
void HandheldLocalMap<Config>::remove_unreliable(Frame& frame, Estimate& estimate,
                                                 Archive archive) {
  for (int slot = estimate.size() - 1; slot >= 0; --slot) {
    TrackedLandmark* landmark = estimate.landmarks().find(estimate.id(slot));
    const bool unknown = landmark == nullptr;
    const bool rarely_found =
        !unknown && landmark->predicted >= 5 && 2 * landmark->measured < landmark->predicted;
    const bool gone = !unknown && (landmark->frames_out_of_view > 10 || landmark->misses > 10);
    if (!unknown && !rarely_found && !gone) continue;
    if (!frame.work.take(work::kRemoval)) return;
    if (gone && landmark->measured >= parameters_.min_sightings_to_archive) {
      archive(slot, *landmark);
    }
    static_cast<void>(estimate.remove(frame, slot));
  }
}

template <class Config>
int HandheldLocalMap<Config>::add_features(Frame& frame, Estimate& estimate) {
  for (int slot = 0; slot < estimate.size(); ++slot) {
    PixelPrediction<float> prediction;
    if (ok(estimate.predict(slot, prediction))) {
      supply_.occupy(prediction.pixel.x(), prediction.pixel.y());
    }
  }
  const int room = parameters_.target_features - estimate.size();
  const int most = parameters_.max_new_features_per_frame;
  const int limit = room < most ? room : most;
  if (limit <= 0) return 0;
  if (!frame.work.affords(supply_.cell_work())) frame.work.cut_mapping();
  Corner corners[Supply::kCells];
  const int found =
      propose_corners(frame, supply_, parameters_.supply, limit, frame.scratch.supply, corners);
  const Rigid<float> T_world_camera = estimate.T_world_camera();
  int added = 0;
  for (int i = 0; i < found && frame.work.take(work::kAppearance + work::kFeatureInitialisation);
       ++i) {
    added += add_feature(frame, estimate, corners[i], T_world_camera) ? 1 : 0;
  }
  return added;
}

template <class Config>
bool HandheldLocalMap<Config>::add_feature(Frame& frame, Estimate& estimate, const Corner& corner,
                                           const Rigid<float>& T_world_camera) {
  TrackedLandmark landmark;
  landmark.id = estimate.next_id();
  if (!ok(make_appearance(frame.image, corner.x, corner.y, T_world_camera, landmark.appearance))) {
    return false;
  }
  const Vector2<float> pixel(static_cast<float>(corner.x), static_cast<float>(corner.y));
  if (!ok(estimate.filter().add_feature(landmark.id, pixel))) {
    ++frame.health.landmarks_refused;
    return false;
  }
  estimate.landmarks().add(landmark);
  ++estimate.next_id();
  ++frame.report.added;
  ++frame.health.landmarks_added;
  return true;
}

}  // namespace cairn
