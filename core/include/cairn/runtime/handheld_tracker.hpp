#pragma once

#include <cstdint>

#include "cairn/base/config.hpp"
#include "cairn/base/hash.hpp"
#include "cairn/tracking/frame_input.hpp"
#include "cairn/tracking/handheld_local_map.hpp"
#include "cairn/tracking/handheld_map_reuse.hpp"
#include "cairn/tracking/handheld_rotation.hpp"
#include "cairn/tracking/motion_noise.hpp"
#include "cairn/tracking/repeated_image.hpp"
#include "cairn/tracking/stage_timer.hpp"
#include "cairn/tracking/start_trial.hpp"

namespace cairn {

/// Camera tracking from video alone (paper B): MonoEkf behind the vision front end. The world is
/// the camera of the first frame; lengths are in the filter's own unit (its initial inverse depth
/// is 1 / unit). Each frame: predict the pose, by what turned the whole picture where that is more
/// than the filter's motion explains, measure the features that it expects in view, update
/// the filter with the matches, judge whether the pose holds, keep the map, report.
///
/// Landmarks that are well known are archived in a library. Where nothing of the filter's map is
/// seen for a while the tracker is lost: it keeps its last pose, draws nothing and relocalises in
/// the library. It tracks again once a pose was recognised, confirmed in the frame after, and
/// followed for some frames. It never goes on from a guess: with next to nothing in the library the
/// map begins anew.
///
/// All storage is inside; the caller decides where an instance lies. One frame costs at most
/// `max_searches` landmark searches, two filter updates of as many matches together, and
/// `cells_per_frame` cells of corner detection; while lost, steps of the relocaliser or two
/// searches of 24 library landmarks. All of it stays within set_work_limit(): the pose comes first,
/// then the map.
template <class Config>
class HandheldTracker {
 public:
  static constexpr int kMaxFeatures = Config::kMaxFeatures;
  using Estimate = HandheldEstimate<kMaxFeatures>;
  using Filter = typename Estimate::Filter;
  using Measurement = LandmarkMeasurement<kMaxFeatures>;
  using LocalMap = HandheldLocalMap<Config>;
  using MapReuse = HandheldMapReuse<Config>;
  using Supply = typename LocalMap::Supply;
  using Library = typename MapReuse::Library;

  /// Landmarks are found by their patches, and a pixel's standard deviation is 0.7
  /// (docs/results/handheld-mono.md has the comparison).
  struct Parameters {
    Parameters() {
      measurement.search.method = SearchMethod::kPatch;
      filter.sigma_px = 0.7F;
      filter.max_triples = 16;
      monitor.min_inliers = 6;
      monitor.uncertain_s_to_lost = 0.34F;
      monitor.min_match_ratio = 0.0F;
      monitor.probation_frames = 10;
    }
    typename Filter::Parameters filter;
    typename Measurement::Parameters measurement;
    TrackingMonitor::Parameters monitor;
    typename LocalMap::Parameters local_map;
    StartTrial::Parameters start;
    MotionNoise::Parameters motion;  ///< in place of the filter's own noises
    HandheldRotation::Parameters rotation;
    typename MapReuse::Parameters map_reuse;
    int work_limit = 11600;              ///< units of WorkBudget a frame, drawing apart
    int max_frames_without_mapping = 8;  ///< then mapping gets half of a frame's work
    std::int64_t max_step_us = 500000;   ///< a longer gap is not integrated
    std::uint64_t seed = 1;

    /// kBadConfig unless every value is finite and in its domain; those of the filter it checks
    /// itself.
    Status validate() const {
      const bool parts = ok(measurement.validate()) && ok(monitor.validate()) &&
                         ok(local_map.validate()) && ok(start.validate()) &&
                         ok(motion.validate()) && ok(rotation.validate()) &&
                         ok(map_reuse.validate());
      const bool good = parts && work_limit >= 0 && max_frames_without_mapping >= 0 &&
                        max_step_us > 0 && max_step_us <= FrameInput::kLongestStepUs;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  /// Starts anew. kBadConfig for an impossible camera or parameters; the tracker is then unchanged.
  Status initialise(const PinholeCamera<float>& camera, const Parameters& parameters);

  /// Tracks one frame. kInvalidArgument (wrong size), kDuplicate, kTimeBackwards, and kTimeGap for
  /// a stamp that InputClock does not believe: frame refused, `report` and tracker unchanged but
  /// for the counters. Otherwise report.status is kOk, kLowTexture,
  /// kNoConsensus, kTimeGap or kLost, and the pose is the filter's best; or kRepeatedImage: the
  /// picture has the bytes of the one before, whose pose is reported again, as uncertain, and the
  /// motion up to the next new picture counts from that one.
  Status process_frame(const ImageView& image, std::int64_t t_us, const TickSource& ticks,
                       FrameReport& report);

  /// Units of work that each frame may take from now on (FrameCut says what it left out for it). An
  /// input like any other: logs record it. kInvalidArgument for a negative one.
  Status set_work_limit(int units) { return work_.set_limit(units); }

  /// Takes a saved library in place of the present one. The camera's place in it is not known: the
  /// tracker is lost until it recognises it. kNotInitialised; otherwise as cairn::load_map(), with
  /// nothing changed but where the source gives other bytes the second time: the library is then
  /// empty.
  Status load_map(const ByteSource& source, MapFileInfo& info);
  /// Errors: as cairn::save_map().
  Status save_map(const ByteSink& sink) const {
    return cairn::save_map(library(), estimate_.next_id(), sink);
  }

  const Filter& filter() const { return estimate_.filter(); }
  const PinholeCamera<float>& camera() const { return camera_; }
  /// Of the tracker and of its filter.
  Health health() const { return with_filter(health_, filter().health()); }
  /// Admissions, replacements and refusals of the library.
  const Health& library_health() const { return map_reuse_.archive().health(); }
  const Library& library() const { return map_reuse_.archive().library(); }
  TrackingState state() const { return monitor_.state(); }
  void hash(Hash64& hash) const;

 private:
  using Frame = HandheldFrame<Config>;
  /// A slow camera is no jump of the clock: a stamp is in order within so many largest steps.
  static constexpr int kStepsOfClock = 4;

  Status track(Frame& frame, const FrameStep& step, StageTimer& timer);
  Status predict(Frame& frame, const FrameStep& step);
  Status pass_over();
  void note_motion(std::int64_t step_us);
  void measure(Frame& frame, SearchPass pass);
  Status update(Frame& frame, int first, Status status);
  void measure_rest(Frame& frame);
  void note_matches(Frame& frame, int first);
  void keep_map(Frame& frame);
  bool start_failed();
  Status relocalise(Frame& frame);
  void begin_anew(Frame& frame);
  void report(Status status, FrameReport& report);

  PinholeCamera<float> camera_;
  Estimate estimate_;
  Measurement measurement_;
  TrackingMonitor monitor_;
  LocalMap local_map_;
  StartTrial start_;
  MotionNoise motion_;
  HandheldRotation rotation_;
  MapReuse map_reuse_;
  FrameInput input_;
  RepeatedImage repeated_;
  InputClock clock_;
  FrameWork work_;
  Random random_;
  Health health_;
  HandheldScratch<Config> scratch_;
};

}  // namespace cairn

#include "cairn/runtime/detail/handheld_tracker_impl.hpp"
