#include "cairn/map/map_builder.hpp"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "map_fixture.hpp"

namespace cairn {
namespace {

using Map = SharedMap<test::SmallConfig>;
using Builder = MapBuilder<test::SmallConfig>;
using Kind = Map::Message::Kind;

Map::Message store(const Map::Landmark& landmark) {
  Map::Message message;
  message.kind = Kind::kStore;
  message.landmark = landmark;
  return message;
}

Map::Message sighting(LandmarkId id, bool found) {
  Map::Message message;
  message.kind = found ? Kind::kFound : Kind::kNotFound;
  message.id = id;
  return message;
}

class MapBuilderTest : public ::testing::Test {
 protected:
  const MapLibrary<test::SmallConfig>& published() const { return map_->exchange.front(); }

  std::unique_ptr<Map> map_ = std::make_unique<Map>();
  std::unique_ptr<Builder> builder_ = std::make_unique<Builder>();
  test::LandmarkMaker maker_{7};
};

TEST_F(MapBuilderTest, PublishesWhatItWasHanded) {
  const auto first = maker_.landmark(1);
  ASSERT_TRUE(map_->messages.push(store(first)));
  EXPECT_EQ(published().size(), 0);
  EXPECT_EQ(builder_->run(*map_, 8), 1);
  ASSERT_EQ(published().size(), 1);
  EXPECT_EQ(published()[0].p_map, first.p_map);

  auto moved = first;
  moved.p_map.x() += 0.1F;
  ASSERT_TRUE(map_->messages.push(store(moved)));
  ASSERT_TRUE(map_->messages.push(sighting(1, true)));
  EXPECT_EQ(builder_->run(*map_, 8), 2);
  ASSERT_EQ(published().size(), 1);
  EXPECT_EQ(published()[0].p_map, moved.p_map);
  EXPECT_EQ(published()[0].sightings, moved.sightings + 1);
}

TEST_F(MapBuilderTest, DoesNoMoreThanItsSlice) {
  for (LandmarkId id = 1; id <= 5; ++id) {
    ASSERT_TRUE(map_->messages.push(store(maker_.landmark(id))));
  }
  EXPECT_EQ(builder_->run(*map_, 2), 2);
  EXPECT_EQ(published().size(), 2);
  EXPECT_EQ(builder_->run(*map_, 2), 2);
  EXPECT_EQ(builder_->run(*map_, 2), 1);
  EXPECT_EQ(builder_->run(*map_, 2), 0);
  EXPECT_EQ(published().size(), 5);
}

TEST_F(MapBuilderTest, WorksLaterWhileItsCopyIsRead) {
  ASSERT_TRUE(map_->messages.push(store(maker_.landmark(1))));
  const auto* read = map_->exchange.acquire();
  EXPECT_EQ(builder_->run(*map_, 8), 1);  // the other copy is free
  ASSERT_TRUE(map_->messages.push(store(maker_.landmark(2))));
  EXPECT_EQ(builder_->run(*map_, 8), 0);
  EXPECT_EQ(read->size(), 0);
  map_->exchange.release();
  EXPECT_EQ(builder_->run(*map_, 8), 1);
  EXPECT_EQ(published().size(), 2);
}

TEST_F(MapBuilderTest, PassesOverLandmarksItDoesNotKnow) {
  ASSERT_TRUE(map_->messages.push(sighting(99, true)));
  EXPECT_EQ(builder_->run(*map_, 8), 1);
  EXPECT_EQ(published().size(), 0);
  EXPECT_EQ(map_->exchange.sequence(), 0U);  // nothing changed, nothing published
}

TEST_F(MapBuilderTest, CountsWhatTheLibraryRefuses) {
  auto bad = maker_.landmark(3);
  bad.covariance(0, 0) = -1.0F;
  ASSERT_TRUE(map_->messages.push(store(bad)));
  builder_->run(*map_, 8);
  EXPECT_EQ(published().size(), 0);
  EXPECT_EQ(builder_->health().landmarks_refused, 1U);
}

struct Bytes {
  std::vector<std::uint8_t> data;
  static bool write(void* context, const std::uint8_t* bytes, int count) {
    auto& data = static_cast<Bytes*>(context)->data;
    data.insert(data.end(), bytes, bytes + count);
    return true;
  }
  static bool read_at(void* context, std::uint32_t offset, std::uint8_t* bytes, int count) {
    const auto& data = static_cast<Bytes*>(context)->data;
    if (offset + static_cast<std::size_t>(count) > data.size()) return false;
    std::copy_n(data.begin() + offset, count, bytes);
    return true;
  }
  ByteSink sink() { return {&Bytes::write, this}; }
  ByteSource source() { return {&Bytes::read_at, this, static_cast<std::uint32_t>(data.size())}; }
};

TEST_F(MapBuilderTest, ADamagedMapChangesNothing) {
  ASSERT_TRUE(map_->messages.push(store(maker_.landmark(1))));
  builder_->run(*map_, 8);
  Bytes file;
  ASSERT_TRUE(ok(builder_->save(*map_, 2, file.sink())));
  ASSERT_TRUE(map_->messages.push(store(maker_.landmark(5))));
  builder_->run(*map_, 8);

  MapFileInfo info;
  Bytes damaged = file;
  damaged.data[40] ^= 1U;
  EXPECT_EQ(builder_->load(*map_, damaged.source(), info), Status::kCorrupt);
  EXPECT_EQ(published().size(), 2);
  ASSERT_TRUE(ok(builder_->load(*map_, file.source(), info)));
  EXPECT_EQ(published().size(), 1);
  EXPECT_EQ(info.next_id, 2U);
}

}  // namespace
}  // namespace cairn
