#pragma once

#include "cairn/tracking/place_search.hpp"
#include "cairn/tracking/window_archive.hpp"
#include "cairn/tracking/window_map_reuse.hpp"
#include "cairn/tracking/window_measurement.hpp"

namespace cairn {

/// The long memory of a WindowTracker: landmarks whose depth is well known (WindowArchive), the
/// search of the camera's place among them (PlaceSearch), and their return to the window
/// (WindowMapReuse). After a loss the tracker's map is another one, *astray*, until its place in
/// the remembered one is recognised or that is forgotten.
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
    astray_s_ = 0.0F;
    astray_ = returned_ = false;
  }
  /// Tracking is lost. A memory too small to recognise a place by is forgotten: the new map has
  /// another frame.
  void note_loss() {
    astray_ = !reuse_.too_small(archive_);
    astray_s_ = 0.0F;
    returned_ = false;
    if (astray_) {
      search_.begin();
    } else {
      forget();
    }
  }
  /// Whether the map was begun anew and its place in the library's is not known yet.
  bool astray() const { return astray_; }

  const Library& library() const { return archive_.library(); }
  Library& library() { return archive_.library(); }
  const Health& health() const { return archive_.health(); }

  /// As WindowArchive::renew_depth(); nothing while astray.
  void renew_depth(FrameContext& frame, const Window& window, const WindowFeature& feature) {
    if (!astray_) archive_.renew_depth(frame, window, feature, window.parameters().sigma);
  }
  /// With what the window left of the frame's work: archives what is known and, after a return to
  /// the map, takes up what comes into view of it. `inverse_depth`: of what is in view.
  void keep(FrameContext& frame, Window& window, Features& features,
            const Rigid<float>& T_camera_world, float inverse_depth);

  /// While astray the memory takes points of some frames, where their work allows it with so many
  /// features searched alone.
  bool takes_points(const FrameContext& frame, int searched,
                    const typename Features::Parameters& p) const {
    const int wanted = search_.wanted_work(frame.image);
    if (!astray_ || wanted == 0) return false;
    const int searches = searched * (work::template_search(p.wide_radius_px) +
                                     work::template_search(p.full_radius_px));
    return frame.work.affords(searches + 3 * work::window_pose(searched) + wanted);
  }
  /// While astray, `seconds` after the frame before of which the pose was known: forgets the map
  /// after `forget_s`, else seeks the place in it, as PlaceSearch::step(). True where place() is
  /// the frame's.
  bool seek(FrameContext& frame, Features& features, const Rigid<float>& T_camera_world,
            bool has_map, float seconds, float forget_s);
  const typename Search::Place& place() const { return search_.place(); }
  /// After seek(): the landmarks of place() become features of the window, whose first keyframe is
  /// at their pose. The map is the remembered one again.
  void take_place(FrameContext& frame, Window& window, Features& features) {
    reuse_.take_place(frame, archive_, place(), window, features);
    astray_ = false;
    returned_ = true;
  }
  /// The window has a new keyframe.
  void note_keyframe() { reuse_.note_keyframe(); }

 private:
  void forget() {
    archive_.clear();
    search_.forget();
  }

  Archive archive_;
  Search search_;
  Reuse reuse_;
  float astray_s_ = 0.0F;
  bool astray_ = false;
  bool returned_ = false;  ///< to the map, since the last loss
};

template <class Config>
void WindowMemory<Config>::keep(FrameContext& frame, Window& window, Features& features,
                                const Rigid<float>& T_camera_world, float inverse_depth) {
  if (astray_ || !window.settled()) return;
  archive_.archive_due(frame, window, features, T_camera_world, window.parameters().sigma);
  search_.keep_view(frame, features, T_camera_world, inverse_depth);
  if (returned_) reuse_.reuse(frame, archive_, window, features, T_camera_world);
}

template <class Config>
bool WindowMemory<Config>::seek(FrameContext& frame, Features& features,
                                const Rigid<float>& T_camera_world, bool has_map, float seconds,
                                float forget_s) {
  if (!astray_) return false;
  astray_s_ += seconds;
  if (astray_s_ > forget_s) {
    forget();
    astray_ = false;
    return false;
  }
  return has_map && search_.step(frame, features, archive_, T_camera_world);
}

}  // namespace cairn
