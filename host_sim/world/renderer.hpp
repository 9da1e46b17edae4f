#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"

#include "host_sim/world/texture.hpp"

namespace cairn::host {

/// Textured parallelogram with one visible side: the one from which edge_s runs to the right when
/// edge_t runs down. Texture coordinates (s, t) run from 0 to 1 along the edges.
struct Quad {
  Vector3<double> origin;
  Vector3<double> edge_s;
  Vector3<double> edge_t;
  int texture = 0;
  int gain = 256;                    ///< light on it, 256 = as painted
  cv::Vec3b tint = {128, 128, 128};  ///< blue, green, red that a colour picture has of 128 grey
};

struct Scene {
  std::vector<MipTexture> textures;
  std::vector<Quad> quads;
};

/// Renders a scene of quads through a pinhole camera without distortion: exact perspective for
/// every pixel, nearest surface by inverse depth, silhouettes smoothed by 16 samples a pixel.
class Renderer {
 public:
  explicit Renderer(const PinholeCamera<double>& camera);

  /// `image` receives intensity * 16 (CV_16UC1). The scene must outlive the call.
  void render(const Scene& scene, const Rigid<double>& T_world_camera, cv::Mat& image);

  /// `grey`, what a sensor made of the picture last rendered, in the colours of its surfaces
  /// (CV_8UC3).
  void colour(const cv::Mat& grey, cv::Mat& picture) const;

  /// 1 / z of the surface last rendered at a pixel, 1/m; 0 where there is none.
  float inverse_depth(int x, int y) const {
    return inverse_depth_[static_cast<std::size_t>(y) * camera_.width + x];
  }

 private:
  /// A function that is affine in the pixel: value = du * u + dv * v + at_origin.
  struct Affine {
    double du = 0.0;
    double dv = 0.0;
    double at_origin = 0.0;
    double at(double u, double v) const { return du * u + dv * v + at_origin; }
  };
  /// A quad as this frame sees it: (s, t, 1) / z as affine functions of the pixel.
  struct Projected {
    Affine s_over_z;
    Affine t_over_z;
    Affine one_over_z;
    const MipTexture* texture = nullptr;
    int gain = 256;
    cv::Vec3b tint;
    double nearest_m = 0.0;
    int corner_count = 0;
    Vector2<double> corners[5];
  };

  bool project(const Scene& scene, const Quad& quad, const Rigid<double>& T_camera_world,
               Projected& projected) const;
  void fill(const Projected& projected, std::uint16_t id, cv::Mat& image);
  void fill_span(const Projected& projected, std::uint16_t id, int y, int x_first, int x_last,
                 std::uint16_t* row);
  MipTexture::Lod lod_at(const Projected& projected, double u, double v) const;
  void smooth_silhouettes(cv::Mat& image);
  int blended(int x, int y) const;

  PinholeCamera<double> camera_;
  std::vector<Projected> projected_;
  std::vector<float> inverse_depth_;
  std::vector<std::uint16_t> id_;  ///< index into projected_ + 1
};

}  // namespace cairn::host
