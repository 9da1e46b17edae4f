// Monte-Carlo drives of the planar filter in integers alone, world, odometry and sensors as well:
// one line for each seed with a hash over every update's state. The same text on every target; one
// without a floating-point unit runs it without emulating any.

#include "cairn/numeric/random.hpp"

#include "filters.hpp"
#include "tests/target/text.hpp"

namespace {

using cairn_test::write;
using cairn_test::write_decimal;

constexpr int kWorldLandmarks = 80;
constexpr int kSeeds = 4;
constexpr int kUpdates = 60;

cairn_test::PlaneFilter group_filter;
cairn_test::PlaneEkf ekf;
cairn_test::CameraFilter camera_filter;

constexpr int kUnit = cairn::FixedLength::kFractionBits;

cairn::FixedVariance variance(int bits) {
  return cairn::FixedVariance::from_raw(std::int64_t{1} << bits);
}

/// A car that drives circles of about 6 m through a square of 24 m with landmarks anywhere.
class World {
 public:
  /// `left_m`: by which the landmarks lie to the left of the start, where the circles are.
  explicit World(std::uint64_t seed, int left_m = 0) : random_(seed) {
    for (auto& landmark : landmarks_) {
      for (int i = 0; i < 2; ++i) landmark[i] = noise(kUnit + 4) * 3 / 2;
      landmark[1] += std::int64_t{left_m} << kUnit;
      landmark[2] = random_.below(5 << (kUnit - 1));
    }
  }

  static cairn::FixedPoseCovariance start() {
    cairn::FixedPoseCovariance covariance;
    covariance.position = {variance(34), {}, variance(34)};
    covariance.heading = variance(32);
    return covariance;
  }

  /// The odometry of one step.
  cairn::FixedIncrement step() {
    cairn::FixedIncrement step;
    const std::int32_t distance = 1 << 21;  // 0.125 m
    const std::int32_t turn = 5600000;      // 0.021 rad
    step.distance = cairn::FixedOffset::from_raw(distance + noise(18));
    step.turn = cairn::FixedAngle::from_raw(turn + noise(20));
    step.distance_variance = variance(28);
    step.turn_variance = variance(24);
    step.model = cairn::IncrementModel::kExactArc;
    cairn::FixedRatio sine;
    cairn::FixedRatio cosine;
    sin_cos(cairn::wrapped_angle(heading_.raw() + std::int64_t{turn} / 2), sine, cosine);
    x_[0] += (std::int64_t{cosine.raw()} * distance) >> (30 + 24 - kUnit);
    x_[1] += (std::int64_t{sine.raw()} * distance) >> (30 + 24 - kUnit);
    heading_ = cairn::wrapped_angle(std::int64_t{heading_.raw()} + turn);
    for (cairn::FixedAngle* angle : {&tilt_.pitch, &tilt_.roll}) {
      *angle = cairn::FixedAngle::from_raw(angle->raw() - angle->raw() / 8 + noise(22));
    }
    return step;
  }

  /// Near enough to normal, within +-2^(bits - 1).
  std::int32_t noise(int bits) {
    std::int32_t sum = 0;
    for (int i = 0; i < 4; ++i) sum += random_.below(1 << (bits - 2)) - (1 << (bits - 3));
    return sum;
  }
  bool one_in_four() { return random_.below(4) == 0; }
  /// A landmark from the vehicle, in the world's axes.
  void relative(int landmark, cairn::FixedLength (&r)[3]) const {
    for (int i = 0; i < 3; ++i) {
      const std::int64_t from = i < 2 ? x_[i] : 0;
      r[i] =
          cairn::FixedLength::from_raw(static_cast<std::int32_t>(landmarks_[landmark][i] - from));
    }
  }
  /// In the vehicle's, where it is nearer than 8 m and farther than 1 m.
  bool seen(int landmark, std::int32_t (&y)[2]) const {
    constexpr std::int64_t kFar = std::int64_t{8} << kUnit;
    constexpr std::int64_t kNear = std::int64_t{1} << kUnit;
    cairn::FixedLength r[3];
    relative(landmark, r);
    const std::int64_t d[2] = {r[0].raw(), r[1].raw()};
    const std::int64_t squared = d[0] * d[0] + d[1] * d[1];
    if (squared > kFar * kFar || squared < kNear * kNear) return false;
    cairn::FixedRatio sine;
    cairn::FixedRatio cosine;
    sin_cos(heading_, sine, cosine);
    y[0] = static_cast<std::int32_t>((d[0] * cosine.raw() + d[1] * sine.raw()) >> 30);
    y[1] = static_cast<std::int32_t>((d[1] * cosine.raw() - d[0] * sine.raw()) >> 30);
    return true;
  }
  cairn::FixedAngle heading() const { return heading_; }
  const cairn::FixedTilt& tilt() const { return tilt_; }

 private:
  cairn::Random random_;
  std::int64_t landmarks_[kWorldLandmarks][3] = {};
  std::int64_t x_[2] = {};
  cairn::FixedAngle heading_;
  cairn::FixedTilt tilt_;
};

/// Sightings used, or -1. Even turns by points, odd ones by range and bearing.
template <class Filter>
int look(Filter& filter, World& world, int turn) {
  cairn::FixedPointObservation points[kWorldLandmarks];
  cairn::FixedRangeBearingObservation ranges[kWorldLandmarks];
  int count = 0;
  for (int i = 0; i < kWorldLandmarks; ++i) {
    std::int32_t y[2];
    if (!world.seen(i, y)) continue;
    const auto id = static_cast<cairn::LandmarkId>(i + 1);
    cairn::FixedPointObservation& point = points[count];
    point.id = id;
    point.x = cairn::FixedLength::from_raw(y[0] + world.noise(16));
    point.y = cairn::FixedLength::from_raw(y[1] + world.noise(16));
    point.noise = {variance(34), variance(32), variance(33)};
    if (filter.find(id) < 0) {
      const cairn::Status status = filter.add_landmark(id, point.x, point.y, point.noise);
      if (!ok(status) && status != cairn::Status::kFull) return -1;
      continue;
    }
    const cairn::FixedRoot range =
        cairn::square_root(std::int64_t{y[0]} * y[0] + std::int64_t{y[1]} * y[1], 2 * kUnit);
    cairn::FixedRangeBearingObservation& seen = ranges[count];
    seen.id = id;
    seen.range =
        cairn::FixedLength::from_raw((range.mantissa >> (range.bits - kUnit)) + world.noise(16));
    seen.bearing =
        cairn::wrapped_angle(std::int64_t{cairn::fixed_atan2(y[1], y[0]).raw()} + world.noise(22));
    seen.sigma_range = cairn::FixedLength::from_raw(1 << 15);
    seen.sigma_bearing = cairn::FixedAngle::from_raw(1 << 21);
    ++count;
  }
  cairn::FixedUpdateReport report;
  const cairn::Status status = turn % 2 == 0
                                   ? filter.update_points({points, count}, report)
                                   : filter.update_range_bearing({ranges, count}, {}, report);
  return ok(status) ? report.nis_dof / 2 : -1;
}

/// 1 m high on the vehicle, looks ahead.
struct Eye {
  cairn::FixedCamera camera;
  cairn::FixedMount mount;

  Eye() {
    camera.width = 320;
    camera.height = 240;
    camera.fx = camera.fy = cairn::FixedPixel::from_raw(200 << 16);
    camera.cx = cairn::FixedPixel::from_raw(160 << 16);
    camera.cy = cairn::FixedPixel::from_raw(120 << 16);
    camera.k1 = cairn::FixedTangent::from_raw(-(1 << 25));
    mount.w = mount.y = cairn::FixedRatio::from_raw(1 << 29);
    mount.x = mount.z = cairn::FixedRatio::from_raw(-(1 << 29));
    mount.origin[2] = cairn::FixedLength::from_raw(1 << kUnit);
  }
  cairn::detail::FixedCameraView view(const World& world) const {
    cairn::FixedRatio sine;
    cairn::FixedRatio cosine;
    sin_cos(world.heading(), sine, cosine);
    std::uint32_t none = 0;
    return {camera, mount, cosine, sine, &world.tilt(), none};
  }
};

/// What the camera sees of a landmark.
struct InView {
  std::int32_t y[2];  ///< in the vehicle's axes
  cairn::FixedLength r[3];
  cairn::detail::FixedPixelRows rows;

  bool look(const World& world, const cairn::detail::FixedCameraView& view, int landmark) {
    std::uint32_t none = 0;
    world.relative(landmark, r);
    return world.seen(landmark, y) && view.linearise(r, rows, none) &&
           view.camera->contains(rows.pixel);
  }
};

/// Whether there is room for another landmark once one that is out of view has left a full map.
bool make_room(const World& world, const cairn::detail::FixedCameraView& view) {
  auto& filter = camera_filter;
  for (int slot = 0; slot < filter.landmark_count(); ++slot) {
    if (filter.landmark_count() < cairn_test::CameraFilter::kMaxLandmarks) return true;
    InView seen;
    const auto landmark = static_cast<int>(filter.landmark_id(slot)) - 1;
    if (!seen.look(world, view, landmark)) return ok(filter.remove_landmark(slot));
  }
  return true;
}

/// The same with a camera. `draws`: one pixel in four is anywhere, and a consensus decides.
int look_by_camera(World& world, cairn::Random* draws) {
  const Eye eye;
  const cairn::detail::FixedCameraView view = eye.view(world);
  cairn::FixedPixelMatch matches[kWorldLandmarks];
  int count = 0;
  for (int i = 0; i < kWorldLandmarks; ++i) {
    InView seen;
    if (!seen.look(world, view, i)) continue;
    const auto id = static_cast<cairn::LandmarkId>(i + 1);
    if (camera_filter.find(id) < 0) {
      if (draws != nullptr && !make_room(world, view)) return -1;
      const cairn::FixedLength at[3] = {
          cairn::FixedLength::from_raw(seen.y[0] + world.noise(16)),
          cairn::FixedLength::from_raw(seen.y[1] + world.noise(16)),
          cairn::FixedLength::from_raw(seen.r[2].raw() + world.noise(16))};
      const cairn::FixedCovariance3 noise = {variance(34), variance(32), variance(33),
                                             {},           variance(31), variance(33)};
      const cairn::Status status = camera_filter.add_landmark(id, at, noise);
      if (!ok(status) && status != cairn::Status::kFull) return -1;
      continue;
    }
    cairn::FixedPixelMatch& match = matches[count++];
    match.id = id;
    const bool anywhere = draws != nullptr && world.one_in_four();
    for (int k = 0; k < 2; ++k) {
      match.pixel[k] =
          cairn::FixedPixel::from_raw(seen.rows.pixel[k].raw() + world.noise(anywhere ? 24 : 18));
    }
  }
  cairn::FixedUpdateReport report;
  const auto sigma = cairn::FixedPixel::from_raw(1 << 16);
  const cairn::Status status =
      draws == nullptr
          ? camera_filter.update_pixels(eye.camera, eye.mount, sigma, matches, count, report)
          : camera_filter.update_pixels(eye.camera, eye.mount, sigma, matches, count, *draws,
                                        report);
  return ok(status) || status == cairn::Status::kNoConsensus ? report.nis_dof / 2 : -1;
}

template <class AnyFilter>
bool move(AnyFilter& any, World& world) {
  for (int i = 0; i < 3; ++i) {
    if (!ok(any.predict(world.step()))) return false;
  }
  return ok(any.predict_tilt(cairn::FixedOffset::from_raw(1 << 22)));
}

template <class AnyFilter, class Look>
bool run(const char* name, int seed, AnyFilter& any, const Look& look_around,
         bool outliers = false) {
  World world(static_cast<std::uint64_t>(seed), outliers ? 6 : 0);
  cairn::FixedPlanarParameters parameters;
  if (outliers) parameters.gate = cairn::FixedScore::most();
  if (AnyFilter::kLandmarkDim == 3) {
    parameters.tilt.sigma_pitch = cairn::FixedAngle::from_raw(1 << 21);
    parameters.tilt.sigma_roll = cairn::FixedAngle::from_raw(1 << 21);
  }
  if (!ok(any.initialise({}, World::start(), parameters))) return false;
  cairn::Hash64 hash;
  int used = 0;
  for (int k = 0; k < kUpdates; ++k) {
    if (!move(any, world)) return false;
    const int seen = look_around(world, k);
    if (seen < 0) return false;
    used += seen;
    any.hash(hash);
  }
  cairn::FixedPose pose;
  cairn::FixedPoseCovariance covariance;
  any.pose(pose, covariance);
  hash.add(pose.x.raw());
  hash.add(covariance.position.xx.raw());
  write(name);
  write(" ");
  write_decimal(static_cast<std::uint64_t>(seed));
  write(" landmarks ");
  write_decimal(static_cast<std::uint64_t>(any.landmark_count()));
  write(" used ");
  write_decimal(static_cast<std::uint64_t>(used));
  write(" saturated ");
  write_decimal(any.saturations());
  write(" hash ");
  cairn_test::write_hex64(hash.value());
  write("\n");
  return any.saturations() == 0 && used > kUpdates;
}

}  // namespace

int main() {
  bool good = true;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const auto by_points_and_ranges = [](auto& filter) {
      return [&filter](World& world, int turn) { return look(filter, world, turn); };
    };
    good = run("plane", seed, group_filter, by_points_and_ranges(group_filter)) && good;
    good = run("ekf", seed, ekf, by_points_and_ranges(ekf)) && good;
    good = run("camera", seed, camera_filter,
               [](World& world, int) { return look_by_camera(world, nullptr); }) &&
           good;
  }
  for (int seed = 1; seed <= kSeeds; ++seed) {
    cairn::Random draws(static_cast<std::uint64_t>(seed));
    const auto by_consensus = [&draws](World& world, int) { return look_by_camera(world, &draws); };
    good = run("consensus", seed, camera_filter, by_consensus, true) && good;
  }
  return good ? 0 : 1;
}
