#include "cairn/window/focal_belief.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

constexpr double kSigma = 0.1;       // information 100
constexpr double kInformed = 500.0;  // with what the window says

FocalBelief<double> with_record() {
  FocalBelief<double> belief;
  belief.reset(kSigma);
  belief.note(1.08, kInformed, 0b1111);
  return belief;
}

TEST(FocalBelief, IsThePriorWhileTheWindowKeepsItsKeyframes) {
  const FocalBelief<double> belief = with_record();
  EXPECT_TRUE(belief.uncertain());
  EXPECT_EQ(belief.mean(), 1.0);
  EXPECT_DOUBLE_EQ(belief.information(), 100.0);
}

TEST(FocalBelief, EachKeyframeTakesItsPartAndTheLastTheRest) {
  FocalBelief<double> belief = with_record();
  belief.leave(0);
  belief.leave(2);
  EXPECT_DOUBLE_EQ(belief.information(), 300.0);
  // Information-weighted: half of 500 * 1.08 and half of 100 * 1, over 300.
  EXPECT_NEAR(belief.mean(), (250.0 * 1.08 + 50.0) / 300.0, 1e-12);
  belief.leave(1);
  belief.leave(3);
  EXPECT_DOUBLE_EQ(belief.information(), kInformed);
  EXPECT_DOUBLE_EQ(belief.mean(), 1.08);
}

TEST(FocalBelief, TakesTheNewestRecordWhileNoneOfItsKeyframesLeft) {
  FocalBelief<double> belief = with_record();
  belief.note(1.06, 700.0, 0b11111);
  EXPECT_DOUBLE_EQ(belief.information(), 100.0);
  for (int place = 0; place < 5; ++place) belief.leave(place);
  EXPECT_DOUBLE_EQ(belief.information(), 700.0);
  EXPECT_DOUBLE_EQ(belief.mean(), 1.06);
}

TEST(FocalBelief, CountsNoWindowTwice) {
  FocalBelief<double> belief = with_record();
  belief.leave(3);
  for (int again = 0; again < 10; ++again) {
    belief.note(1.2, 900.0,
                0b11110);  // the same keyframes but for one: most of it is in the record
    belief.leave(4);       // it came after the record and is not counted
  }
  EXPECT_DOUBLE_EQ(belief.information(), 200.0);
  for (const int place : {0, 1, 2, 0, 1}) belief.leave(place);
  EXPECT_DOUBLE_EQ(belief.information(), kInformed);
  EXPECT_DOUBLE_EQ(belief.mean(), 1.08);
  belief.note(1.1, 900.0, 0b11);  // other keyframes: the next record
  belief.leave(0);
  belief.leave(1);
  EXPECT_DOUBLE_EQ(belief.information(), 900.0);
}

TEST(FocalBelief, KeepsTheRecordWhenTheWindowBeginsAnew) {
  FocalBelief<double> belief = with_record();
  belief.leave(0);
  belief.leave_all();
  EXPECT_DOUBLE_EQ(belief.information(), kInformed);
  belief.leave_all();
  belief.leave(1);
  EXPECT_DOUBLE_EQ(belief.information(), kInformed);
  EXPECT_DOUBLE_EQ(belief.mean(), 1.08);
}

TEST(FocalBelief, WithoutSigmaThereIsNothingToEstimate) {
  FocalBelief<double> belief;
  belief.reset(0.0);
  EXPECT_FALSE(belief.uncertain());
  EXPECT_EQ(belief.mean(), 1.0);
}

}  // namespace
}  // namespace cairn
