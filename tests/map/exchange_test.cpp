#include "cairn/map/exchange.hpp"

#include <memory>
#include <thread>

#include <gtest/gtest.h>

namespace cairn {
namespace {

/// A map in which every word is its version: a torn copy has two of them.
struct ProbeMap {
  static constexpr int kWords = 512;
  std::uint32_t words[kWords] = {};

  void fill(std::uint32_t value) {
    for (std::uint32_t& w : words) w = value;
  }
  bool is_whole() const {
    for (const std::uint32_t w : words) {
      if (w != words[0]) return false;
    }
    return true;
  }
};

TEST(MapExchange, OneThreadSeesWhatWasPublished) {
  MapExchange<ProbeMap> exchange;
  ProbeMap* back = exchange.begin_edit();
  ASSERT_NE(back, nullptr);
  back->fill(1);
  EXPECT_EQ(exchange.acquire()->words[0], 0U);
  exchange.release();
  exchange.publish();
  EXPECT_EQ(exchange.acquire()->words[0], 1U);
  exchange.release();
  back = exchange.begin_edit();  // the back copy has caught up
  EXPECT_EQ(back->words[0], 1U);
  back->fill(9);
  exchange.discard();
  back = exchange.begin_edit();
  EXPECT_EQ(back->words[0], 1U);
}

TEST(MapExchange, APinnedCopyIsLeftAlone) {
  MapExchange<ProbeMap> exchange;
  exchange.begin_edit()->fill(1);
  exchange.publish();
  const ProbeMap* held = exchange.acquire();
  exchange.begin_edit()->fill(2);
  exchange.publish();
  EXPECT_EQ(exchange.begin_edit(), nullptr);  // would write into what the reader holds
  EXPECT_EQ(held->words[0], 1U);
  exchange.release();
  ASSERT_NE(exchange.begin_edit(), nullptr);
  EXPECT_EQ(exchange.acquire()->words[0], 2U);
  exchange.release();
  EXPECT_EQ(exchange.sequence(), 2U);
}

TEST(MapExchange, ReaderAndWriterInTwoThreadsNeverSeeATornMap) {
  auto exchange = std::make_unique<MapExchange<ProbeMap>>();
  std::atomic<bool> done{false};
  std::thread writer([&] {
    std::uint32_t version = 0;
    for (int i = 0; i < 20000; ++i) {
      ProbeMap* back = exchange->begin_edit();
      if (back == nullptr) continue;
      back->fill(++version);
      exchange->publish();
    }
    done = true;
  });
  int torn = 0;
  int backwards = 0;
  std::uint32_t last = 0;
  while (!done) {
    const ProbeMap* map = exchange->acquire();
    if (map == nullptr) continue;
    torn += map->is_whole() ? 0 : 1;
    backwards += map->words[0] < last ? 1 : 0;
    last = map->words[0];
    exchange->release();
  }
  writer.join();
  EXPECT_EQ(torn, 0);
  EXPECT_EQ(backwards, 0);
}

}  // namespace
}  // namespace cairn
