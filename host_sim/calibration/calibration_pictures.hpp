#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include <opencv2/core.hpp>

namespace cairn::host {

/// Takes the pictures that are worth a search for the board, as 8-bit grey of one size: all of a
/// folder in the order of their names, or of a video the sharpest frame of every slot of time, at
/// most `most` slots. `take` gets the picture's name ("frame 120") and how many will come at most.
/// Throws InputError naming the file for what cannot be read and for a second size.
void take_calibration_pictures(
    const std::filesystem::path& media, int most,
    const std::function<void(const std::string& name, const cv::Mat& grey, int expected)>& take);

}  // namespace cairn::host
