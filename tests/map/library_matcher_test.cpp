#include "cairn/map/library_matcher.hpp"

#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "map_fixture.hpp"

namespace cairn {
namespace {

using test::LandmarkMaker;
using Config = DefaultConfig;
using Library = MapLibrary<Config>;
using Matcher = LibraryMatcher<Config, 96>;

/// 200 landmarks; features 0..59 show landmarks 1..60, the other 36 show nothing known.
struct Setting {
  std::unique_ptr<Library> library = std::make_unique<Library>();
  std::unique_ptr<Matcher> matcher = std::make_unique<Matcher>();

  explicit Setting(unsigned seed, int flips = 60) {
    LandmarkMaker maker(seed);
    Health health;
    for (LandmarkId id = 1; id <= 200; ++id) {
      EXPECT_TRUE(ok(library->insert(maker.landmark(id), health)));
    }
    for (int f = 0; f < 96; ++f) {
      const Descriptor d =
          f < 60 ? maker.flipped((*library)[f].views[0].descriptor, flips) : maker.descriptor();
      EXPECT_TRUE(ok(matcher->add_feature(Vector2<float>(static_cast<float>(f), 7), d)));
    }
  }
};

TEST(HammingPrefix, CountsTheFirst128Bits) {
  LandmarkMaker maker(1);
  for (int i = 0; i < 200; ++i) {
    const Descriptor a = maker.descriptor();
    const Descriptor b = maker.descriptor();
    int expected = 0;
    for (int bit = 0; bit < 128; ++bit) {
      expected += ((a.bytes[bit / 8] ^ b.bytes[bit / 8]) >> (bit % 8)) & 1;
    }
    EXPECT_EQ(hamming_prefix_distance(a, b), expected);
  }
}

TEST(LibraryMatcher, FindsWhatIsThereAndNothingElse) {
  Setting s(2);
  const LibraryMatcherOptions options;
  ASSERT_TRUE(s.matcher->step(*s.library, 1 << 30, options));
  LibraryMatch matches[96];
  const int count = s.matcher->matches(options, matches, 96);
  EXPECT_GE(count, 58);
  for (int i = 0; i < count; ++i) {
    EXPECT_EQ(matches[i].id, static_cast<LandmarkId>(matches[i].feature + 1));
    if (i > 0) {
      EXPECT_GE(matches[i].distance, matches[i - 1].distance);
    }
  }
  LibraryMatch nearest[10];
  ASSERT_EQ(s.matcher->matches(options, nearest, 10), 10);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(nearest[i].feature, matches[i].feature);
}

TEST(LibraryMatcher, SlicesGiveTheSameAsOneRun) {
  Setting whole(3);
  Setting sliced(3);
  const LibraryMatcherOptions options;
  ASSERT_TRUE(whole.matcher->step(*whole.library, 1 << 30, options));
  int slices = 1;
  while (!sliced.matcher->step(*sliced.library, 2000, options)) ++slices;
  EXPECT_EQ(slices, 10);  // 21 landmarks of 96 pairs a slice
  LibraryMatch a[96];
  LibraryMatch b[96];
  const int count = whole.matcher->matches(options, a, 96);
  ASSERT_EQ(sliced.matcher->matches(options, b, 96), count);
  for (int i = 0; i < count; ++i) {
    EXPECT_EQ(a[i].feature, b[i].feature);
    EXPECT_EQ(a[i].id, b[i].id);
    EXPECT_EQ(a[i].distance, b[i].distance);
  }
}

TEST(LibraryMatcher, RepeatedLooksAreNotMatched) {
  LandmarkMaker maker(4);
  auto library = std::make_unique<Library>();
  auto matcher = std::make_unique<Matcher>();
  Health health;
  const Descriptor tile = maker.descriptor();
  for (LandmarkId id = 1; id <= 12; ++id) {
    auto l = maker.landmark(id);
    l.views[0].descriptor = maker.flipped(tile, 60);
    ASSERT_TRUE(ok(library->insert(l, health)));
  }
  for (int f = 0; f < 12; ++f) {
    ASSERT_TRUE(ok(matcher->add_feature(Vector2<float>(0, 0), maker.flipped(tile, 60))));
  }
  const LibraryMatcherOptions options;
  ASSERT_TRUE(matcher->step(*library, 1 << 30, options));
  LibraryMatch matches[12];
  EXPECT_LE(matcher->matches(options, matches, 12), 1);
}

TEST(LibraryMatcher, MatchesBecomeObservationsOfTheirLandmarks) {
  Setting s(5, 20);
  const LibraryMatcherOptions options;
  ASSERT_TRUE(s.matcher->step(*s.library, 1 << 30, options));
  LibraryMatch matches[96];
  const int count = s.matcher->matches(options, matches, 96);
  ASSERT_EQ(count, 60);
  PoseObservation<float> observations[96];
  ASSERT_EQ(to_observations(*s.library, *s.matcher, matches, count, 1.5F, observations), 60);
  const int slot = s.library->find(matches[0].id);
  EXPECT_EQ(observations[0].p_world, (*s.library)[slot].p_map);
  EXPECT_EQ(observations[0].pixel.x(), static_cast<float>(matches[0].feature));
  EXPECT_EQ(observations[0].sigma_px, 1.5F);
}

TEST(LibraryMatcher, RefusesMoreFeaturesThanItHolds) {
  Setting s(6);
  EXPECT_EQ(s.matcher->add_feature(Vector2<float>(0, 0), Descriptor()), Status::kFull);
  s.matcher->clear();
  EXPECT_EQ(s.matcher->feature_count(), 0);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(s.matcher->add_feature(Vector2<float>(nan, 0), Descriptor()), Status::kNonFiniteInput);
  LibraryMatch unused[1];
  EXPECT_EQ(s.matcher->matches({}, unused, 1), 0);
}

}  // namespace
}  // namespace cairn
