#include "cairn/map/map_file.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "map_fixture.hpp"

namespace cairn {
namespace {

using test::LandmarkMaker;
using test::SmallConfig;
using Library = MapLibrary<SmallConfig>;
using Bytes = std::vector<std::uint8_t>;

struct EightLandmarks : DefaultConfig {
  static constexpr int kLibraryLandmarks = 8;
};

ByteSink sink_to(Bytes& bytes) {
  return {[](void* context, const std::uint8_t* data, int count) {
            auto& out = *static_cast<Bytes*>(context);
            out.insert(out.end(), data, data + count);
            return true;
          },
          &bytes};
}

ByteSource source_of(Bytes& bytes) {
  return {[](void* context, std::uint32_t offset, std::uint8_t* data, int count) {
            const auto& in = *static_cast<Bytes*>(context);
            if (offset + static_cast<std::size_t>(count) > in.size()) return false;
            std::copy_n(in.begin() + offset, count, data);
            return true;
          },
          &bytes, static_cast<std::uint32_t>(bytes.size())};
}

Library random_library(unsigned seed, int count, bool reversed = false) {
  LandmarkMaker maker(seed);
  std::vector<LibraryLandmark<float>> landmarks;
  landmarks.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    landmarks.push_back(maker.landmark(static_cast<LandmarkId>(10 + 3 * i)));
  }
  if (reversed) std::reverse(landmarks.begin(), landmarks.end());
  Library library;
  Health health;
  for (const auto& l : landmarks) EXPECT_TRUE(ok(library.insert(l, health)));
  return library;
}

Bytes saved(const Library& library) {
  Bytes bytes;
  EXPECT_EQ(save_map(library, LandmarkId{1000}, sink_to(bytes)), Status::kOk);
  return bytes;
}

TEST(MapFile, WhatIsSavedComesBack) {
  const Library library = random_library(1, 20);
  Bytes bytes = saved(library);
  EXPECT_EQ(bytes.size(), map_file_bytes(20, 1));
  Library loaded = random_library(2, 5);
  MapFileInfo info;
  ASSERT_EQ(load_map(source_of(bytes), loaded, info), Status::kOk);
  EXPECT_EQ(info.next_id, 1000U);
  ASSERT_EQ(loaded.size(), 20);
  for (int slot = 0; slot < 20; ++slot) {
    const auto& a = library[slot];
    const auto& b = loaded[loaded.find(a.id)];
    EXPECT_EQ(a.p_map, b.p_map);
    EXPECT_EQ(a.covariance, b.covariance);
    EXPECT_EQ(a.sightings, b.sightings);
    EXPECT_EQ(a.searches, b.searches);
    const auto& u = a.views[0];
    const auto& v = b.views[0];
    EXPECT_EQ(std::memcmp(&u.descriptor, &v.descriptor, 64), 0);
    EXPECT_EQ(u.pose.orientation_bin, v.pose.orientation_bin);
    EXPECT_EQ(u.pose.scale_index, v.pose.scale_index);
    EXPECT_EQ(u.focal_px, v.focal_px);
    EXPECT_EQ(u.T_map_reference.rotation.coeffs(), v.T_map_reference.rotation.coeffs());
    EXPECT_EQ(u.T_map_reference.translation, v.T_map_reference.translation);
  }
  EXPECT_EQ(saved(loaded), bytes);
}

TEST(MapFile, EqualContentGivesEqualBytesWhateverTheSlots) {
  EXPECT_EQ(saved(random_library(3, 20)), saved(random_library(3, 20, true)));
}

TEST(MapFile, AnEmptyMapIsAMap) {
  Bytes bytes = saved(Library());
  Library library = random_library(1, 3);
  MapFileInfo info;
  EXPECT_EQ(load_map(source_of(bytes), library, info), Status::kOk);
  EXPECT_TRUE(library.empty());
}

TEST(MapFile, EveryFlippedByteIsRefusedAndNothingIsChanged) {
  Bytes bytes = saved(random_library(4, 6));
  Library library = random_library(5, 7);
  const Bytes before = saved(library);
  const std::uint32_t revision = library.revision();
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const unsigned mask : {0x01U, 0x80U, 0xFFU}) {
      Bytes damaged = bytes;
      damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ mask);
      MapFileInfo info;
      const Status status = load_map(source_of(damaged), library, info);
      ASSERT_NE(status, Status::kOk) << at;
      ASSERT_NE(info.fault, MapFileFault::kNone) << at;
      if (at < 8) {
        ASSERT_EQ(info.fault, MapFileFault::kMagic);
      } else if (at < 12) {
        ASSERT_EQ(status, Status::kVersionMismatch);
      } else if (at >= static_cast<std::size_t>(kMapHeaderBytes)) {
        ASSERT_EQ(info.fault, MapFileFault::kChecksum);
      }
    }
  }
  EXPECT_EQ(library.revision(), revision);
  EXPECT_EQ(saved(library), before);
}

TEST(MapFile, EveryTruncationAndExtensionIsRefused) {
  const Bytes bytes = saved(random_library(6, 6));
  Library library = random_library(7, 7);
  const std::uint32_t revision = library.revision();
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
    MapFileInfo info;
    ASSERT_EQ(load_map(source_of(cut), library, info), Status::kCorrupt) << length;
    ASSERT_EQ(info.fault, MapFileFault::kUnreadable) << length;
  }
  Bytes longer = bytes;
  longer.push_back(0);
  MapFileInfo info;
  EXPECT_EQ(load_map(source_of(longer), library, info), Status::kCorrupt);
  EXPECT_EQ(info.fault, MapFileFault::kLength);
  EXPECT_EQ(library.revision(), revision);
}

/// Sets a little-endian word and repairs the checksum, as a hostile or buggy writer would.
void forge(Bytes& bytes, std::size_t offset, std::uint32_t value) {
  const auto put = [&bytes](std::size_t at, std::uint32_t v) {
    for (unsigned k = 0; k < 4; ++k) bytes[at + k] = static_cast<std::uint8_t>(v >> (8 * k));
  };
  put(offset, value);
  detail::Crc32 crc;
  crc.add(bytes.data(), static_cast<int>(bytes.size()) - kMapTrailerBytes);
  put(bytes.size() - kMapTrailerBytes, crc.value());
}

TEST(MapFile, ForgedFilesWithAGoodChecksumAreRefusedByTheirValues) {
  const Bytes good = saved(random_library(8, 6));
  constexpr std::size_t kFirst = kMapHeaderBytes;
  struct Case {
    std::size_t offset;
    std::uint32_t value;
    MapFileFault fault;
  };
  const Case cases[] = {
      {8, 2, MapFileFault::kVersion},
      {12, 2, MapFileFault::kCapacity},
      {16, 25, MapFileFault::kCapacity},
      {16, 0xFFFFFFFFU, MapFileFault::kCapacity},
      {16, 5, MapFileFault::kLength},
      {20, 0xFFFFFFFFU, MapFileFault::kLength},
      {24, 11, MapFileFault::kValue},  // next id below an id in use
      {28, 1, MapFileFault::kValue},
      {kFirst, 0, MapFileFault::kValue},                 // no id
      {kFirst, 500, MapFileFault::kValue},               // ids not ascending
      {kFirst + 4, 0x7FC00000U, MapFileFault::kValue},   // NaN position
      {kFirst + 16, 0xBF800000U, MapFileFault::kValue},  // negative variance
      {kFirst + 44, 0xFF, MapFileFault::kValue},         // view count
  };
  Library library = random_library(9, 4);
  const std::uint32_t revision = library.revision();
  for (const Case& c : cases) {
    Bytes bytes = good;
    forge(bytes, c.offset, c.value);
    MapFileInfo info;
    EXPECT_NE(load_map(source_of(bytes), library, info), Status::kOk) << c.offset;
    EXPECT_EQ(info.fault, c.fault) << c.offset << " " << to_string(info.fault);
  }
  EXPECT_EQ(library.revision(), revision);
}

TEST(MapFile, ABiggerMapThanFitsIsAVersionMismatch) {
  Bytes bytes = saved(random_library(10, 20));
  MapLibrary<EightLandmarks> library;
  MapFileInfo info;
  EXPECT_EQ(load_map(source_of(bytes), library, info), Status::kVersionMismatch);
  EXPECT_EQ(info.fault, MapFileFault::kCapacity);
  EXPECT_EQ(info.landmarks, 20U);
  Bytes small = saved(random_library(10, 8));
  EXPECT_EQ(load_map(source_of(small), library, info), Status::kOk);
  EXPECT_EQ(library.size(), 8);
}

TEST(MapFile, ASinkThatIsFullIsReported) {
  const Library library = random_library(11, 5);
  for (int limit = 0; limit < 7; ++limit) {
    int calls = limit;
    const ByteSink sink{
        [](void* context, const std::uint8_t*, int) { return (*static_cast<int*>(context))-- > 0; },
        &calls};
    EXPECT_EQ(save_map(library, LandmarkId{1000}, sink), Status::kBudgetExceeded);
  }
  EXPECT_EQ(save_map(library, LandmarkId{1000}, ByteSink()), Status::kInvalidArgument);
  Bytes bytes;
  EXPECT_EQ(save_map(library, LandmarkId{12}, sink_to(bytes)), Status::kInvalidArgument);
  EXPECT_TRUE(bytes.empty());
}

/// A medium that turns bad after a number of reads.
struct FailingMedium {
  Bytes bytes;
  int good_reads = 0;
};

TEST(MapFile, AMediumThatChangesBetweenThePassesNeverLeavesHalfAMap) {
  FailingMedium medium{saved(random_library(12, 6)), 0};
  for (int good = 0; good < 16; ++good) {
    medium.good_reads = good;
    const ByteSource source{[](void* context, std::uint32_t offset, std::uint8_t* data, int count) {
                              auto& m = *static_cast<FailingMedium*>(context);
                              std::copy_n(m.bytes.begin() + offset, count, data);
                              if (m.good_reads-- <= 0)
                                data[0] = static_cast<std::uint8_t>(data[0] ^ 0x10U);
                              return true;
                            },
                            &medium, static_cast<std::uint32_t>(medium.bytes.size())};
    Library library = random_library(13, 4);
    const std::uint32_t revision = library.revision();
    MapFileInfo info;
    EXPECT_EQ(load_map(source, library, info), Status::kCorrupt) << good;
    if (good < 8) {  // header, six records, trailer: the first pass
      EXPECT_EQ(library.revision(), revision) << good;
    } else {
      EXPECT_TRUE(library.empty()) << good;
      EXPECT_EQ(info.fault, MapFileFault::kUnreadable);
    }
  }
}

TEST(MapFile, TheChecksumIsCrc32) {
  detail::Crc32 crc;
  crc.add(reinterpret_cast<const std::uint8_t*>("123456789"), 9);
  EXPECT_EQ(crc.value(), 0xCBF43926U);
}

}  // namespace
}  // namespace cairn
