#pragma once

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/tracking/window_archive.hpp"

#include "plane_scene.hpp"

namespace cairn::test {

/// GIVEN a camera before a textured wall, and a window that knows points of it.
class ArchivedWall : public ::testing::Test {
 protected:
  using Archive = WindowArchive<DefaultConfig>;
  static constexpr float kDepth = 2.5F;
  static constexpr float kSigma = 0.003F;  ///< of a pixel, relative to the focal length
  static constexpr int kMature = 20;

  ArchivedWall() {
    work_.reset(1 << 20, 0);
    archive_->reset({});
    features_->reset({});
    window_->clear(1.0F / kDepth);
    window_->begin_keyframe(Rigid<float>());
    host_ = window_->add_host(Rigid<float>());
    look_from(Rigid<double>());
  }
  /// The frame is that of a camera at a pose.
  void look_from(const Rigid<double>& T_map_camera) {
    image_ = PlaneScene(double{kDepth}, 0.28).render(small_camera(), T_map_camera);
    view_ = test::view(image_, small_camera());
    work_.begin(0);
    features_->begin(view_);
  }
  /// A feature at a pixel, with a depth known to `sigma`, relative.
  WindowFeature& follow(LandmarkId id, const Vector2<float>& pixel, float sigma) {
    const Vector3<float> ray = camera_.unproject(pixel);
    const int slot =
        window_->add_known_landmark(id, host_, {ray.x(), ray.y()}, 1.0F / kDepth, sigma / kDepth);
    EXPECT_TRUE(features_->add_known(frame_, slot, pixel));
    WindowFeature& feature = (*features_)[features_->size() - 1];
    feature.in_library = feature.from_library = false;
    feature.searches = feature.sightings = kMature;
    return feature;
  }
  void archive_due() {
    archive_->archive_due(frame_, *window_, *features_, Rigid<float>(), kSigma);
  }
  /// The archive gets 7 x 5 landmarks, spread over the image.
  void archive_grid() {
    for (int i = 0; i < 35; ++i) {
      const int column = i % 7;
      const int row = i / 7;
      const Vector2<float> pixel(50.0F + 36.0F * static_cast<float>(column),
                                 40.0F + 40.0F * static_cast<float>(row));
      WindowFeature& feature = follow(static_cast<LandmarkId>(i + 1), pixel, 0.02F);
      archive_due();
      ++feature.sightings;
    }
  }

  const PinholeCamera<float> camera_ = to_float(small_camera());
  std::vector<std::uint8_t> image_;
  ImageView view_;
  FrameWork work_;
  Random random_{1};
  FrameReport report_;
  Health health_;
  FrameContext frame_{view_, camera_, work_, random_, report_, health_};
  std::unique_ptr<Archive> archive_ = std::make_unique<Archive>();
  std::unique_ptr<Archive::Features> features_ = std::make_unique<Archive::Features>();
  std::unique_ptr<Archive::Window> window_ = std::make_unique<Archive::Window>();
  int host_ = -1;
};

}  // namespace cairn::test
