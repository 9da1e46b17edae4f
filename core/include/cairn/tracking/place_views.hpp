#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/vision/small_picture.hpp"

namespace cairn {

namespace work {

inline constexpr int kViewComparison = 165;  ///< best_shift()

}  // namespace work

/// Small pictures of where a camera was, spread over the views that it had.
template <int Capacity>
class PlaceViews {
 public:
  static constexpr int kCapacity = Capacity;
  struct View {
    SmallPicture picture;
    Rigid<float> T_map_camera;
  };
  /// A view and how the present picture is moved against it.
  struct Likeness {
    int view = -1;
    PictureShift shift;
  };

  void clear() { views_.clear(); }
  int size() const { return views_.size(); }
  const View& operator[](int i) const { return views_[i]; }

  /// Whether no view is nearer to a pose than kApart. `inverse_depth`: of what the camera sees
  /// there; a movement counts as the angle that it makes at that depth. Cost: look_work().
  bool is_new(const Rigid<float>& T_map_camera, float inverse_depth) const {
    for (const View& view : views_) {
      if (squared_distance(view.T_map_camera, T_map_camera, inverse_depth) < square(kApart)) {
        return false;
      }
    }
    return true;
  }
  static constexpr int look_work() { return 1 + Capacity / 8; }
  /// Keeps a view; where there is no more room, in the place of one of the two that are nearest to
  /// each other. Cost: add_work().
  void add(const SmallPicture& picture, const Rigid<float>& T_map_camera, float inverse_depth) {
    if (!views_.full()) {
      static_cast<void>(views_.push_back({picture, T_map_camera}));
    } else {
      views_[closest_of_two(inverse_depth)] = {picture, T_map_camera};
    }
  }
  static constexpr int add_work() { return 1 + Capacity * Capacity / 16; }

  /// The views that a picture looks most like, the best first; `most` at most. Cost: one
  /// best_shift() a view.
  int most_like(const SmallPicture& picture, Likeness* found, int most) const {
    int count = 0;
    for (int i = 0; i < views_.size(); ++i) {
      const PictureShift shift = best_shift(picture, views_[i].picture);
      int place = count < most ? count : most;
      while (place > 0 && found[place - 1].shift.score < shift.score) {
        if (place < most) found[place] = found[place - 1];
        --place;
      }
      if (place == most) continue;
      found[place] = {i, shift};
      if (count < most) ++count;
    }
    return count;
  }

 private:
  static constexpr float kApart = 0.1F;  ///< rad

  static float squared_distance(const Rigid<float>& a, const Rigid<float>& b, float inverse_depth) {
    const Quaternion<float> turn = a.rotation.conjugate() * b.rotation;
    const float sine = 2.0F * sqrt(turn.vec().squaredNorm());  // of half the angle, twice
    return square(sine) + square(inverse_depth) * (a.translation - b.translation).squaredNorm();
  }
  /// The earlier one of them.
  int closest_of_two(float inverse_depth) const {
    int best = 0;
    float least = -1.0F;
    for (int i = 0; i < views_.size(); ++i) {
      for (int k = i + 1; k < views_.size(); ++k) {
        const float squared =
            squared_distance(views_[i].T_map_camera, views_[k].T_map_camera, inverse_depth);
        if (least >= 0.0F && !(squared < least)) continue;
        least = squared;
        best = i;
      }
    }
    return best;
  }

  FixedVector<View, Capacity> views_;
};

}  // namespace cairn
