#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/tracking/place_views.hpp"
#include "cairn/tracking/window_archive.hpp"

namespace cairn {

/// Poses of a camera, proposed by the views that look most like its image: where they were taken
/// from, turned by what moves the one picture over the other.
template <class Config>
class ViewProposals {
 public:
  using Features = WindowFeatures<Config>;
  using Views = PlaceViews<WindowLibraryConfig<Config>::kPlaceViews>;
  static constexpr int kMaxProposals = 8;

  /// Forgets the views. Proposals made before stay.
  void clear() { views_.clear(); }
  int views() const { return views_.size(); }
  /// Keeps the present view, of a camera whose place in the map is known, where it is a new one.
  /// `inverse_depth`: of what it sees.
  void keep(FrameContext& frame, const Features& features, const Rigid<float>& T_map_camera,
            float inverse_depth);

  /// Proposes at most `most` poses of the present image, instead of those before. Cost:
  /// propose_work().
  void propose(FrameContext& frame, const Features& features, int most);
  int propose_work() const { return kPictureWork + views_.size() * work::kViewComparison; }
  bool empty() const { return proposals_.empty(); }
  /// The camera has moved since: `T_then_now`, its pose now as seen from where it was.
  void move(const Rigid<float>& T_then_now) {
    for (Rigid<float>& proposal : proposals_) proposal = proposal * T_then_now;
  }
  /// Removes the best proposal and returns it, T_map_camera. There must be one.
  Rigid<float> take_best() {
    const Rigid<float> best = proposals_.back();
    proposals_.pop_back();
    return best;
  }

 private:
  static constexpr int kPictureWork = 60;  ///< units, of SmallPicture::take() of a shrunk image

  Views views_;
  FixedVector<Rigid<float>, kMaxProposals> proposals_;  ///< T_map_camera, the best last
};

template <class Config>
void ViewProposals<Config>::keep(FrameContext& frame, const Features& features,
                                 const Rigid<float>& T_map_camera, float inverse_depth) {
  SmallPicture picture;
  if (!frame.work.take(Views::look_work()) || !views_.is_new(T_map_camera, inverse_depth) ||
      !frame.work.take(kPictureWork + Views::add_work()) || !picture.take(features.shrunk())) {
    return;
  }
  views_.add(picture, T_map_camera, inverse_depth);
}

template <class Config>
void ViewProposals<Config>::propose(FrameContext& frame, const Features& features, int most) {
  frame.work.spend(propose_work());
  proposals_.clear();
  SmallPicture picture;
  if (!picture.take(features.shrunk())) return;
  typename Views::Likeness like[kMaxProposals];
  const int count = views_.most_like(picture, like, most);
  const int column_px = frame.image.width / SmallPicture::kColumns;
  const int row_px = frame.image.height / SmallPicture::kRows;
  for (int i = count - 1; i >= 0; --i) {
    const float right = static_cast<float>(like[i].shift.dx * column_px) / frame.camera.fx;
    const float down = static_cast<float>(like[i].shift.dy * row_px) / frame.camera.fy;
    Rigid<float> T_map_camera = views_[like[i].view].T_map_camera;
    T_map_camera.rotation =
        T_map_camera.rotation * rotation_exp(Vector3<float>(down, -right, 0.0F));
    static_cast<void>(proposals_.push_back(T_map_camera));
  }
}

}  // namespace cairn
