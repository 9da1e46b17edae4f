#include <cstring>

#include "cairn/runtime/replay.hpp"

namespace cairn {

void add_to_hash(Hash64& hash, const FrameReport& report) {
  hash.add(report.t_us);
  hash.add(static_cast<std::uint8_t>(report.status));
  hash.add(static_cast<std::uint8_t>(report.state));
  hash.add(static_cast<std::uint8_t>(report.cut));
  const Quaternion<float>& q = report.T_map_camera.rotation;
  const Vector3<float>& p = report.T_map_camera.translation;
  for (const float value : {q.w(), q.x(), q.y(), q.z(), p.x(), p.y(), p.z()}) hash.add(value);
  for (const int value :
       {report.corners, report.candidates, report.matches, report.inliers, report.landmarks,
        report.searched, report.added, report.removed, report.reactivated, report.from_library,
        report.relocalised ? 1 : 0, report.work, report.update.matches, report.update.hypotheses,
        report.update.low_innovation, report.update.high_innovation, report.update.gated,
        report.update.nis_dof}) {
    hash.add(value);
  }
  hash.add(report.update.nis);
}

void add_to_hash(Hash64& hash, const Health& health) {
  // Every field is a 32-bit counter: one after the other, so that a new one cannot be forgotten.
  static_assert(sizeof(Health) % sizeof(std::uint32_t) == 0, "counters of 32 bits alone");
  std::uint32_t counters[sizeof(Health) / sizeof(std::uint32_t)];
  std::memcpy(counters, &health, sizeof counters);
  for (const std::uint32_t counter : counters) hash.add(counter);
}

}  // namespace cairn
