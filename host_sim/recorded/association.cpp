#include "host_sim/recorded/association.hpp"

#include <algorithm>
#include <cmath>

namespace cairn::host {

RangeBearingObservation<double> to_observation(const RecordedSighting& sighting,
                                               const SightingNoise& noise) {
  RangeBearingObservation<double> observation;
  observation.id = static_cast<LandmarkId>(sighting.landmark);
  observation.range = sighting.range_m;
  observation.bearing = sighting.bearing_rad;
  observation.sigma_range = noise.range_sigma_m + noise.range_sigma_per_m * sighting.range_m;
  observation.sigma_bearing = noise.bearing_sigma_rad;
  return observation;
}

void to_point(const RangeBearingObservation<double>& observation, double sensor_offset_m,
              Eigen::Vector2d& point, Eigen::Matrix2d& covariance) {
  const Eigen::Vector2d along(std::cos(observation.bearing), std::sin(observation.bearing));
  const Eigen::Vector2d across(-along.y(), along.x());
  point = observation.range * along + Eigen::Vector2d(sensor_offset_m, 0.0);
  const double across_sigma = observation.range * observation.sigma_bearing;
  covariance = observation.sigma_range * observation.sigma_range * along * along.transpose() +
               across_sigma * across_sigma * across * across.transpose();
  covariance(1, 0) = covariance(0, 1);
}

void Associator::candidates(int sighting, const RangeBearingObservation<double>& observation,
                            const Eigen::Vector2d& world, double sensor_offset_m,
                            const RecordedFilter& filter, std::vector<Pair>& pairs) {
  std::vector<std::pair<double, LandmarkId>> near;
  for (const auto& landmark : map_) {
    const double distance = (landmark.position - world).norm();
    if (distance < parameters_.search_radius_m) near.emplace_back(distance, landmark.id);
  }
  const auto count = std::min(near.size(), static_cast<std::size_t>(parameters_.most_candidates));
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
  for (std::size_t k = 0; k < count; ++k) {
    RangeBearingObservation<double> hypothesis = observation;
    hypothesis.id = near[k].second;
    Pair pair{sighting, near[k].second, 0.0, 0.0};
    double log_determinant = 0.0;
    if (!filter.distance(hypothesis, sensor_offset_m, pair.squared, log_determinant)) continue;
    pair.cost = pair.squared + log_determinant;
    pairs.push_back(pair);
  }
}

bool Associator::feed_tentative(const Eigen::Vector2d& world, double t_s) {
  TentativeLandmark* nearest = nullptr;
  double best = parameters_.tentative_radius_m;
  for (auto& candidate : tentative_) {
    const double distance = (candidate.position - world).norm();
    if (distance < best) {
      best = distance;
      nearest = &candidate;
    }
  }
  if (nearest == nullptr) {
    if (static_cast<int>(tentative_.size()) >= parameters_.most_tentative) {
      ++dropped_;
      return false;
    }
    tentative_.push_back({world, 1, t_s});
    return false;
  }
  nearest->position = world;
  nearest->last_seen_s = t_s;
  if (++nearest->sightings < parameters_.confirm_after) return false;
  *nearest = tentative_.back();
  tentative_.pop_back();
  return true;
}

AssociatedScan Associator::associate(const RecordedScan& scan, const Recording& recording,
                                     const RecordedFilter& filter) {
  AssociatedScan result;
  const auto stale = [&](const TentativeLandmark& candidate) {
    return scan.t_s - candidate.last_seen_s > parameters_.forget_after_s;
  };
  const auto kept = std::remove_if(tentative_.begin(), tentative_.end(), stale);
  dropped_ += static_cast<std::uint64_t>(tentative_.end() - kept);
  tentative_.erase(kept, tentative_.end());
  filter.positions(map_);

  const auto pose = filter.mean_pose();
  const Eigen::Matrix2d to_world = rotation2(pose.heading);
  const auto count = scan.sightings.size();
  std::vector<RangeBearingObservation<double>> observations(count);
  std::vector<Eigen::Vector2d> world(count);
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    if (scan.sightings[i].range_m > parameters_.largest_range_m) continue;
    observations[i] = to_observation(scan.sightings[i], recording.noise);
    Eigen::Vector2d point;
    Eigen::Matrix2d covariance;
    to_point(observations[i], recording.sensor_offset_m, point, covariance);
    world[i] = pose.position + to_world * point;
    candidates(static_cast<int>(i), observations[i], world[i], recording.sensor_offset_m, filter,
               pairs);
  }

  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    if (a.cost != b.cost) return a.cost < b.cost;
    return a.sighting != b.sighting ? a.sighting < b.sighting : a.landmark < b.landmark;
  });
  std::vector<bool> taken(count, false);
  std::vector<bool> near_landmark(count, false);
  std::vector<LandmarkId> used;
  for (const auto& pair : pairs) {
    const auto i = static_cast<std::size_t>(pair.sighting);
    if (pair.squared < parameters_.new_gate) near_landmark[i] = true;
    if (taken[i] || pair.squared > parameters_.gate) continue;
    if (std::find(used.begin(), used.end(), pair.landmark) != used.end()) continue;
    taken[i] = true;
    used.push_back(pair.landmark);
    observations[i].id = pair.landmark;
    result.known.push_back(observations[i]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (taken[i] || scan.sightings[i].range_m > parameters_.largest_range_m) continue;
    if (near_landmark[i]) {
      ++result.ambiguous;
    } else if (feed_tentative(world[i], scan.t_s)) {
      observations[i].id = next_id_++;
      result.confirmed.push_back(observations[i]);
    }
  }
  return result;
}

}  // namespace cairn::host
