#include "host_sim/sources/gyro_source.hpp"

#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "input_messages.hpp"

namespace cairn::host {
namespace {

using Times = std::vector<std::int64_t>;

/// Frames without pictures at some times.
class ListedFrames final : public FrameSource {
 public:
  ListedFrames(Times times, bool tells_its_span) : times_(std::move(times)) {
    info_.name = "listed";
    if (tells_its_span) span_ = TimeSpan{times_.front(), times_.back()};
  }
  const SourceInfo& info() const override { return info_; }
  std::optional<TimeSpan> span() const override { return span_; }
  bool next(Frame& frame) override {
    if (position_ == times_.size()) {
      info_.warnings.emplace_back("of the frames");
      return false;
    }
    frame = Frame();
    frame.number = static_cast<int>(position_);
    frame.t_us = times_[position_++];
    return true;
  }

 private:
  SourceInfo info_;
  std::optional<TimeSpan> span_;
  Times times_;
  std::size_t position_ = 0;
};

std::vector<AngularRateSample> samples(std::int64_t first_us, std::int64_t last_us,
                                       std::int64_t step_us) {
  std::vector<AngularRateSample> made;
  for (std::int64_t t_us = first_us; t_us <= last_us; t_us += step_us) {
    made.push_back({t_us, Vector3<float>(0.0F, 0.0F, 1.0F)});
  }
  return made;
}

std::unique_ptr<FrameSource> with_samples(const Times& frames, bool tells_its_span,
                                          std::vector<AngularRateSample> gyro) {
  return add_gyro(std::make_unique<ListedFrames>(frames, tells_its_span), std::move(gyro),
                  GyroParameters(), "gyro.csv");
}

const Times kFrames = {1000000, 1033333, 1066667, 1100000, 1133333};

/// Times of the samples of each frame.
std::vector<Times> play(FrameSource& source) {
  std::vector<Times> given;
  for (Frame frame; source.next(frame);) {
    given.emplace_back();
    for (const AngularRateSample& sample : frame.gyro) given.back().push_back(sample.t_us);
  }
  return given;
}

TEST(GyroSource, EveryFrameGetsTheSamplesSinceTheOneBefore) {
  const auto source = with_samples(kFrames, true, samples(500000, 1200000, 20000));
  ASSERT_TRUE(source->info().gyro.has_value());
  EXPECT_EQ(source->info().inputs.back(), "gyro.csv");
  const std::vector<Times> given = play(*source);
  ASSERT_EQ(given.size(), 5U);
  // Of the first frame a tenth of a second before it.
  EXPECT_EQ(given[0], (Times{920000, 940000, 960000, 980000, 1000000}));
  EXPECT_EQ(given[1], (Times{1020000}));
  EXPECT_EQ(given[2], (Times{1040000, 1060000}));
  EXPECT_EQ(given[3], (Times{1080000, 1100000}));
  EXPECT_EQ(given[4], (Times{1120000}));
  EXPECT_EQ(source->info().warnings, std::vector<std::string>{"of the frames"});
  EXPECT_FALSE(source->info().damaged);
}

TEST(GyroSource, AnotherClockIsRefusedWithBothSpans) {
  for (const std::int64_t off_us : {std::int64_t{-20000000}, std::int64_t{1700000000000000}}) {
    const std::string said = message_of(
        [&] { with_samples(kFrames, true, samples(500000 + off_us, 1200000 + off_us, 5000)); });
    EXPECT_TRUE(says(said, {"gyro.csv", "clock of the frames", "1.000 s to 1.133 s"})) << off_us;
  }
  // A source that cannot say when its frames are is found out at their end.
  const auto source = with_samples(kFrames, false, samples(20000000, 21000000, 5000));
  for (const Times& given : play(*source)) EXPECT_TRUE(given.empty());
  EXPECT_TRUE(source->info().damaged);
  ASSERT_EQ(source->info().warnings.size(), 2U);
  EXPECT_TRUE(says(source->info().warnings[1], {"gyro.csv", "5 of 5 frames"}));
}

TEST(GyroSource, AnotherUnitIsRefused) {
  // Steps of 5 s and of 5 us: ms and ns that were taken for something else.
  for (const bool tells : {false, true}) {
    for (const std::int64_t step_us : {std::int64_t{5000000}, std::int64_t{5}}) {
      const std::string said =
          message_of([&] { with_samples(kFrames, tells, samples(0, 400 * step_us, step_us)); });
      EXPECT_TRUE(says(said, {"gyro.csv", "steps", "unit"})) << step_us;
    }
  }
}

TEST(GyroSource, SaysWhatItDoesNotCover) {
  const auto half = with_samples(kFrames, true, samples(900000, 1040000, 5000));
  ASSERT_EQ(half->info().warnings.size(), 1U);
  EXPECT_TRUE(says(half->info().warnings[0], {"gyro.csv", "covers", "% of the frames' time"}));
  play(*half);
  EXPECT_EQ(half->info().warnings.size(), 2U);
  EXPECT_FALSE(half->info().damaged);
}

}  // namespace
}  // namespace cairn::host
