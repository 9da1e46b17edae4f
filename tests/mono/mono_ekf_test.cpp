#include "cairn/mono/mono_ekf.hpp"

#include <gtest/gtest.h>

namespace cairn {
template class MonoEkf<float, 32>;
template class MonoEkf<double, 30>;
namespace {
TEST(MonoEkf, Sizes) {
  printf("sizeof %zu states %d\n", sizeof(MonoEkf<float, 30>), MonoEkf<float, 30>::kMaxStates);
}
}  // namespace
}  // namespace cairn
