#include "host_sim/world/renderer.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace cairn::host {
namespace {

constexpr double kNear = 0.05;
constexpr int kSubsamples = 4;  // a side
constexpr int kLodRun = 8;      // pixels that share one mip level

}  // namespace

Renderer::Renderer(const PinholeCamera<double>& camera) : camera_(camera) {
  const std::size_t count = static_cast<std::size_t>(camera.width) * camera.height;
  inverse_depth_.resize(count);
  id_.resize(count);
}

void Renderer::render(const Scene& scene, const Rigid<double>& T_world_camera, cv::Mat& image) {
  image.create(camera_.height, camera_.width, CV_16UC1);
  image.setTo(0);
  std::fill(inverse_depth_.begin(), inverse_depth_.end(), 0.0F);
  std::fill(id_.begin(), id_.end(), std::uint16_t{0});
  const Rigid<double> T_camera_world = T_world_camera.inverse();
  projected_.clear();
  for (const Quad& quad : scene.quads) {
    Projected projected;
    if (project(scene, quad, T_camera_world, projected)) projected_.push_back(projected);
  }
  // Near ones first, so that hidden pixels are seldom shaded.
  std::stable_sort(
      projected_.begin(), projected_.end(),
      [](const Projected& a, const Projected& b) { return a.nearest_m < b.nearest_m; });
  for (std::size_t i = 0; i < projected_.size(); ++i) {
    fill(projected_[i], static_cast<std::uint16_t>(i + 1), image);
  }
  smooth_silhouettes(image);
}

bool Renderer::project(const Scene& scene, const Quad& quad, const Rigid<double>& T_camera_world,
                       Projected& projected) const {
  const Vector3<double> origin = T_camera_world * quad.origin;
  const Vector3<double> edge_s = T_camera_world.rotation * quad.edge_s;
  const Vector3<double> edge_t = T_camera_world.rotation * quad.edge_t;
  if (edge_s.cross(edge_t).dot(origin) < 1e-6) return false;  // seen from behind or edge-on

  const Vector3<double> corners[4] = {origin, origin + edge_s, origin + edge_s + edge_t,
                                      origin + edge_t};
  int count = 0;
  double nearest = 1e9;
  for (int i = 0; i < 4; ++i) {
    const Vector3<double>& a = corners[i];
    const Vector3<double>& b = corners[(i + 1) % 4];
    const auto add = [&](const Vector3<double>& p) {
      projected.corners[count++] = {camera_.fx * p.x() / p.z() + camera_.cx,
                                    camera_.fy * p.y() / p.z() + camera_.cy};
    };
    if (a.z() >= kNear) add(a);
    nearest = std::min(nearest, std::max(kNear, a.z()));
    if ((a.z() >= kNear) != (b.z() >= kNear)) {
      add(a + (kNear - a.z()) / (b.z() - a.z()) * (b - a));
    }
  }
  if (count < 3) return false;
  bool left = true, right = true, above = true, below = true;
  for (int i = 0; i < count; ++i) {
    left = left && projected.corners[i].x() < 0.0;
    right = right && projected.corners[i].x() > camera_.width - 1;
    above = above && projected.corners[i].y() < 0.0;
    below = below && projected.corners[i].y() > camera_.height - 1;
  }
  if (left || right || above || below) return false;

  Matrix3<double> plane;
  plane << edge_s, edge_t, origin;
  const Matrix3<double> inverse = plane.inverse();
  const auto affine = [&](int row) {
    Affine f;
    f.du = inverse(row, 0) / camera_.fx;
    f.dv = inverse(row, 1) / camera_.fy;
    f.at_origin = inverse(row, 2) - f.du * camera_.cx - f.dv * camera_.cy;
    return f;
  };
  projected.s_over_z = affine(0);
  projected.t_over_z = affine(1);
  projected.one_over_z = affine(2);
  projected.texture = &scene.textures[quad.texture];
  projected.gain = quad.gain;
  projected.tint = quad.tint;
  projected.nearest_m = nearest;
  projected.corner_count = count;
  return true;
}

void Renderer::fill(const Projected& projected, std::uint16_t id, cv::Mat& image) {
  double top = 1e9, bottom = -1e9;
  for (int i = 0; i < projected.corner_count; ++i) {
    top = std::min(top, projected.corners[i].y());
    bottom = std::max(bottom, projected.corners[i].y());
  }
  const int y_first = static_cast<int>(std::ceil(std::max(0.0, top)));
  const int y_last = static_cast<int>(std::floor(std::min(camera_.height - 1.0, bottom)));
  for (int y = y_first; y <= y_last; ++y) {
    double x_left = 1e9, x_right = -1e9;
    for (int i = 0; i < projected.corner_count; ++i) {
      const Vector2<double>& a = projected.corners[i];
      const Vector2<double>& b = projected.corners[(i + 1) % projected.corner_count];
      if ((a.y() <= y) == (b.y() <= y)) continue;
      const double x = a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
      x_left = std::min(x_left, x);
      x_right = std::max(x_right, x);
    }
    if (x_left > x_right) continue;
    const int x_first = static_cast<int>(std::ceil(std::max(0.0, x_left)));
    const int x_last = static_cast<int>(std::floor(std::min(camera_.width - 1.0, x_right)));
    if (x_first <= x_last) {
      fill_span(projected, id, y, x_first, x_last, image.ptr<std::uint16_t>(y));
    }
  }
}

void Renderer::fill_span(const Projected& projected, std::uint16_t id, int y, int x_first,
                         int x_last, std::uint16_t* row) {
  const auto w0 = static_cast<float>(projected.one_over_z.at(x_first, y));
  const auto s0 = static_cast<float>(projected.s_over_z.at(x_first, y));
  const auto t0 = static_cast<float>(projected.t_over_z.at(x_first, y));
  const auto dw = static_cast<float>(projected.one_over_z.du);
  const auto ds = static_cast<float>(projected.s_over_z.du);
  const auto dt = static_cast<float>(projected.t_over_z.du);
  float* depths = &inverse_depth_[static_cast<std::size_t>(y) * camera_.width];
  std::uint16_t* ids = &id_[static_cast<std::size_t>(y) * camera_.width];
  const MipTexture& texture = *projected.texture;
  for (int start = x_first; start <= x_last; start += kLodRun) {
    const int stop = std::min(start + kLodRun - 1, x_last);
    const MipTexture::Lod lod = lod_at(projected, 0.5 * (start + stop), y);
    for (int x = start; x <= stop; ++x) {
      const auto step = static_cast<float>(x - x_first);
      const float w = w0 + step * dw;
      if (w <= depths[x]) continue;
      const float z = 1.0F / w;
      const int value = texture.sample((s0 + step * ds) * z, (t0 + step * dt) * z, lod);
      depths[x] = w;
      ids[x] = id;
      row[x] = static_cast<std::uint16_t>((value * projected.gain) >> 8);
    }
  }
}

MipTexture::Lod Renderer::lod_at(const Projected& projected, double u, double v) const {
  const double z = 1.0 / projected.one_over_z.at(u, v);
  const double s = projected.s_over_z.at(u, v) * z;
  const double t = projected.t_over_z.at(u, v) * z;
  const double width = projected.texture->width() * z;
  const double height = projected.texture->height() * z;
  const double s_u = (projected.s_over_z.du - s * projected.one_over_z.du) * width;
  const double s_v = (projected.s_over_z.dv - s * projected.one_over_z.dv) * width;
  const double t_u = (projected.t_over_z.du - t * projected.one_over_z.du) * height;
  const double t_v = (projected.t_over_z.dv - t * projected.one_over_z.dv) * height;
  // Between the area of the footprint (sharp, may shimmer) and its long side (calm, may smear).
  const double area = std::abs(s_u * t_v - s_v * t_u);
  const double longest = std::max(s_u * s_u + t_u * t_u, s_v * s_v + t_v * t_v);
  return projected.texture->lod(static_cast<float>(std::sqrt(area * longest)));
}

void Renderer::colour(const cv::Mat& grey, cv::Mat& picture) const {
  picture.create(grey.size(), CV_8UC3);
  std::vector<cv::Vec3b> tints = {{128, 128, 128}};
  for (const Projected& projected : projected_) tints.push_back(projected.tint);
  for (int y = 0; y < grey.rows; ++y) {
    const std::uint8_t* from = grey.ptr<std::uint8_t>(y);
    const std::uint16_t* ids = &id_[static_cast<std::size_t>(y) * camera_.width];
    cv::Vec3b* to = picture.ptr<cv::Vec3b>(y);
    for (int x = 0; x < grey.cols; ++x) {
      const cv::Vec3b& tint = tints[ids[x]];
      for (int c = 0; c < 3; ++c)
        to[x][c] = cv::saturate_cast<std::uint8_t>(from[x] * tint[c] >> 7);
    }
  }
}

void Renderer::smooth_silhouettes(cv::Mat& image) {
  const int width = camera_.width;
  for (int y = 1; y < camera_.height - 1; ++y) {
    const std::uint16_t* ids = &id_[static_cast<std::size_t>(y) * width];
    std::uint16_t* row = image.ptr<std::uint16_t>(y);
    for (int x = 1; x < width - 1; ++x) {
      const std::uint16_t id = ids[x];
      if (id != ids[x - 1] || id != ids[x + 1] || id != ids[x - width] || id != ids[x + width]) {
        row[x] = static_cast<std::uint16_t>(blended(x, y));
      }
    }
  }
}

int Renderer::blended(int x, int y) const {
  constexpr int kMaxCandidates = 5;
  std::uint16_t candidates[kMaxCandidates];
  int candidate_count = 0;
  for (const auto& [dx, dy] : {std::pair{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
    const std::uint16_t id = id_[static_cast<std::size_t>(y + dy) * camera_.width + x + dx];
    if (id == 0 ||
        std::find(candidates, candidates + candidate_count, id) != candidates + candidate_count) {
      continue;
    }
    candidates[candidate_count++] = id;
  }
  int hits[kMaxCandidates] = {};
  double s_sum[kMaxCandidates] = {};
  double t_sum[kMaxCandidates] = {};
  for (int k = 0; k < kSubsamples * kSubsamples; ++k) {
    const int column = k % kSubsamples;
    const int row = k / kSubsamples;
    const double u = x + (column + 0.5) / kSubsamples - 0.5;
    const double v = y + (row + 0.5) / kSubsamples - 0.5;
    int best = -1;
    double best_w = 0.0;
    double best_s = 0.0;
    double best_t = 0.0;
    for (int c = 0; c < candidate_count; ++c) {
      const Projected& quad = projected_[candidates[c] - 1];
      const double w = quad.one_over_z.at(u, v);
      if (w <= best_w) continue;
      const double s = quad.s_over_z.at(u, v);
      const double t = quad.t_over_z.at(u, v);
      if (s < 0.0 || t < 0.0 || s > w || t > w) continue;
      best = c;
      best_w = w;
      best_s = s / w;
      best_t = t / w;
    }
    if (best < 0) continue;
    ++hits[best];
    s_sum[best] += best_s;
    t_sum[best] += best_t;
  }
  int total = 0;
  int sum = 0;
  for (int c = 0; c < candidate_count; ++c) {
    if (hits[c] == 0) continue;
    const Projected& quad = projected_[candidates[c] - 1];
    const int value =
        quad.texture->sample(static_cast<float>(s_sum[c] / hits[c]),
                             static_cast<float>(t_sum[c] / hits[c]), lod_at(quad, x, y));
    sum += ((value * quad.gain) >> 8) * hits[c];
    total += hits[c];
  }
  return total > 0 ? sum / total : 0;
}

}  // namespace cairn::host
