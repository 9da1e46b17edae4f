#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "cairn/ar/virtual_object.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"

namespace cairn::host {

/// A real surface whose place is known: a convex polygon in the world, m. It hides what lies
/// behind.
struct OccludingPolygon {
  std::vector<Vector3<double>> corners;
};

struct ShadedStyle {
  cv::Scalar colour = {150, 172, 188};  ///< BGR in full light
  double ambient = 0.42;                ///< share of the light without a direction
  /// From the object towards the light, object frame.
  Vector3<double> towards_light = Vector3<double>(0.5, -0.35, 0.8);
  double shadow = 0.45;   ///< darkness of the shadow on the object's ground plane; 0: none
  int supersampling = 2;  ///< samples a pixel and axis
};

/// Draws a virtual object with shaded faces into a colour frame, hidden where known surfaces stand
/// in front of it, with its shadow on the ground. Faces of one part never hide each other (back
/// faces are left out); parts are painted from far to near, by planes that separate them, so that
/// the order is exact. Pixels go through the lens model; the frame must be of the camera's size.
class ShadedObject {
 public:
  ShadedObject(const VirtualObject& object, const PinholeCamera<double>& camera,
               const ShadedStyle& style = {});

  /// Nothing is drawn when the object is behind the camera. Throws std::invalid_argument unless
  /// `frame` is CV_8UC3 of the camera's size.
  void draw(const Rigid<double>& T_world_object, const Rigid<double>& T_world_camera,
            const std::vector<OccludingPolygon>& occluders, cv::Mat& frame) const;

 private:
  using Polygon = std::vector<Vector3<double>>;  // camera frame
  struct Layer;

  std::vector<int> far_to_near(const Vector3<double>& eye) const;
  void paint(const Polygon& polygon, const std::vector<Polygon>& occluders,
             const cv::Scalar& colour, Layer& layer) const;
  std::vector<cv::Point> outline(const Polygon& polygon, const Layer& layer) const;
  cv::Rect region(const Rigid<double>& T_camera_object) const;
  void paint_shadow(const Rigid<double>& T_camera_object, const std::vector<Polygon>& occluders,
                    cv::Mat& frame) const;

  VirtualObject object_;
  PinholeCamera<double> camera_;
  ShadedStyle style_;
};

}  // namespace cairn::host
