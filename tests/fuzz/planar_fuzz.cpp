// The planar filters: every call with arbitrary values in any order.
#include "cairn/numeric/positive_definite.hpp"
#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

#include "fuzz_input.hpp"

namespace cairn::fuzz {
namespace {

constexpr int kLandmarks = 6;

PinholeCamera<float> camera() {
  PinholeCamera<float> c;
  c.fx = c.fy = 250.0F;
  c.cx = 159.5F;
  c.cy = 119.5F;
  c.width = 320;
  c.height = 240;
  return c;
}

/// Looks ahead.
Rigid<float> mount() {
  return {{0.5F, -0.5F, 0.5F, -0.5F}, {0.1F, 0.0F, 1.0F}};
}

template <class Filter>
class Run {
 public:
  explicit Run(Input&) {
    PROMISE(1, ok(filter_.initialise(PlanarPose<float>(), 1e-6F * Matrix3<float>::Identity())));
  }

  void step(Input& input) {
    const std::uint64_t before = hash();
    const std::uint64_t pose_before = pose_hash();
    const NoAllocation none;
    const Status status = call(input);
    // A gate and a singular covariance leave the estimate alone, too; pixels that disagree may end
    // a rest, whose noise then counts.
    const bool may_end_rest = status == Status::kNoConsensus && pose_hash() == pose_before;
    PROMISE(3, ok(status) || may_end_rest || hash() == before);
    check();
  }

 private:
  using Matrix3f = Matrix3<float>;

  Status call(Input& input) {
    switch (input.below(12)) {
      case 0:
      case 1:
        return predict(input);
      case 2:
        return filter_.add_landmark(id(input), place(input), covariance(input, 1e-4F, 1.0F));
      case 3:
      case 4:
        return pixels(input);
      case 5:
        return points(input);
      case 6:
        return ranges(input);
      case 7:
        return filter_.update_height(id(input), input.number(-1.0F, 3.0F),
                                     input.number(1e-3F, 0.2F), input.number(1.0F, 11.0F));
      case 8:
        return filter_.add_position(id(input));
      case 9:
        return filter_.remove_landmark(input.below(kLandmarks + 2) - 1);
      case 10:
        return filter_.widen_pose(input.number(0.0F, 1.0F), input.number(0.0F, 0.1F));
      default:
        return world(input);
    }
  }

  Status predict(Input& input) {
    const auto model = input.flag() ? IncrementModel::kEuler : IncrementModel::kExactArc;
    if (input.flag()) {
      return filter_.predict(ackermann_increment(
          input.number(-2.0F, 2.0F), input.number(-0.7F, 0.7F), input.number(0.0F, 0.2F),
          input.number(0.2F, 2.0F), input.number(0.0F, 0.3F), input.number(0.0F, 0.2F), model));
    }
    return filter_.predict(twist_increment(input.number(-2.0F, 2.0F), input.number(-1.5F, 1.5F),
                                           input.number(0.0F, 0.2F), input.number(0.0F, 0.3F),
                                           input.number(0.0F, 0.3F), model));
  }

  Status pixels(Input& input) {
    PixelMatch<float> matches[kLandmarks];
    const int count = input.below(kLandmarks + 1);
    const float sigma = input.number(0.01F, 2.0F);
    for (int i = 0; i < count; ++i) {
      PixelMatch<float>& match = matches[i];
      match.slot = input.flag() ? i : input.below(kLandmarks + 2) - 1;
      const bool there = match.slot >= 0 && match.slot < filter_.landmark_count();
      match.id = there && input.byte() < 250 ? filter_.landmark_id(match.slot) : id(input);
      PixelPrediction<float> expected;
      const bool seen =
          there && ok(filter_.predict_pixel(match.slot, camera(), mount(), 0.5F, expected));
      match.pixel = seen ? expected.pixel : Vector2<float>(160.0F, 120.0F);
      match.pixel += Vector2<float>(input.number(-3.0F, 3.0F), input.number(-3.0F, 3.0F));
      match.descriptor_distance = input.byte();
    }
    // What a tracker asks of two matches that agree, and of many.
    OnePointRansacParameters ransac = PlanarParameters<float>().ransac;
    if (input.flag()) {
      ransac.min_inliers = 1 + input.below(4);
      ransac.min_inlier_share = static_cast<float>(input.below(5)) / 4.0F;
    }
    filter_.set_ransac(ransac);
    UpdateReport report;
    return filter_.update_pixels(camera(), mount(), sigma, matches, count, random_, report);
  }

  Status points(Input& input) {
    PointObservation<float> seen[2];
    for (PointObservation<float>& point : seen) {
      point.id = id(input);
      point.y = place(input).template head<2>();
      point.R = covariance(input, 1e-4F, 0.1F).template topLeftCorner<2, 2>();
    }
    UpdateReport report;
    return filter_.update_points({seen, 1 + input.below(2)}, report);
  }

  Status ranges(Input& input) {
    RangeBearingObservation<float> seen;
    seen.id = id(input);
    seen.range = input.number(0.0F, 10.0F);
    seen.bearing = input.number(-3.2F, 3.2F);
    seen.sigma_range = input.number(1e-3F, 0.3F);
    seen.sigma_bearing = input.number(1e-3F, 0.1F);
    UpdateReport report;
    return filter_.update_range_bearing({&seen, 1}, input.number(-0.5F, 0.5F), report);
  }

  Status world(Input& input) {
    const LandmarkId reference = input.flag() ? id(input) : kNoLandmark;
    if (input.flag()) {
      return filter_.add_world_landmark(id(input), place(input), covariance(input, 1e-4F, 0.1F),
                                        reference);
    }
    return filter_.add_frame_position(id(input), place(input), covariance(input, 1e-4F, 0.1F),
                                      reference);
  }

  static LandmarkId id(Input& input) {
    return static_cast<LandmarkId>(input.below(kLandmarks + 3));
  }
  static Vector3<float> place(Input& input) {
    return {input.number(-2.0F, 8.0F), input.number(-4.0F, 4.0F), input.number(-1.0F, 3.0F)};
  }
  static Matrix3f covariance(Input& input, float low, float high) {
    Matrix3f result = Matrix3f::Zero();
    for (int i = 0; i < 3; ++i) result(i, i) = input.number(low, high);
    if (input.byte() > 240) result(1, 0) = result(0, 1) = input.wild();
    return result;
  }

  std::uint64_t pose_hash() const {
    Hash64 sum;
    const PlanarPose<float> pose = filter_.mean_pose();
    sum.add(pose.position.x());
    sum.add(pose.position.y());
    sum.add(pose.heading);
    return sum.value();
  }

  std::uint64_t hash() const {
    Hash64 sum;
    filter_.hash(sum);
    return sum.value();
  }

  void check() const {
    const PlanarPose<float> pose = filter_.pose();
    PROMISE(4, pose.position.allFinite() && is_finite(pose.heading));
    const Matrix3f own = filter_.pose_covariance();
    PROMISE(4, own.allFinite());
    for (int i = 0; i < 3; ++i) PROMISE(5, own(i, i) >= 0.0F);
    PROMISE(6, filter_.landmark_count() <= kLandmarks);
    for (int slot = 0; slot < filter_.landmark_count(); ++slot) {
      PROMISE(4, filter_.landmark_position(slot).allFinite());
      const Matrix3f of_landmark = filter_.landmark_covariance(slot);
      PROMISE(4, of_landmark.allFinite());
      for (int i = 0; i < 3; ++i) PROMISE(5, of_landmark(i, i) >= 0.0F);
    }
  }

  Filter filter_;
  Random random_{1};
};

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn;
  using namespace cairn::fuzz;
  return run_one_of<Run<GroupIekfSlam<float, kLandmarks, 3>>,
                    Run<LiftedIekfSlam<float, kLandmarks, 3>>, Run<EkfSlam<float, kLandmarks, 3>>>(
      bytes, size);
}
