// The example that keeps a map in flash: power loss at any point of a save leaves the old map or
// the new one, whole.

#include "map_slots.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::uint32_t kSlotBytes = 1024;

/// Flash whose power goes after so many bytes were erased or programmed. Programming clears bits
/// alone; what is half erased reads as it was before.
class FlashModel {
 public:
  explicit FlashModel(std::uint32_t program_bytes) : program_bytes_(program_bytes) {
    for (Bytes& slot : slots_) slot.assign(kSlotBytes, 0x00);  // never erased
  }

  map_flash driver() {
    return {[](void* self, int slot) { return static_cast<FlashModel*>(self)->erase(slot); },
            [](void* self, int slot, std::uint32_t offset, const std::uint8_t* bytes,
               std::size_t count) {
              return static_cast<FlashModel*>(self)->program(slot, offset, bytes, count);
            },
            [](void* self, int slot, std::uint32_t offset, std::uint8_t* bytes, std::size_t count) {
              return static_cast<FlashModel*>(self)->read(slot, offset, bytes, count);
            },
            this,
            kSlotBytes,
            program_bytes_};
  }

  void lose_power_after(int bytes) { left_ = bytes; }
  void restore_power() { left_ = kForever; }
  Bytes& slot(int i) { return slots_[i]; }
  bool broke_rules() const { return broke_rules_; }

 private:
  static constexpr int kForever = 1 << 30;

  bool spend() { return left_ > 0 && left_-- > 0; }

  bool erase(int slot) {
    for (std::uint8_t& byte : slots_[slot]) {
      if (!spend()) return false;
      byte = 0xFF;
    }
    return true;
  }

  bool program(int slot, std::uint32_t offset, const std::uint8_t* bytes, std::size_t count) {
    broke_rules_ |=
        count != program_bytes_ || offset % program_bytes_ != 0 || offset + count > kSlotBytes;
    if (broke_rules_) return false;
    for (std::size_t i = 0; i < count; ++i) {
      broke_rules_ |= slots_[slot][offset + i] != 0xFF;
      if (!spend()) return false;
      slots_[slot][offset + i] &= bytes[i];
    }
    return true;
  }

  bool read(int slot, std::uint32_t offset, std::uint8_t* bytes, std::size_t count) const {
    if (offset > kSlotBytes || count > kSlotBytes - offset) return false;
    std::memcpy(bytes, slots_[slot].data() + offset, count);
    return true;
  }

  Bytes slots_[MAP_SLOTS];
  std::uint32_t program_bytes_;
  int left_ = kForever;
  bool broke_rules_ = false;
};

/// A map of so many bytes, in uneven pieces as the tracker writes them.
cairn_status write_bytes(void* map, cairn_write_bytes write, void* context) {
  const Bytes& bytes = *static_cast<Bytes*>(map);
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t count = std::min<std::size_t>(at == 0 ? 32 : 37, bytes.size() - at);
    if (!write(context, bytes.data() + at, count)) return CAIRN_BUDGET_EXCEEDED;
    at += count;
  }
  return CAIRN_OK;
}

Bytes map_of(int seed, std::size_t size) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), static_cast<std::uint8_t>(seed));
  return bytes;
}

cairn_status save(FlashModel& flash, Bytes map) {
  const map_flash driver = flash.driver();
  return map_slots_save(&driver, write_bytes, &map);
}

/// The map that a reset finds; empty where there is none.
Bytes found(FlashModel& flash) {
  const map_flash driver = flash.driver();
  map_slot_reader reader{&driver, -1};
  std::uint32_t size = 0;
  if (map_slots_open(&driver, &reader.slot, &size) != CAIRN_OK) return {};
  Bytes bytes(size);
  EXPECT_TRUE(map_slots_read(&reader, 0, bytes.data(), size));
  return bytes;
}

class MapSlots : public ::testing::TestWithParam<std::uint32_t> {};
INSTANTIATE_TEST_SUITE_P(ProgramSizes, MapSlots, ::testing::Values(1U, 4U, 16U, 32U));

TEST_P(MapSlots, WithoutASaveThereIsNoMap) {
  FlashModel flash(GetParam());
  EXPECT_TRUE(found(flash).empty());
}

TEST_P(MapSlots, TheNewestMapIsFound) {
  FlashModel flash(GetParam());
  for (int i = 1; i < 6; ++i) {
    EXPECT_EQ(save(flash, map_of(i, 300 + 7 * static_cast<std::size_t>(i))), CAIRN_OK);
    EXPECT_EQ(found(flash), map_of(i, 300 + 7 * static_cast<std::size_t>(i)));
  }
  EXPECT_FALSE(flash.broke_rules());
}

TEST_P(MapSlots, PowerLossAtEveryByteLeavesTheOldMapOrTheNewOne) {
  const Bytes older = map_of(1, 300);
  const Bytes old = map_of(2, 330);
  const Bytes fresh = map_of(3, 360);
  bool saved = false;
  int lost = 0;
  for (int bytes = 0; !saved; ++bytes) {
    FlashModel flash(GetParam());
    ASSERT_EQ(save(flash, older), CAIRN_OK);
    ASSERT_EQ(save(flash, old), CAIRN_OK);
    flash.lose_power_after(bytes);
    saved = save(flash, fresh) == CAIRN_OK;
    flash.restore_power();
    const Bytes now = found(flash);
    ASSERT_TRUE(now == fresh || (!saved && now == old)) << "power lost after " << bytes;
    lost += saved ? 0 : 1;
    // The next save works whatever is left.
    ASSERT_EQ(save(flash, older), CAIRN_OK);
    ASSERT_EQ(found(flash), older);
    ASSERT_FALSE(flash.broke_rules());
  }
  EXPECT_GE(lost, static_cast<int>(kSlotBytes + fresh.size()));
}

TEST_P(MapSlots, ADamagedMapFallsBackToTheOneBefore) {
  for (std::uint32_t at = 0; at < 300; ++at) {
    FlashModel flash(GetParam());
    ASSERT_EQ(save(flash, map_of(1, 250)), CAIRN_OK);
    ASSERT_EQ(save(flash, map_of(2, 250)), CAIRN_OK);
    flash.slot(1)[at] ^= 0x10U;
    const Bytes now = found(flash);
    ASSERT_TRUE(now == map_of(1, 250) || now == map_of(2, 250));
    if (at < 12) {
      ASSERT_EQ(now, map_of(1, 250));
    }
  }
}

TEST_P(MapSlots, AMapThatHasNoRoomLeavesTheOldOne) {
  FlashModel flash(GetParam());
  ASSERT_EQ(save(flash, map_of(1, 300)), CAIRN_OK);
  EXPECT_EQ(save(flash, map_of(2, kSlotBytes)), CAIRN_BUDGET_EXCEEDED);
  EXPECT_EQ(found(flash), map_of(1, 300));
  EXPECT_FALSE(flash.broke_rules());
}

TEST(MapSlotsSettings, AnImpossibleProgramSizeIsRefused) {
  for (const std::uint32_t bytes : {0U, 3U, 64U}) {
    FlashModel flash(bytes);
    EXPECT_EQ(save(flash, map_of(1, 10)), CAIRN_INVALID_ARGUMENT);
  }
}

}  // namespace
