#pragma once

#include <vector>

#include <nlohmann/json.hpp>

namespace cairn::host {

/// Percentiles, maximum and mean of `values_ms`, and the share above `limit_ms` as `over_budget`.
nlohmann::json latency_json(const std::vector<double>& values_ms, double limit_ms);

/// First line of frames.csv of every run.
inline constexpr const char* kFramesHeader =
    "frame,t_us,status,preprocess_ms,pose_prediction_ms,features_ms,pose_update_ms,render_ms,"
    "total_ms,corners,candidates,matches,inliers,landmarks,registration_px\n";

}  // namespace cairn::host
