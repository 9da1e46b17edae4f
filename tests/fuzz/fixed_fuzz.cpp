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
    PROMISE(1, ok(filter_.initialise({}, {}, parameters)));
  }

  void step(Input& input) {
    const std::uint64_t before = hash();
    const NoAllocation none;
    // A prediction may take in the odometry's noise, whether the landmark is in view or not.
    bool takes_in = false;
    const Status status = call(input, takes_in);
    PROMISE(3, ok(status) || takes_in || hash() == before);
    check();
  }

 private:
  Status call(Input& input, bool& takes_in) {
    FixedUpdateReport report;
    switch (input.below(Dim == 3 ? 14 : 9)) {
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
      case 10:
        return pixels(input);
      case 11:
        takes_in = true;
        return predict_pixel(input);
      case 12:
        return filter_.predict_tilt(number<FixedOffset>(input, 0.0, 1.0));
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
    const FixedCovariance2 noise = covariance(input);
    if constexpr (Dim == 3) {
      const FixedLength at[3] = {x, y, number<FixedLength>(input, 0.0, 3.0)};
      return filter_.add_landmark(of, at,
                                  {noise.xx,
                                   noise.xy,
                                   noise.yy,
                                   {},
                                   number<FixedVariance>(input, 0.0, 1e-5),
                                   number<FixedVariance>(input, 1e-4, 0.5)});
    } else {
      return filter_.add_landmark(of, x, y, noise);
    }
  }

  Status pixels(Input& input) {
    if constexpr (Dim == 3) {
      const FixedCamera seen_by = camera(input);
      const FixedMount at = mount(input);
      FixedPixelMatch matches[kLandmarks];
      const int count = input.below(kLandmarks + 1);
      for (int i = 0; i < count; ++i) {
        matches[i].id = id(input);
        for (FixedPixel& pixel : matches[i].pixel) pixel = number<FixedPixel>(input, 0.0, 640.0);
      }
      FixedUpdateReport report;
      return filter_.update_pixels(seen_by, at, number<FixedPixel>(input, 0.1, 2.0), matches, count,
                                   report);
    } else {
      return Status::kOk;
    }
  }

  Status predict_pixel(Input& input) {
    if constexpr (Dim == 3) {
      FixedPixelPrediction prediction;
      const int of = slot(input);
      const FixedCamera seen_by = camera(input);
      return filter_.predict_pixel(of, seen_by, mount(input), FixedPixel::nearest(0.5), prediction);
    } else {
      return Status::kOk;
    }
  }

  static LandmarkId id(Input& input) {
    return static_cast<LandmarkId>(input.below(kLandmarks + 3));
  }
  static int slot(Input& input) { return input.below(kLandmarks + 2) - 1; }

  std::uint64_t hash() const {
    Hash64 sum;
    filter_.hash(sum);
    return sum.value();
  }

  void check() const {
    FixedPose pose;
    FixedPoseCovariance known;
    filter_.pose(pose, known);
    PROMISE(4, pose.heading <= kFixedPi && pose.heading > -kFixedPi);
    PROMISE(5, known.heading.raw() >= 0);
    // Beyond the format the moments that are read out are what it holds.
    const bool fits = filter_.saturations() == 0 && known.heading.raw() < kLargestVariance;
    PROMISE(5, !fits || (known.position.xx.raw() >= 0 && known.position.yy.raw() >= 0));
    PROMISE(6, filter_.landmark_count() <= kLandmarks);
    for (int i = 0; i < filter_.landmark_count(); ++i) {
      const FixedLandmark landmark = filter_.landmark(i);
      PROMISE(5, !fits || (landmark.covariance.xx.raw() >= 0 && landmark.covariance.yy.raw() >= 0));
      if constexpr (Dim == 3) PROMISE(5, filter_.landmark_height_variance(i).raw() >= 0);
    }
    if constexpr (Dim == 3) {
      const FixedCovariance2 tilt = filter_.tilt_covariance();
      PROMISE(5, tilt.xx.raw() >= 0 && tilt.yy.raw() >= 0);
    }
  }

  Filter filter_;
};

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn;
  using namespace cairn::fuzz;
  return run_one_of<Run<2, FixedError::kGroup>, Run<3, FixedError::kGroup>,
                    Run<2, FixedError::kWorld>>(bytes, size);
}
