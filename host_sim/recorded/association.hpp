#pragma once

#include <vector>

#include "host_sim/recorded/recorded_filter.hpp"
#include "host_sim/recorded/recording.hpp"

namespace cairn::host {

struct AssociationParameters {
  double gate = 9.21;            ///< a sighting belongs to a landmark within this distance
  double new_gate = 30.0;        ///< and is new only beyond this one: between them it is dropped
  double search_radius_m = 8.0;  ///< landmarks farther from the sighting are not looked at
  int most_candidates = 8;       ///< hypotheses per sighting, nearest first
  double tentative_radius_m = 1.0;
  int confirm_after = 4;        ///< sightings of a tentative landmark before it enters the state
  double forget_after_s = 2.0;  ///< without a sighting
  int most_tentative = 64;
  double largest_range_m = 35.0;
};

/// Landmarks seen, not yet in the state.
struct TentativeLandmark {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< world, by the latest pose
  int sightings = 0;
  double last_seen_s = 0.0;
};

/// What a scan means for the filter.
struct AssociatedScan {
  std::vector<RangeBearingObservation<double>> known;
  std::vector<RangeBearingObservation<double>> confirmed;  ///< new landmarks with fresh identities
  int ambiguous = 0;
};

/// Gated nearest neighbour over the whole scan: of all pairs of sighting and landmark within the
/// gate, the likeliest first, every sighting and landmark once. Sightings that fit no landmark feed
/// tentative ones. Work per scan is bounded by sightings x (landmarks + most_candidates).
class Associator {
 public:
  explicit Associator(const AssociationParameters& parameters) : parameters_(parameters) {}

  AssociatedScan associate(const RecordedScan& scan, const Recording& recording,
                           const RecordedFilter& filter);
  int tentative_count() const { return static_cast<int>(tentative_.size()); }
  std::uint64_t tentative_dropped() const { return dropped_; }

 private:
  struct Pair {
    int sighting;
    LandmarkId landmark;
    double squared;
    double cost;
  };

  void candidates(int sighting, const RangeBearingObservation<double>& observation,
                  const Eigen::Vector2d& world, double sensor_offset_m,
                  const RecordedFilter& filter, std::vector<Pair>& pairs);
  bool feed_tentative(const Eigen::Vector2d& world, double t_s);

  AssociationParameters parameters_;
  std::vector<LandmarkPosition> map_;
  std::vector<TentativeLandmark> tentative_;
  LandmarkId next_id_ = 1;
  std::uint64_t dropped_ = 0;
};

/// The observation that the filter gets for a sighting.
RangeBearingObservation<double> to_observation(const RecordedSighting& sighting,
                                               const SightingNoise& noise);

/// Point and covariance in the vehicle frame, first order.
void to_point(const RangeBearingObservation<double>& observation, double sensor_offset_m,
              Eigen::Vector2d& point, Eigen::Matrix2d& covariance);

}  // namespace cairn::host
