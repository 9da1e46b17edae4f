#include "objects.hpp"

#include <new>

#include "cairn/numeric/math.hpp"
#include "cairn/tracking/mounting.hpp"

#include "convert.hpp"
#include "memory.hpp"

static_assert(cairn_size_is_current<sizeof(cairn_objects), CAIRN_OBJECTS_BYTES>(), "");
static_assert(alignof(cairn_objects) <= CAIRN_ALIGNMENT, "alignment of the memory handed in");

using cairn::Status;
using cairn::c_api::to_c;

cairn_status cairn_objects_initialise(void* memory, size_t bytes, float height_m,
                                      cairn_objects** objects) {
  if (objects == nullptr) return CAIRN_INVALID_ARGUMENT;
  *objects = nullptr;
  if (!cairn::c_api::fits(memory, bytes, sizeof(cairn_objects))) return CAIRN_INVALID_ARGUMENT;
  auto* const made = new (memory) cairn_objects;
  const Status status = cairn::make_cairn(height_m, made->augmenter.shape());
  if (!ok(status)) return to_c(status);
  made->augmenter.initialise(cairn::Augmenter::Parameters{});
  *objects = made;
  return CAIRN_OK;
}

cairn_status cairn_objects_place(cairn_objects* objects, const cairn_transform* T_map_object) {
  if (objects == nullptr || T_map_object == nullptr) return CAIRN_INVALID_ARGUMENT;
  const cairn::Rigid<float> place = cairn::c_api::from_c(*T_map_object);
  const Status valid = cairn::validate_mounting(place);
  return to_c(ok(valid) ? objects->augmenter.place(place) : valid);
}

cairn_status cairn_objects_count(const cairn_objects* objects, int32_t* count) {
  if (objects == nullptr || count == nullptr) return CAIRN_INVALID_ARGUMENT;
  *count = objects->augmenter.size();
  return CAIRN_OK;
}

cairn_status cairn_objects_get_place(const cairn_objects* objects, int32_t index,
                                     cairn_transform* T_map_object) {
  if (objects == nullptr || T_map_object == nullptr) return CAIRN_INVALID_ARGUMENT;
  if (index < 0 || index >= objects->augmenter.size()) return CAIRN_NOT_FOUND;
  *T_map_object = to_c(objects->augmenter[index]);
  return CAIRN_OK;
}

bool cairn_objects_wants_one(const cairn_objects* objects) {
  return objects != nullptr && objects->augmenter.wants_object();
}
