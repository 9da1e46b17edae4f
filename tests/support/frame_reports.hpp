#pragma once

#include <algorithm>
#include <vector>

#include "cairn/tracking/frame_report.hpp"

namespace cairn::test {

inline int count_cut(const std::vector<FrameReport>& reports, FrameCut cut) {
  return static_cast<int>(std::count_if(reports.begin(), reports.end(),
                                        [cut](const FrameReport& r) { return r.cut == cut; }));
}

inline int most_work(const std::vector<FrameReport>& reports) {
  int most = 0;
  for (const FrameReport& report : reports) most = std::max(most, report.work);
  return most;
}

}  // namespace cairn::test
