// MonoEkf: every call with arbitrary values in any order.
#include "cairn/mono/mono_ekf.hpp"

#include "fuzz_input.hpp"

namespace cairn::fuzz {
namespace {

constexpr int kFeatures = 6;
using Filter = MonoEkf<float, kFeatures>;

PinholeCamera<float> camera() {
  PinholeCamera<float> c;
  c.fx = c.fy = 250.0F;
  c.cx = 159.5F;
  c.cy = 119.5F;
  c.k1 = -0.1F;
  c.width = 320;
  c.height = 240;
  return c;
}

class Run {
 public:
  explicit Run(Input& input) {
    MonoParameters<float> parameters;
    parameters.motion = static_cast<MotionModel>(input.below(3));
    parameters.estimate_focal_length = input.flag();
    parameters.fading = input.flag() ? FadingMode::kAdaptive : FadingMode::kFixed;
    if (input.flag()) parameters.fading_factor = input.number(1.0F, 1.05F);
    const Status status = filter_.initialise(camera(), parameters);
    PROMISE(1, ok(status) || status == Status::kBadConfig);
    started_ = ok(status);
  }

  void step(Input& input) {
    if (!started_) return;
    const Before before(filter_);
    const NoAllocation none;
    const Status status = call(input);
    // An update without a consensus still counts the features' misses.
    const bool counts = status == Status::kNoConsensus;
    PROMISE(3, ok(status) || counts || before.unchanged());
    check();
  }

 private:
  Status call(Input& input) {
    switch (input.below(8)) {
      case 0:
      case 1:
        return filter_.predict(input.number(0.01F, 0.1F));
      case 2:
      case 3:
        return update(input);
      case 4:
        return add(input);
      case 5:
        return filter_.remove_feature(input.below(kFeatures + 2) - 1);
      case 6:
        return filter_.set_motion_noise(input.number(0.0F, 5.0F), input.number(0.0F, 5.0F));
      default:
        return other(input);
    }
  }

  Status add(Input& input) {
    const auto id = static_cast<LandmarkId>(input.below(kFeatures + 3));
    const Vector2<float> pixel(input.number(0.0F, 319.0F), input.number(0.0F, 239.0F));
    if (input.flag()) return filter_.add_feature(id, pixel);
    return filter_.add_feature(id, pixel, input.number(0.01F, 3.0F), input.number(0.01F, 1.0F));
  }

  Status update(Input& input) {
    PixelMatch<float> matches[kFeatures];
    const int count = input.below(kFeatures + 1);
    for (int i = 0; i < count; ++i) {
      PixelMatch<float>& match = matches[i];
      match.slot = input.byte() < 240 ? i : input.below(kFeatures + 2) - 1;
      const bool there = match.slot >= 0 && match.slot < filter_.feature_count();
      match.id = there ? filter_.feature_id(match.slot) : LandmarkId{1};
      PixelPrediction<float> expected;
      const bool seen = there && ok(filter_.predict_feature(match.slot, expected));
      match.pixel = seen ? expected.pixel : Vector2<float>(160.0F, 120.0F);
      match.pixel += Vector2<float>(input.number(-4.0F, 4.0F), input.number(-4.0F, 4.0F));
    }
    UpdateReport report;
    return filter_.update(matches, count, random_, report);
  }

  Status other(Input& input) {
    const int kind = input.below(3);
    if (kind == 0) {
      FeaturePolicy policy;
      policy.max_out_of_view = input.byte();
      static_cast<void>(filter_.prune(policy, input.below(kFeatures + 1)));
      return Status::kOk;
    }
    Rigid<float> pose;
    pose.translation = Vector3<float>(input.number(-2.0F, 2.0F), input.number(-2.0F, 2.0F), 0.0F);
    if (input.byte() > 230) pose.rotation.x() = input.wild();
    return kind == 1 ? filter_.restart(pose) : filter_.restart_moving(pose);
  }

  void check() const {
    const Rigid<float> pose = filter_.T_world_camera();
    PROMISE(4, pose.translation.allFinite() && pose.rotation.coeffs().allFinite());
    PROMISE(4, abs(pose.rotation.norm() - 1.0F) < 1e-2F);
    const Matrix<float, 6, 6> covariance = filter_.pose_covariance();
    PROMISE(4, covariance.allFinite());
    for (int i = 0; i < 6; ++i) PROMISE(5, covariance(i, i) >= 0.0F);
    PROMISE(6, filter_.feature_count() <= kFeatures);
  }

  Filter filter_;
  Random random_{1};
  bool started_ = false;
};

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn::fuzz;
  count_allocations();
  Input input(bytes, size);
  run_steps<Run>(input, 24);
  return 0;
}
