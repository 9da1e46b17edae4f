#pragma once

#include "cairn/numeric/hash.hpp"
#include "cairn/runtime/frame_report.hpp"

namespace cairn::host {

/// Feeds everything of a report that the tracker decided (its ticks apart) to the run's log hash.
inline void add_to_hash(Hash64& hash, const FrameReport& report) {
  hash.add(static_cast<std::uint64_t>(report.t_us));
  hash.add(static_cast<std::uint8_t>(report.status));
  hash.add(static_cast<std::uint8_t>(report.state));
  const Quaternion<float>& q = report.T_world_camera.rotation;
  const Vector3<float>& p = report.T_world_camera.translation;
  for (const float value : {q.w(), q.x(), q.y(), q.z(), p.x(), p.y(), p.z()}) hash.add(value);
  for (const int value :
       {report.corners, report.candidates, report.matches, report.inliers, report.landmarks,
        report.searched, report.added, report.removed, report.relocalised ? 1 : 0,
        report.update.matches, report.update.hypotheses, report.update.low_innovation,
        report.update.high_innovation, report.update.gated, report.update.nis_dof}) {
    hash.add(static_cast<std::int32_t>(value));
  }
  hash.add(report.update.nis);
}

}  // namespace cairn::host
