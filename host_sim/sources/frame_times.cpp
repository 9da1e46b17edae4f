#include "host_sim/sources/frame_times.hpp"

#include <vector>

#include <fmt/format.h>

#include "host_sim/io/csv_units.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/sources/time_span.hpp"

namespace cairn::host {

FrameTimes::FrameTimes(const std::filesystem::path& path) : path_(path) {
  CsvReader csv(path);
  const std::size_t frame = csv.column("frame");
  const TimeColumn time(csv);
  std::vector<std::int64_t> in_order;
  while (csv.next()) {
    const std::int64_t t_us = time.t_us(csv);
    const std::int64_t number = csv.integer(frame);
    if (!in_order.empty() && t_us <= in_order.back()) {
      throw InputError(path, csv.line(), "expected times in increasing order");
    }
    if (!times_.empty() && number <= times_.rbegin()->first) {
      throw InputError(path, csv.line(), "expected frame numbers in increasing order");
    }
    times_[number] = t_us;
    in_order.push_back(t_us);
  }
  if (times_.empty()) throw InputError(path, "expected a row for each frame, found none");
  check_frame_times(path, in_order);
}

std::int64_t FrameTimes::t_us(int frame) const {
  const auto found = times_.find(frame);
  if (found == times_.end()) {
    throw InputError(path_, fmt::format("expected a row for frame {}, found frames {} to {}", frame,
                                        times_.begin()->first, times_.rbegin()->first));
  }
  return found->second;
}

}  // namespace cairn::host
