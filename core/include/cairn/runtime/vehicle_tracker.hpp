#pragma once

#include "cairn/map/map_builder.hpp"
#include "cairn/runtime/frame_tracker.hpp"

namespace cairn {

/// Paper A's two modules on one thread: FrameTracker on every frame, then a bounded slice of
/// MapBuilder. The same input gives the same bytes. For two threads or tasks use the two modules
/// and a SharedMap themselves (docs/how-to/rtos.md).
template <class Config, class Filter>
class VehicleTracker {
 public:
  using Frames = FrameTracker<Config, Filter>;
  using Map = SharedMap<Config>;
  using Library = typename Map::Library;
  using Supply = typename Frames::Supply;
  using Start = typename Frames::Start;
  using Parameters = typename Frames::Parameters;
  static constexpr int kMaxLandmarks = Frames::kMaxLandmarks;

  /// Map builder messages handled after a frame. The ring holds twice as many; a frame that
  /// archives or finds more landmarks than fit drops the rest, and counts them.
  static constexpr int kMessagesPerFrame = 8;

  /// Starts anew at a known pose, with the library as it is. Errors: as FrameTracker::initialise().
  Status initialise(const PinholeCamera<float>& camera, const Rigid<float>& T_vehicle_camera,
                    const Start& start, const Parameters& parameters) {
    const Status status = frames_.initialise(camera, T_vehicle_camera, start, parameters);
    if (ok(status)) frames_.reserve_ids(library_ids_);
    return status;
  }

  /// As FrameTracker::add_odometry().
  Status add_odometry(const OdometrySample& sample) { return frames_.add_odometry(sample); }

  /// As FrameTracker::set_work_limit().
  Status set_work_limit(int units) { return frames_.set_work_limit(units); }

  /// As FrameTracker::process_frame(), then a slice of the map builder's work.
  Status process_frame(const ImageView& image, std::int64_t t_us, const TickSource& ticks,
                       FrameReport& report) {
    const Status status = frames_.process_frame(image, t_us, ticks, map_, report);
    const std::uint32_t tracked = ticks.now();
    builder_.run(map_, kMessagesPerFrame);
    report.stage_ticks[static_cast<int>(Stage::kPoseUpdate)] += ticks.now() - tracked;
    return status;
  }

  /// Takes a saved library in place of the present one. Errors: as MapBuilder::load(), with nothing
  /// changed.
  Status load_map(const ByteSource& source, MapFileInfo& info) {
    const Status status = builder_.load(map_, source, info);
    if (!ok(status)) return status;
    library_ids_ = info.next_id;
    frames_.reserve_ids(info.next_id);
    return status;
  }
  /// Errors: as MapBuilder::save().
  Status save_map(const ByteSink& sink) { return builder_.save(map_, frames_.next_id(), sink); }

  const Frames& frames() const { return frames_; }
  const Filter& filter() const { return frames_.filter(); }
  const PinholeCamera<float>& camera() const { return frames_.camera(); }
  const Rigid<float>& T_vehicle_camera() const { return frames_.T_vehicle_camera(); }
  /// As FrameTracker::pose_covariance().
  Matrix3<float> pose_covariance() const { return frames_.pose_covariance(); }
  /// As FrameTracker::map_pose_covariance().
  Matrix3<float> map_pose_covariance() const { return frames_.map_pose_covariance(); }
  /// As FrameTracker::covariance_in_map().
  Matrix3<float> covariance_in_map() const { return frames_.covariance_in_map(); }
  /// In the filter's frame.
  Rigid<float> T_world_camera() const { return frames_.T_world_camera(); }
  /// The map's frame in the filter's, as FrameTracker::T_world_map().
  Rigid<float> T_world_map() const { return frames_.T_world_map(); }
  /// The vehicle on the floor of the map.
  Rigid<float> T_map_vehicle() const { return frames_.T_map_vehicle(); }
  /// As FrameTracker::mount_offset().
  const MountOffset& mount_offset() const { return frames_.mount_offset(); }
  /// As FrameTracker::ground().
  const GroundCheck& ground() const { return frames_.ground(); }
  /// As FrameTracker::yaw().
  const YawCheck& yaw() const { return frames_.yaw(); }
  Health health() const { return frames_.health(); }
  /// Admissions, replacements and refusals of the library.
  const Health& library_health() const { return builder_.health(); }
  TrackingState state() const { return frames_.state(); }
  /// The library as it is between two frames.
  const Library& library() const { return map_.exchange.front(); }
  void hash(Hash64& hash) const {
    frames_.hash(hash);
    const Library& library = map_.exchange.front();
    hash.add(static_cast<std::int32_t>(library.size()));
    hash.add(library.revision());
    hash.add(builder_.health().landmarks_replaced);
  }

 private:
  Frames frames_;
  Map map_;
  MapBuilder<Config> builder_;
  LandmarkId library_ids_ = 1;
};

}  // namespace cairn
