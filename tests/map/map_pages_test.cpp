// A map in two pages of flash, one of which is always whole (docs/reference/map-file.md): power may
// be cut after every byte.
#include <algorithm>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/map/map_file.hpp"

#include "map_fixture.hpp"

namespace cairn {
namespace {

using test::LandmarkMaker;
using test::SmallConfig;
using Library = MapLibrary<SmallConfig>;
using Page = std::vector<std::uint8_t>;

constexpr std::uint8_t kErased = 0xFF;
constexpr int kPageBytes = 512;

/// Flash that loses its power after so many bytes written or erased.
struct Flash {
  Page pages[2] = {Page(kPageBytes, kErased), Page(kPageBytes, kErased)};
  int sizes[2] = {0, 0};  ///< as a directory would hold them: bytes written since the last erasure
  int bytes_left = 1 << 30;

  bool put(int page, int at, std::uint8_t value) {
    if (bytes_left == 0) return false;
    --bytes_left;
    pages[page][static_cast<std::size_t>(at)] = value;
    return true;
  }
};

struct PageSink {
  Flash* flash;
  int page;
};

ByteSink sink_to(PageSink& target) {
  return {[](void* context, const std::uint8_t* bytes, int count) {
            PageSink& to = *static_cast<PageSink*>(context);
            for (int i = 0; i < count; ++i) {
              if (!to.flash->put(to.page, to.flash->sizes[to.page], bytes[i])) return false;
              ++to.flash->sizes[to.page];
            }
            return true;
          },
          &target};
}

struct PageSource {
  const Page* page;
  int size;
};

bool load(const Flash& flash, int page, Library& library) {
  PageSource from{&flash.pages[page], flash.sizes[page]};
  const ByteSource source{
      [](void* context, std::uint32_t offset, std::uint8_t* to, int count) {
        const PageSource& in = *static_cast<const PageSource*>(context);
        if (offset + static_cast<std::uint32_t>(count) > static_cast<std::uint32_t>(in.size)) {
          return false;
        }
        std::memcpy(to, in.page->data() + offset, static_cast<std::size_t>(count));
        return true;
      },
      &from, static_cast<std::uint32_t>(from.size)};
  MapFileInfo info;
  return ok(load_map(source, library, info));
}

/// Erases `page`, byte by byte.
bool erase(Flash& flash, int page) {
  for (int i = 0; i < kPageBytes; ++i) {
    if (!flash.put(page, i, kErased)) return false;
  }
  flash.sizes[page] = 0;
  return true;
}

/// Saves into the page that is not in use, and then erases the other.
bool save(Flash& flash, int in_use, const Library& library) {
  const int other = 1 - in_use;
  if (!erase(flash, other)) return false;
  PageSink sink{&flash, other};
  if (!ok(save_map(library, LandmarkId{100}, sink_to(sink)))) return false;
  Library check;
  if (!load(flash, other, check)) return false;
  return erase(flash, in_use);
}

Library library_of(unsigned seed, int count) {
  LandmarkMaker maker(seed);
  Library library;
  Health health;
  for (int i = 0; i < count; ++i) {
    EXPECT_TRUE(ok(library.insert(maker.landmark(static_cast<LandmarkId>(i + 1)), health)));
  }
  return library;
}

bool same(const Library& a, const Library& b) {
  if (a.size() != b.size()) return false;
  for (int i = 0; i < a.size(); ++i) {
    if (a[i].id != b[i].id || a[i].p_map != b[i].p_map) return false;
  }
  return true;
}

TEST(MapPages, APowerCutAfterAnyByteLeavesTheOldMapOrTheNew) {
  const Library old_map = library_of(1, 2);
  const Library new_map = library_of(2, 3);
  Flash before;
  PageSink sink{&before, 0};
  ASSERT_TRUE(ok(save_map(old_map, LandmarkId{100}, sink_to(sink))));
  int olds = 0;
  int news = 0;
  bool complete = false;
  for (int cut = 0; !complete; ++cut) {
    Flash flash = before;
    flash.bytes_left = cut;
    complete = save(flash, 0, new_map);
    // After the restart: the first page that load_map takes.
    Library found;
    ASSERT_TRUE(load(flash, 0, found) || load(flash, 1, found)) << "cut after " << cut;
    ASSERT_TRUE(same(found, old_map) || same(found, new_map)) << "cut after " << cut;
    same(found, old_map) ? ++olds : ++news;
  }
  EXPECT_GT(olds, static_cast<int>(map_file_bytes(3, 1)));
  EXPECT_GT(news, 0);
}

}  // namespace
}  // namespace cairn
