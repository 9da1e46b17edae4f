// The planar filters without floating point: every call with arbitrary values in any order.
#include "cairn/planar/fixed/fixed_ekf_slam.hpp"
#include "cairn/planar/fixed/fixed_group_slam.hpp"

#include "fuzz_input.hpp"

namespace cairn::fuzz {
namespace {

constexpr int kLandmarks = 4;
constexpr std::int64_t kLargestVariance = std::int64_t{16} << 44U;  // of a heading, rad^2

/// In [low, high] mostly, any number of the format sometimes, of every size alike.
template <class Number>
Number number(Input& input, double low, double high) {
  const std::uint8_t kind = input.byte();
  if (kind < 200) return Number::nearest(low + (high - low) * kind / 199.0);
  using Raw = decltype(Number().raw());
  constexpr int kBits = 8 * static_cast<int>(sizeof(Raw));
  if (kind < 206) return Number::from_raw(std::numeric_limits<Raw>::max());
  if (kind < 212) return Number::from_raw(std::numeric_limits<Raw>::min());
  const std::uint64_t high_word = input.word();
  const auto value = static_cast<std::int64_t>(high_word << 32U | input.word());
  return Number::from_raw(static_cast<Raw>(value >> (64 - kBits) >> input.below(kBits)));
}

FixedMount mount(Input& input) {
  FixedMount at;
  at.w = at.y = FixedRatio::nearest(0.5);
  at.x = at.z = FixedRatio::nearest(-0.5);
  if (input.byte() > 240) at.x = number<FixedRatio>(input, -1.0, 1.0);
  for (FixedLength& coordinate : at.origin) coordinate = number<FixedLength>(input, 0.0, 1.0);
  return at;
}

FixedCamera camera(Input& input) {
  FixedCamera c;
  c.width = input.byte() > 250 ? static_cast<int>(input.word()) : 640;
  c.height = 480;
  c.fx = number<FixedPixel>(input, 300.0, 700.0);
  c.fy = number<FixedPixel>(input, 300.0, 700.0);
  c.cx = FixedPixel::nearest(319.5);
  c.cy = number<FixedPixel>(input, 200.0, 280.0);
  if (input.flag()) {
    for (FixedTangent* k : {&c.k1, &c.k2, &c.k3, &c.p1, &c.p2}) {
      *k = number<FixedTangent>(input, -0.2, 0.2);
    }
  }
  return c;
}

FixedCovariance2 covariance(Input& input) {
  FixedCovariance2 c = {
      number<FixedVariance>(input, 1e-4, 0.5), {}, number<FixedVariance>(input, 1e-4, 0.5)};
  if (input.byte() > 200) c.xy = number<FixedVariance>(input, -1e-4, 1e-4);
  return c;
}

template <int Dim, FixedError Error>
class Run {
 public:
  using Filter = FixedPlanarSlam<kLandmarks, Dim, Error>;

  explicit Run(Input& input) {
    FixedPlanarParameters parameters;
    if (Dim == 3 && input.flag()) {
      parameters.tilt.sigma_pitch = FixedAngle::nearest(0.01);
      parameters.tilt.sigma_roll = FixedAngle::nearest(0.02);
    }
    parameters.replace_after = input.below(3);
    PROMISE(1, ok(filter_.initialise({}, {}, parameters)));
  }

  void step(Input& input) {
    const Before before(filter_);
    const NoAllocation none;
    // A prediction may take in the odometry's noise, whether the landmark is in view or not.
    bool takes_in = false;
    const Status status = call(input, takes_in);
    PROMISE(3, ok(status) || takes_in || before.unchanged());
    check();
  }

 private:
  Status call(Input& input, bool& takes_in) {
    FixedUpdateReport report;
    switch (input.below(Dim == 3 ? 20 : 13)) {
      case 0:
      case 1:
      case 2:
        return predict(input);
      case 3: {
        const FixedPointObservation seen = {id(input), number<FixedLength>(input, -2.0, 8.0),
                                            number<FixedLength>(input, -4.0, 4.0),
                                            covariance(input)};
        return filter_.update_points({&seen, 1}, report);
      }
      case 4: {
        const FixedRangeBearingObservation seen = {
            id(input), number<FixedLength>(input, 0.0, 10.0), number<FixedAngle>(input, -3.1, 3.1),
            number<FixedLength>(input, 1e-3, 0.3), number<FixedAngle>(input, 1e-3, 0.1)};
        return filter_.update_range_bearing({&seen, 1}, number<FixedLength>(input, -0.5, 0.5),
                                            report);
      }
      case 5:
        return filter_.widen_pose(number<FixedVariance>(input, 0.0, 1.0),
                                  number<FixedVariance>(input, 0.0, 0.1));
      case 6:
        return filter_.remove_landmark(slot(input));
      case 7:
        return restart(input);
      case 8:
        return add(input);
      case 9:
        return filter_.slip_laterally(number<FixedVariance>(input, 0.0, 0.1));
      case 10:
        return filter_.drift_world(number<FixedVariance>(input, 0.0, 1e-2),
                                   number<FixedVariance>(input, 0.0, 1e-3));
      case 11:
        return moved(input);
      case 12:
        return predict_range_bearing(input);
      case 13:
      case 14:
        return pixels(input, takes_in);
      case 15:
        takes_in = true;
        return predict_pixel(input);
      case 16:
        return filter_.predict_tilt(number<FixedOffset>(input, 0.0, 1.0));
      case 17:
        return on_path(input);
      case 18:
        return framed(input);
      default:
        return filter_.update_height(id(input), number<FixedLength>(input, -1.0, 3.0),
                                     number<FixedLength>(input, 1e-3, 0.2),
                                     number<FixedScore>(input, 1.0, 11.0));
    }
  }

  Status predict(Input& input) {
    FixedIncrement increment;
    increment.distance = number<FixedOffset>(input, -0.3, 0.3);
    increment.turn = number<FixedAngle>(input, -0.3, 0.3);
    increment.distance_variance = number<FixedVariance>(input, 0.0, 1e-3);
    increment.turn_variance = number<FixedVariance>(input, 0.0, 1e-3);
    if (input.byte() > 200) increment.distance_turn = number<FixedVariance>(input, -1e-4, 1e-4);
    if (input.flag()) increment.model = IncrementModel::kExactArc;
    return filter_.predict(increment);
  }

  Status restart(Input& input) {
    FixedPoseCovariance known;
    known.position = covariance(input);
    known.heading = number<FixedVariance>(input, 0.0, 0.1);
    FixedPlanarParameters parameters;
    if (Dim == 3) {
      parameters.tilt.sigma_pitch = number<FixedAngle>(input, 0.0, 0.05);
      parameters.tilt.sigma_roll = number<FixedAngle>(input, 0.0, 0.05);
      parameters.tilt.time_constant = number<FixedOffset>(input, 0.1, 2.0);
    }
    const FixedPose pose = {number<FixedCoordinate>(input, -20.0, 20.0),
                            number<FixedCoordinate>(input, -20.0, 20.0),
                            number<FixedAngle>(input, -3.1, 3.1)};
    return filter_.initialise(pose, known, parameters);
  }

  Status add(Input& input) {
    const LandmarkId of = id(input);
    const FixedLength x = number<FixedLength>(input, 0.5, 8.0);
    const FixedLength y = number<FixedLength>(input, -4.0, 4.0);
    if constexpr (Dim == 3) {
      const FixedLength at[3] = {x, y, number<FixedLength>(input, 0.0, 3.0)};
      return filter_.add_landmark(of, at, covariance3(input));
    } else {
      return filter_.add_landmark(of, x, y, covariance(input));
    }
  }

  Status pixels(Input& input, bool& takes_in) {
    if constexpr (Dim == 3) {
      const FixedCamera seen_by = camera(input);
      const FixedMount at = mount(input);
      FixedPixelMatch matches[kLandmarks];
      const int count = input.below(kLandmarks + 1);
      for (int i = 0; i < count; ++i) {
        matches[i].id = id(input);
        for (FixedPixel& pixel : matches[i].pixel) pixel = number<FixedPixel>(input, 0.0, 640.0);
      }
      const FixedPixel sigma = number<FixedPixel>(input, 0.1, 2.0);
      FixedUpdateReport report;
      FixedVector<FixedPlannedPixel, kLandmarks> plan;
      switch (input.below(3)) {
        case 0:
          return filter_.update_pixels(seen_by, at, sigma, matches, count, report);
        case 1: {
          const Status status =
              filter_.update_pixels(seen_by, at, sigma, matches, count, random_, report);
          takes_in = status == Status::kNoConsensus;
          return status;
        }
        default: {
          takes_in = true;
          const Status status = filter_.plan_pixels(seen_by, at, sigma, plan);
          PROMISE(6, plan.size() <= filter_.landmark_count());
          return status;
        }
      }
    } else {
      return Status::kOk;
    }
  }

  Status predict_range_bearing(Input& input) {
    FixedRangeBearingPrediction prediction;
    const int of = slot(input);
    const Status status = filter_.predict_range_bearing(
        of, number<FixedLength>(input, -0.5, 0.5), number<FixedLength>(input, 1e-3, 0.3),
        number<FixedAngle>(input, 1e-3, 0.1), prediction);
    PROMISE(5, !ok(status) || !fits() || prediction.range_variance.raw() >= 0);
    return status;
  }

  /// Recognised elsewhere, and perhaps not.
  Status moved(Input& input) {
    const FixedPose pose = {number<FixedCoordinate>(input, -20.0, 20.0),
                            number<FixedCoordinate>(input, -20.0, 20.0),
                            FixedAngle::nearest(0.02 * input.byte() - 2.5)};
    const auto before = filter_.place(pose, number<FixedVariance>(input, 0.0, 1.0),
                                      number<FixedVariance>(input, 0.0, 0.1));
    if (input.flag()) filter_.put_back(before);
    static_cast<void>(filter_.recentre());
    return Status::kOk;
  }

  Status on_path(Input& input) {
    if constexpr (Dim == 3) {
      if (input.byte() < 80) return filter_.add_position(id(input));
      FixedLength at[3];
      for (FixedLength& coordinate : at) coordinate = number<FixedLength>(input, -2.0, 8.0);
      FixedLength by_path[3][2];
      for (auto& row : by_path) {
        for (FixedLength& element : row) element = number<FixedLength>(input, -2.0, 2.0);
      }
      return filter_.add_landmark_on_path(id(input), at, covariance3(input), id(input), by_path);
    } else {
      return Status::kOk;
    }
  }

  Status framed(Input& input) {
    if constexpr (Dim == 3) {
      const LandmarkId origin = id(input);
      const LandmarkId ahead = id(input);
      const int kind = input.below(3);
      if (kind == 2) {
        const Status status =
            filter_.widen_frame(origin, ahead, number<FixedVariance>(input, 0.0, 0.1),
                                number<FixedVariance>(input, 0.0, 0.01));
        if (ok(status)) static_cast<void>(filter_.framed_pose_covariance(origin, ahead));
        return status;
      }
      FixedCoordinate p[3];
      for (FixedCoordinate& coordinate : p) {
        coordinate = number<FixedCoordinate>(input, -10.0, 10.0);
      }
      return kind == 0
                 ? filter_.add_frame_position(id(input), p, covariance3(input), origin)
                 : filter_.add_framed_landmark(id(input), p, covariance3(input), origin, ahead);
    } else {
      return Status::kOk;
    }
  }

  static FixedCovariance3 covariance3(Input& input) {
    const FixedCovariance2 plane = covariance(input);
    return {plane.xx,
            plane.xy,
            plane.yy,
            {},
            number<FixedVariance>(input, 0.0, 1e-5),
            number<FixedVariance>(input, 1e-4, 0.5)};
  }

  Status predict_pixel(Input& input) {
    if constexpr (Dim == 3) {
      FixedPixelPrediction prediction;
      const int of = slot(input);
      const FixedCamera seen_by = camera(input);
      const FixedMount at = mount(input);
      constexpr FixedPixel kSigma = FixedPixel::nearest(0.5);
      return input.flag() ? filter_.predict_pixel(of, seen_by, at, kSigma, prediction)
                          : filter_.expect_pixel(of, seen_by, at, kSigma, prediction);
    } else {
      return Status::kOk;
    }
  }

  static LandmarkId id(Input& input) {
    return static_cast<LandmarkId>(input.below(kLandmarks + 3));
  }
  static int slot(Input& input) { return input.below(kLandmarks + 2) - 1; }

  /// Beyond the format the moments that are read out are what it holds.
  bool fits() const {
    FixedPose pose;
    FixedPoseCovariance known;
    filter_.pose(pose, known);
    return filter_.saturations() == 0 && known.heading.raw() < kLargestVariance;
  }

  void check() const {
    FixedPose pose;
    FixedPoseCovariance known;
    filter_.pose(pose, known);
    PROMISE(4, pose.heading <= kFixedPi && pose.heading > -kFixedPi);
    PROMISE(5, known.heading.raw() >= 0);
    PROMISE(5, !fits() || (known.position.xx.raw() >= 0 && known.position.yy.raw() >= 0));
    PROMISE(6, filter_.landmark_count() <= kLandmarks);
    for (int i = 0; i < filter_.landmark_count(); ++i) {
      const FixedLandmark landmark = filter_.landmark(i);
      PROMISE(5,
              !fits() || (landmark.covariance.xx.raw() >= 0 && landmark.covariance.yy.raw() >= 0));
      if constexpr (Dim == 3) PROMISE(5, filter_.landmark_height_variance(i).raw() >= 0);
    }
    if constexpr (Dim == 3) {
      const FixedCovariance2 tilt = filter_.tilt_covariance();
      PROMISE(5, tilt.xx.raw() >= 0 && tilt.yy.raw() >= 0);
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
  return run_one_of<Run<2, FixedError::kGroup>, Run<3, FixedError::kGroup>,
                    Run<2, FixedError::kWorld>>(bytes, size, 24);
}
