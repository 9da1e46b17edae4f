// load_map() and save_map() on arbitrary bytes, with and without a right checksum.
#include "cairn/map/map_file.hpp"
#include "cairn/runtime/input_log.hpp"

#include "tracker_scene.hpp"

namespace cairn::fuzz {
namespace {

using Library = MapLibrary<SmallConfig>;

std::uint64_t hash_of(const Library& library) {
  Hash64 sum;
  for (int i = 0; i < library.size(); ++i) {
    sum.add(library[i].id);
    sum.add_bytes(library[i].views[0].descriptor.bytes, Descriptor::kBytes);
    for (int k = 0; k < 3; ++k) sum.add(library[i].p_map[k]);
  }
  return sum.value();
}

void check(const Library& library, const MapFileInfo& info, const MapBytes& loaded) {
  PROMISE(6, library.size() <= SmallConfig::kLibraryLandmarks);
  for (int i = 0; i < library.size(); ++i) {
    PROMISE(4, library[i].p_map.allFinite() && library[i].covariance.allFinite());
    PROMISE(8, library[i].id < info.next_id);
  }
  MapBytes again;
  PROMISE(8, ok(save_map(library, info.next_id, again.sink())));
  PROMISE(8, again.size == loaded.size);
  PROMISE(8, std::memcmp(again.bytes, loaded.bytes, static_cast<std::size_t>(again.size)) == 0);
}

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn;
  using namespace cairn::fuzz;
  count_allocations();
  if (size < 1 || size > MapBytes::kRoom) return 0;
  const auto map = std::make_unique<MapBytes>();
  map->size = static_cast<int>(size - 1);
  std::memcpy(map->bytes, bytes + 1, size - 1);
  if ((bytes[0] & 1U) != 0) map->seal();
  const auto library = std::make_unique<Library>();
  const NoAllocation none;
  const std::uint64_t empty = hash_of(*library);
  MapFileInfo info;
  const Status status = load_map(map->source(), *library, info);
  PROMISE(8, ok(status) == (info.fault == MapFileFault::kNone));
  if (ok(status)) {
    check(*library, info, *map);
  } else {
    PROMISE(3, hash_of(*library) == empty && library->size() == 0);
  }
  return 0;
}
