#pragma once

#include <cstdint>

#include <rapidcheck.h>

namespace cairn {

__extension__ using Int128 = __int128;

/// Any operand, of every size alike, the extremes among them.
inline rc::Gen<std::int64_t> operand() {
  return rc::gen::map(rc::gen::pair(rc::gen::arbitrary<std::uint64_t>(), rc::gen::inRange(0, 66)),
                      [](const std::pair<std::uint64_t, int>& drawn) {
                        if (drawn.second == 64) return INT64_MAX;
                        if (drawn.second == 65) return INT64_MIN;
                        return static_cast<std::int64_t>(drawn.first) >> drawn.second;
                      });
}
/// The same within +-(2^bits - 1).
inline rc::Gen<std::int64_t> operand_of(int bits) {
  return rc::gen::map(operand(), [bits](std::int64_t drawn) {
    const std::int64_t most = (std::int64_t{1} << bits) - 1;
    return drawn > most || drawn < -most ? drawn % (most + 1) : drawn;
  });
}

inline Int128 magnitude128(Int128 value) {
  return value < 0 ? -value : value;
}

}  // namespace cairn
