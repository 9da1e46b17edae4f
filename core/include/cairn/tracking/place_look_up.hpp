#pragma once

#include <cstdint>

#include "cairn/tracking/relocaliser.hpp"

namespace cairn {

/// Looks the place of a lost vehicle up in the map library, spread over frames: an image is taken;
/// then it is compared with what odometry lets expect, and every third image with the whole library
/// as well. A pose found is to be verified by the caller with the image of the next frame.
template <class Config>
class PlaceLookUp {
 public:
  using Places = Relocaliser<Config>;
  using Scratch = typename Places::Scratch;

  struct Parameters {
    int after_weak_frames = 5;    ///< the look-up begins
    int whole_library_every = 3;  ///< images: the others are compared near the prior alone
    int unknown_after = 8;        ///< looks at a place that the library does not have
    typename Places::Parameters places;
  };

  enum class Outcome : std::uint8_t {
    kWorking,
    kUnrecognised,  ///< the image shows nothing of the library
    kFoundNear,     ///< about where odometry has the vehicle
    kFound,         ///< somewhere in the library: refuse() where the vehicle cannot be
  };

  void reset() {
    looked_near_ = image_wanted_ = false;
    end();
  }
  /// The place is known again.
  void end() {
    places_.reset();
    captured_ = found_ = false;
    looks_ = 0;
    unrecognised_ = 0;
  }

  /// The library has been looked through often enough: the vehicle is somewhere else.
  bool unknown(const Parameters& parameters) const {
    return unrecognised_ >= parameters.unknown_after;
  }
  bool wanted(const Parameters& parameters, int weak_frames) const {
    return weak_frames >= parameters.after_weak_frames && !unknown(parameters);
  }
  /// Begins a frame. It will take an image, no two frames in a row, or verify what was found.
  void begin_frame(bool looking) {
    image_wanted_ = looking && (found_ || (!places_.working() && !captured_));
  }
  bool image_wanted() const { return image_wanted_; }
  bool working() const { return places_.working(); }
  /// The most units of work that look() takes next.
  int next_work(const Parameters& parameters) const {
    if (!places_.working()) return 0;
    return looked_near_ ? Places::step_work(parameters.places) : Places::near_work();
  }

  /// Whether this frame's image is to be taken, which `budget` must pay: capture() follows.
  bool takes_image(const ImageView& image, const WorkBudget& budget) {
    captured_ = image_wanted_ && budget.affords(Places::least_capture_work(image));
    return captured_;
  }
  /// Takes an image at the pose that odometry tells. `prior`: of the vehicle in the library.
  void capture(const ImageView& image, const Rigid<float>& T_world_camera, const PlanarPrior& prior,
               const Parameters& parameters, Scratch& scratch, WorkBudget& budget) {
    T_world_camera_ = T_world_camera;
    prior_ = prior;
    looked_near_ = false;
    static_cast<void>(places_.capture(image, parameters.places, scratch, budget));
  }

  /// One step with the image taken. Cost: next_work(), or nothing where `budget` does not pay it.
  template <class Library>
  Outcome look(const PlanarView& view, const Library& library, const Parameters& parameters,
               Random& random, Scratch& scratch, WorkBudget& budget) {
    captured_ = false;
    if (!looked_near_) return look_near(view, library, parameters, scratch, budget);
    if (!budget.affords(Places::step_work(parameters.places))) return Outcome::kWorking;
    switch (places_.step(view.camera, library, parameters.places, random, scratch, budget)) {
      case Places::Outcome::kFound:
        found_ = true;
        return Outcome::kFound;
      case Places::Outcome::kFailed:
        return Outcome::kUnrecognised;
      default:
        return Outcome::kWorking;
    }
  }

  /// Whether there is a pose to be verified; it is then given up.
  bool take_found() {
    const bool found = found_;
    found_ = false;
    return found;
  }
  /// Of the image taken: the pose found, in the library's coordinates, and odometry's.
  const Rigid<float>& T_map_camera() const { return places_.T_map_camera(); }
  const Rigid<float>& T_world_camera() const { return T_world_camera_; }

  /// The image shows a place of the map where the vehicle cannot be: nothing new is to be mapped
  /// there for a while.
  void refuse(const Parameters& parameters) {
    found_ = false;
    unrecognised_ = -4 * parameters.unknown_after;
  }
  /// The image shows nothing of the library, and the library has nothing to show here.
  void note_unknown() { ++unrecognised_; }

 private:
  template <class Library>
  Outcome look_near(const PlanarView& view, const Library& library, const Parameters& parameters,
                    Scratch& scratch, WorkBudget& budget) {
    if (!budget.affords(Places::near_work())) return Outcome::kWorking;
    budget.spend(Places::near_work());
    looked_near_ = true;
    found_ = places_.look_near(view, prior_, library, parameters.places, scratch);
    if (found_) return Outcome::kFoundNear;
    if (++looks_ % parameters.whole_library_every == 0) return Outcome::kWorking;
    places_.reset();
    return Outcome::kUnrecognised;
  }

  Places places_;
  Rigid<float> T_world_camera_;
  PlanarPrior prior_;  ///< in the library's coordinates
  bool looked_near_ = false;
  bool image_wanted_ = false;  ///< in this frame: no landmark is searched
  bool captured_ = false;      ///< by the last frame that looked for its place
  bool found_ = false;         ///< to be verified
  int looks_ = 0;              ///< since tracking was lost
  int unrecognised_ = 0;
};

}  // namespace cairn
