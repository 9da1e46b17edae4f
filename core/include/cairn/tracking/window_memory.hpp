#pragma once

#include "cairn/tracking/place_search.hpp"
#include "cairn/tracking/window_archive.hpp"
#include "cairn/tracking/window_map_reuse.hpp"

namespace cairn {

/// The long memory of a WindowTracker: landmarks whose depth is well known (WindowArchive), the
/// search of the camera's place among them (PlaceSearch), and their return to the window
/// (WindowMapReuse).
template <class Config>
class WindowMemory {
 public:
  using Archive = WindowArchive<Config>;
  using Search = PlaceSearch<Config>;
  using Reuse = WindowMapReuse<Config>;
  using Library = typename Archive::Library;
  using Features = typename Archive::Features;
  using Window = typename Features::Window;

  /// Those of the parts, each of which keeps its own.
  struct Parameters : Archive::Parameters, Reuse::Parameters, Search::Parameters {
    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = ok(Archive::Parameters::validate()) && ok(Reuse::Parameters::validate()) &&
                        ok(Search::Parameters::validate());
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    archive_.reset(parameters);
    search_.reset(parameters);
    reuse_.reset(parameters);
  }
  /// Forgets landmarks and views.
  void forget() {
    archive_.clear();
    search_.forget();
  }
  /// Recognition starts over.
  void begin() { search_.begin(); }

  const Library& library() const { return archive_.library(); }
  Library& library() { return archive_.library(); }
  const Health& health() const { return archive_.health(); }
  bool library_too_small() const { return reuse_.too_small(archive_); }

  /// As WindowArchive::renew_depth().
  void renew_depth(FrameContext& frame, const Window& window, const WindowFeature& feature,
                   float sigma) {
    archive_.renew_depth(frame, window, feature, sigma);
  }
  /// As WindowArchive::archive_due().
  void archive_due(FrameContext& frame, const Window& window, Features& features,
                   const Rigid<float>& T_camera_world, float sigma) {
    archive_.archive_due(frame, window, features, T_camera_world, sigma);
  }
  /// As PlaceSearch::keep_view().
  void keep_view(FrameContext& frame, const Features& features, const Rigid<float>& T_camera_world,
                 float inverse_depth) {
    search_.keep_view(frame, features, T_camera_world, inverse_depth);
  }

  /// Units of work that the frame should leave for recognise(), as PlaceSearch::wanted_work().
  int wanted_work(const ImageView& image) const { return search_.wanted_work(image); }
  /// As PlaceSearch::step().
  bool recognise(FrameContext& frame, Features& features, const Rigid<float>& T_camera_world) {
    return search_.step(frame, features, archive_, T_camera_world);
  }
  const typename Search::Place& place() const { return search_.place(); }
  /// After recognise(): the landmarks of place() become features of the window, whose first
  /// keyframe is at their pose.
  void take_place(FrameContext& frame, Window& window, Features& features) {
    reuse_.take_place(frame, archive_, place(), window, features);
  }
  /// The window has a new keyframe.
  void note_keyframe() { reuse_.note_keyframe(); }
  /// As WindowMapReuse::reuse().
  void reuse(FrameContext& frame, Window& window, Features& features,
             const Rigid<float>& T_camera_world) {
    reuse_.reuse(frame, archive_, window, features, T_camera_world);
  }

 private:
  Archive archive_;
  Search search_;
  Reuse reuse_;
};

}  // namespace cairn
