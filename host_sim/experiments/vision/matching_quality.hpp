#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cairn::host {

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
/// graf/ and churchill/ as published. Throws InputError. Deterministic.
std::vector<QualityResult> measure_matching_quality(const std::filesystem::path& homography_sets);

/// Columns method,group,correct_percent,pairs.
void write_quality(const std::vector<QualityResult>& results, const std::filesystem::path& file);

/// Methods down, groups across, means at the right.
std::string quality_table(const std::vector<QualityResult>& results);

}  // namespace cairn::host
