#include "cairn/tracking/systematic_error.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace cairn {
namespace {

TEST(SystematicError, ScalesAndTurnsAboutTheStart) {
  const SystematicError error = {0.03F, 0.01F, 0.0F};
  const Matrix3<float> covariance = error.covariance(Vector2<float>(10.0F, 0.0F));
  EXPECT_NEAR(covariance(0, 0), square(0.3F), 1e-6F);
  EXPECT_NEAR(covariance(1, 1), square(0.1F), 1e-6F);
  EXPECT_NEAR(covariance(2, 2), square(0.01F), 1e-9F);
  EXPECT_EQ(covariance(0, 1), 0.0F);
  const Matrix3<float> aside = error.covariance(Vector2<float>(0.0F, -10.0F));
  EXPECT_NEAR(aside(0, 0), square(0.1F), 1e-6F);
  EXPECT_NEAR(aside(1, 1), square(0.3F), 1e-6F);
}

TEST(SystematicError, LeavesTheOriginsOwnAtTheStart) {
  const Matrix3<float> covariance = SystematicError{}.covariance(Vector2<float>::Zero());
  EXPECT_NEAR(covariance(0, 0), square(0.01F), 1e-8F);
  EXPECT_NEAR(covariance(1, 1), square(0.01F), 1e-8F);
}

TEST(SystematicError, IsCheckedWhole) {
  EXPECT_TRUE(ok(SystematicError{}.validate()));
  EXPECT_TRUE(ok(SystematicError{0.0F, 0.0F, 0.0F}.validate()));
  const float bad[] = {-1.0F, std::numeric_limits<float>::quiet_NaN(),
                       std::numeric_limits<float>::infinity()};
  for (const float value : bad) {
    EXPECT_EQ((SystematicError{value, 0.0F, 0.0F}.validate()), Status::kBadConfig);
    EXPECT_EQ((SystematicError{0.0F, value, 0.0F}.validate()), Status::kBadConfig);
    EXPECT_EQ((SystematicError{0.0F, 0.0F, value}.validate()), Status::kBadConfig);
  }
}

}  // namespace
}  // namespace cairn
