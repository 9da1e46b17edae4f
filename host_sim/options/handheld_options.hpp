#pragma once

#include <optional>
#include <string>

namespace cairn::host {

/// What a handheld run changes about the tracker.
struct HandheldOptions {
  std::string measurement;             ///< patch or freak; empty: the tracker's own
  std::optional<int> corner_score;     ///< least FAST score of a new landmark
  std::optional<double> sigma_px;      ///< of a measured pixel
  double focal_error = 0.0;            ///< share by which the tracker's focal length is made wrong
  bool estimate_focal_length = false;  ///< mono alone
  /// Window alone: how well the focal length is known, relative. Empty: as the source says, else
  /// the tracker's own.
  std::optional<double> focal_sigma;
  /// Window alone: time from a row of the picture to the next, s. Empty: as the source says.
  std::optional<double> row_time_s;

  bool is_default() const { return is_in_log() && !focal_sigma && !row_time_s; }
  /// Whether an input log says all of it.
  bool is_in_log() const {
    return measurement.empty() && !corner_score && !sigma_px && focal_error == 0.0 &&
           !estimate_focal_length;
  }
};

}  // namespace cairn::host
