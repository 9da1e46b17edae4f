#pragma once

#include "cairn/ar/fixed_object_drawing.hpp"
#include "cairn/ar/object_drawing.hpp"
#include "cairn/ar/virtual_object.hpp"
#include "cairn/base/fixed_vector.hpp"
#include "cairn/geometry/camera.hpp"

namespace cairn {

/// The virtual objects of a scene: one shape at up to kMaxObjects fixed places in the map, drawn
/// into frames (paper A, step 2.5). The application chooses the shape and the places.
class Augmenter {
 public:
  static constexpr int kMaxObjects = 8;

  struct Parameters {
    int frames_without_object = 45;  ///< none in view for so long: a new one is wanted
    DrawStyle style;
  };

  /// Starts with no object in view: one is wanted at once.
  void initialise(const VirtualObject& shape, const Parameters& parameters) {
    shape_ = shape;
    initialise(parameters);
  }
  /// The same with the shape as it is: shape() makes it.
  void initialise(const Parameters& parameters) {
    parameters_ = parameters;
    places_.clear();
    frames_without_ = parameters.frames_without_object;
  }

  /// The shape that is drawn: to be made in place where a copy would not fit the stack.
  VirtualObject& shape() { return shape_; }

  /// Puts an object at a place in the map. kFull.
  Status place(const Rigid<float>& T_map_object) {
    if (!places_.push_back(T_map_object)) return Status::kFull;
    frames_without_ = 0;
    return Status::kOk;
  }

  int size() const { return places_.size(); }
  const VirtualObject& shape() const { return shape_; }
  const Rigid<float>& operator[](int i) const { return places_[i]; }

  /// No object was drawn for a while and there is room for another: the time to place one.
  bool wants_object() const {
    return !places_.full() && frames_without_ >= parameters_.frames_without_object;
  }

  /// Draws every object that is in view, far ones first; returns how many. Cost: draw_object() for
  /// each of at most kMaxObjects.
  int draw(const PinholeCamera<float>& camera, const Rigid<float>& T_map_camera,
           const MutableImageView& image) {
    int order[kMaxObjects] = {};
    sort_far_to_near(T_map_camera, order);
    return draw_each(order, [&](const Rigid<float>& T_map_object, DrawReport& report) {
      return draw_object(shape_, T_map_object, camera, T_map_camera, parameters_.style, image,
                         report);
    });
  }
  /// The same by draw_object_in_integers(); nothing with a lens that has no fixed form.
  int draw_in_integers(const PinholeCamera<float>& camera, const Rigid<float>& T_map_camera,
                       const MutableImageView& image) {
    FixedCamera fixed;
    if (!ok(fixed_of(camera, fixed))) return 0;
    int order[kMaxObjects] = {};
    sort_in_integers(T_map_camera, order);
    return draw_each(order, [&](const Rigid<float>& T_map_object, DrawReport& report) {
      return draw_object_in_integers(shape_, T_map_object, fixed, T_map_camera, parameters_.style,
                                     image, report);
    });
  }

 private:
  template <class Draw>
  int draw_each(const int* order, const Draw& draw) {
    int drawn = 0;
    for (int i = 0; i < places_.size(); ++i) {
      DrawReport report;
      if (ok(draw(places_[order[i]], report))) ++drawn;
    }
    frames_without_ = drawn > 0 ? 0 : frames_without_ + 1;
    return drawn;
  }
  void sort_far_to_near(const Rigid<float>& T_map_camera, int* order) const {
    sort<float>(order, [&](const Rigid<float>& T_map_object) {
      const Vector3<float> d = T_map_object.translation - T_map_camera.translation;
      return d.dot(d);
    });
  }
  void sort_in_integers(const Rigid<float>& T_map_camera, int* order) const {
    sort<std::int64_t>(order, [&](const Rigid<float>& T_map_object) {
      std::int64_t squared = 0;
      std::uint32_t none = 0;
      for (int i = 0; i < 3; ++i) {
        const FixedLength d =
            subtract(fixed_of<FixedLength>(T_map_object.translation(i), none),
                     fixed_of<FixedLength>(T_map_camera.translation(i), none), none);
        squared += (std::int64_t{d.raw()} * d.raw()) >> 2;
      }
      return squared;
    });
  }
  template <class Distance, class Of>
  void sort(int* order, const Of& of) const {
    Distance distance[kMaxObjects];
    for (int i = 0; i < places_.size(); ++i) {
      const Distance squared = of(places_[i]);
      int k = i;
      for (; k > 0 && distance[k - 1] < squared; --k) {
        distance[k] = distance[k - 1];
        order[k] = order[k - 1];
      }
      distance[k] = squared;
      order[k] = i;
    }
  }

  VirtualObject shape_;
  Parameters parameters_;
  FixedVector<Rigid<float>, kMaxObjects> places_;
  int frames_without_ = 0;
};

}  // namespace cairn
