#include "host_sim/reports/calibration_summary.hpp"

#include <cmath>

#include "host_sim/reports/gyro_meaning.hpp"

namespace cairn::host {

using nlohmann::json;

namespace {

constexpr double kDegrees = 180.0 / kPi<double>;

}  // namespace

json mount_json(const RunRecord& record) {
  if (!record.mount.has_value()) return nullptr;
  const auto part = [&](MountOffset::Part which, double unit) {
    return json{{"off", unit * static_cast<double>(record.mount->value[which])},
                {"sigma", unit * static_cast<double>(record.mount->sigma[which])},
                {"suspect", record.mount->suspect[which]}};
  };
  return {
      {"yaw_deg", part(MountOffset::kYaw, kDegrees)},
      {"pitch_deg", part(MountOffset::kPitch, kDegrees)},
      {"roll_deg", part(MountOffset::kRoll, kDegrees)},
      {"focal_percent", part(MountOffset::kFocal, 100.0)},
      {"first_suspect_frame",
       record.mount_suspect_frame.has_value() ? json(*record.mount_suspect_frame) : json(nullptr)}};
}

json ground_json(const RunRecord& record) {
  if (!record.ground.has_value()) return nullptr;
  const float ratio = record.ground->ratio();
  return {{"ratio", ratio > 0.0F ? json(ratio) : json(nullptr)},
          {"suspect", record.ground->suspect()},
          {"suspect_frames", record.health.ground_suspicions}};
}

json focal_json(const RunRecord& record) {
  if (!record.focal.has_value()) return nullptr;
  return {{"value", record.focal->value},
          {"sigma", record.focal->sigma},
          {"told_sigma", record.focal->told_sigma}};
}

json yaw_json(const RunRecord& record) {
  if (!record.yaw.has_value()) return nullptr;
  const float ratio = record.yaw->ratio();
  return {{"ratio", ratio != 0.0F ? json(ratio) : json(nullptr)},
          {"suspect", record.yaw->suspect()},
          {"suspect_frames", record.health.yaw_suspicions}};
}

json travel_json(const RunRecord& record) {
  if (!record.travel.has_value()) return nullptr;
  return {{"left_deg", kDegrees * static_cast<double>(record.travel->angle_rad)},
          {"sigma_deg", kDegrees * std::sqrt(static_cast<double>(record.travel->variance))}};
}

json gyro_json(const RunRecord& record) {
  if (!record.gyro.has_value()) return nullptr;
  const GyroReport& gyro = *record.gyro;
  const char* const kTrust[] = {"unproven", "agrees", "contradicted"};
  return {{"trust", kTrust[static_cast<int>(gyro.trust)]},
          {"meaning", meaning_of_gyro(gyro)},
          {"turns", gyro.ways},
          {"difference", gyro.difference},
          {"bias_radps", {gyro.bias_radps.x(), gyro.bias_radps.y(), gyro.bias_radps.z()}},
          {"bias_sigma_radps", gyro.bias_sigma_radps},
          {"late_s", gyro.time_offset_s},
          {"late_sigma_s", gyro.time_offset_sigma_s},
          {"samples", gyro.samples},
          {"refused", gyro.refused},
          {"saturated", gyro.saturated},
          {"gaps", gyro.gaps}};
}

}  // namespace cairn::host
