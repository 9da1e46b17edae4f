#pragma once

#include <cstdint>

#include "cairn/tracking/relocaliser.hpp"

namespace cairn {

/// Relocalisation of a vehicle in the map library, spread over frames: one frame's image is
/// captured; the next ones compare it with the landmarks expected near odometry's pose, and every
/// third image with the whole library as well. The caller verifies a pose found with the image of
/// the frame after.
template <class Config>
class VehicleRelocalisation {
 public:
  using Engine = Relocaliser<Config>;
  using Scratch = typename Engine::Scratch;

  struct Parameters {
    int after_weak_frames = 5;    ///< it begins
    int whole_library_every = 3;  ///< images: the others are compared near the prior alone
    int unknown_after = 8;        ///< unrecognised images where the library shows nothing
    typename Engine::Parameters engine;

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = after_weak_frames >= 1 && whole_library_every >= 1 && unknown_after >= 1 &&
                        unknown_after <= 1000000 && ok(engine.validate());
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  enum class Outcome : std::uint8_t {
    kWorking,
    kUnrecognised,  ///< nothing of the library was recognised in the image
    kFoundNear,     ///< near odometry's pose
    kFound,         ///< somewhere in the library: refuse() where the vehicle cannot be
  };

  void reset(const Parameters& parameters) {
    parameters_ = parameters;
    compared_near_ = image_wanted_ = false;
    end();
  }
  /// The pose is known again.
  void end() {
    engine_.reset();
    captured_ = found_ = false;
    looks_ = 0;
    unrecognised_ = 0;
  }

  /// Whether an image was compared since the pose was last known, and nothing recognised in it.
  bool looked() const { return looks_ > 0; }
  /// Enough images were compared: the vehicle is at a place that the library does not have.
  bool unknown() const { return unrecognised_ >= parameters_.unknown_after; }
  bool wanted(int weak_frames) const {
    return weak_frames >= parameters_.after_weak_frames && !unknown();
  }
  /// Begins a frame. It captures or verifies with its image, never in two frames in a row.
  void begin_frame(bool active) {
    image_wanted_ = active && (found_ || (!engine_.working() && !captured_));
  }
  bool image_wanted() const { return image_wanted_; }
  bool working() const { return engine_.working(); }
  /// The most units of work that step() takes next.
  int next_work() const {
    if (!engine_.working()) return 0;
    return compared_near_ ? Engine::step_work(parameters_.engine) : Engine::near_work();
  }

  /// Whether this frame's image is to be captured and `budget` pays for it: capture() follows.
  bool takes_image(const ImageView& image, const WorkBudget& budget) {
    captured_ = image_wanted_ && budget.affords(Engine::least_capture_work(image));
    return captured_;
  }
  /// Captures an image taken at odometry's pose. `prior`: the vehicle's pose in the map.
  void capture(const ImageView& image, const Rigid<float>& T_world_camera, const PlanarPrior& prior,
               Scratch& scratch, WorkBudget& budget) {
    T_world_camera_ = T_world_camera;
    prior_ = prior;
    compared_near_ = false;
    static_cast<void>(engine_.capture(image, parameters_.engine, scratch, budget));
  }

  /// One step with the captured image, `live` the landmarks of the filter that count too. Cost:
  /// next_work(), or nothing where `budget` does not afford it.
  template <class Library, class Live>
  Outcome step(const PlanarView& view, const Library& library, const Live& live, Random& random,
               Scratch& scratch, WorkBudget& budget) {
    captured_ = false;
    if (!compared_near_) return compare_near(view, library, live, scratch, budget);
    if (!budget.affords(Engine::step_work(parameters_.engine))) return Outcome::kWorking;
    switch (engine_.step(view.camera, library, parameters_.engine, random, scratch, budget)) {
      case Engine::Outcome::kFound:
        found_ = true;
        return Outcome::kFound;
      case Engine::Outcome::kFailed:
        return Outcome::kUnrecognised;
      default:
        return Outcome::kWorking;
    }
  }

  /// Whether there is a pose to be verified; true once for each.
  bool take_found() {
    const bool found = found_;
    found_ = false;
    return found;
  }
  /// Of the captured image: the pose found, and odometry's.
  const Rigid<float>& T_map_camera() const { return engine_.T_map_camera(); }
  const Rigid<float>& T_world_camera() const { return T_world_camera_; }

  /// The image shows a place of the map where the vehicle cannot be. Since the map has something
  /// like it, the place counts as unknown only after more images.
  void refuse() {
    found_ = false;
    unrecognised_ = -4 * parameters_.unknown_after;
  }
  /// The image was not recognised, and the library has no landmarks to be seen here.
  void note_unknown() { ++unrecognised_; }

 private:
  template <class Library, class Live>
  Outcome compare_near(const PlanarView& view, const Library& library, const Live& live,
                       Scratch& scratch, WorkBudget& budget) {
    if (!budget.affords(Engine::near_work())) return Outcome::kWorking;
    budget.spend(Engine::near_work());
    compared_near_ = true;
    found_ = engine_.find_near(view, prior_, library, live, parameters_.engine, scratch);
    if (found_) return Outcome::kFoundNear;
    if (++looks_ % parameters_.whole_library_every == 0) return Outcome::kWorking;
    engine_.reset();
    return Outcome::kUnrecognised;
  }

  Parameters parameters_;
  Engine engine_;
  Rigid<float> T_world_camera_;
  PlanarPrior prior_;  ///< in the map
  bool compared_near_ = false;
  bool image_wanted_ = false;  ///< in this frame: no landmark is searched
  bool captured_ = false;      ///< by the last frame that relocalised
  bool found_ = false;         ///< a pose waits to be verified
  int looks_ = 0;              ///< images compared since tracking was lost
  int unrecognised_ = 0;
};

}  // namespace cairn
