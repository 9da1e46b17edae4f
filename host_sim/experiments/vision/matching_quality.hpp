#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "host_sim/base/shard.hpp"

namespace cairn::host {

/// One pair of images.
struct PairQuality {
  std::string group;            ///< kind of change between the two
  std::vector<double> percent;  ///< right, of each method
};

struct QualityResult {
  std::string method;
  std::string group;           ///< kind of change between the two images
  double correct_percent = 0;  ///< nearest neighbours that are right
  int pairs = 0;               ///< image pairs in the mean
};

/// Nearest-neighbour correctness of descriptors between two views of the same scene. Queries: the
/// 300 strongest corners of the first image that are detected again within 2.5 px of their true
/// place; candidates: the 1,000 strongest corners of the second. Steered methods are told the true
/// relative roll and scale at each point, or these with errors.
///
/// Pairs: synthetic warps of the first image of each set (rotation, scale, blur, noise,
/// perspective) and the recorded pairs of graf, with their homographies. `homography_sets` holds
/// graf/ and churchill/ as published. Only the pairs of `shard`, by number. Throws InputError.
/// Deterministic.
std::map<int, PairQuality> measure_matching_quality(const std::filesystem::path& homography_sets,
                                                    const Shard& shard);

/// Means over the pairs of each group.
std::vector<QualityResult> mean_quality(const std::vector<PairQuality>& pairs);

/// Columns method,group,correct_percent,pairs.
void write_quality(const std::vector<QualityResult>& results, const std::filesystem::path& file);

/// Methods down, groups across, means at the right.
std::string quality_table(const std::vector<QualityResult>& results);

}  // namespace cairn::host
