#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace cairn::host {

/// Pictures as faulty cameras and cables give them; each of the size of `picture`, which it leaves
/// as it is.
cv::Mat flat(const cv::Mat& picture, int grey);
cv::Mat noise(const cv::Mat& picture, std::uint64_t seed);
/// Read-out noise of a few grey levels.
cv::Mat grain(const cv::Mat& picture, std::uint64_t seed);
cv::Mat dimmed(const cv::Mat& picture, double factor);
cv::Mat checkerboard(const cv::Mat& picture, int square_px);
/// Its upper left part of `tile_px` over and over: every place looks like every other.
cv::Mat tiled(const cv::Mat& picture, int tile_px);
cv::Mat mirrored(const cv::Mat& picture);
/// Below the middle `other` in its place.
cv::Mat torn(const cv::Mat& picture, const cv::Mat& other);
/// Each row is shifted by one pixel more than the one above: a wrong stride.
cv::Mat skewed(const cv::Mat& picture);
cv::Mat flipped_bits(const cv::Mat& picture, int count, std::uint64_t seed);
cv::Mat half_black(const cv::Mat& picture);
/// Twelve dark spots that stay where they are.
cv::Mat dirty(const cv::Mat& picture);

}  // namespace cairn::host
