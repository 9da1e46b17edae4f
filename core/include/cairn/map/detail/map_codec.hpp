#pragma once

#include <cstdint>
#include <cstring>

#include "cairn/map/landmark.hpp"

namespace cairn::detail {

/// CRC-32 of ISO 3309 (polynomial 0xEDB88320 reflected), as zlib's crc32().
class Crc32 {
 public:
  void add(const std::uint8_t* bytes, int count);
  std::uint32_t value() const { return ~state_; }

 private:
  std::uint32_t state_ = 0xFFFFFFFFU;
};

/// Fixed-size record written and read little endian. The cursor never leaves the buffer: records
/// have a size known at compile time.
template <int Bytes>
class RecordWriter {
 public:
  void put8(std::uint8_t v) { bytes_[at_++] = v; }
  void put16(std::uint16_t v) {
    put8(static_cast<std::uint8_t>(v & 0xFFU));
    put8(static_cast<std::uint8_t>(v >> 8U));
  }
  void put32(std::uint32_t v) {
    for (unsigned shift = 0; shift < 32; shift += 8) put8(static_cast<std::uint8_t>(v >> shift));
  }
  template <class T>
  void put_real(T v) {
    const float f = static_cast<float>(v);
    std::uint32_t bits = 0;
    std::memcpy(&bits, &f, sizeof bits);
    put32(bits);
  }
  void put_bytes(const std::uint8_t* bytes, int count) {
    for (int i = 0; i < count; ++i) put8(bytes[i]);
  }
  const std::uint8_t* data() const { return bytes_; }
  int size() const { return at_; }

 private:
  std::uint8_t bytes_[Bytes] = {};
  int at_ = 0;
};

template <int Bytes>
class RecordReader {
 public:
  std::uint8_t* data() { return bytes_; }
  static constexpr int size() { return Bytes; }

  std::uint8_t get8() { return bytes_[at_++]; }
  std::uint16_t get16() {
    const unsigned low = get8();
    return static_cast<std::uint16_t>(low | (static_cast<unsigned>(get8()) << 8U));
  }
  std::uint32_t get32() {
    std::uint32_t v = 0;
    for (unsigned shift = 0; shift < 32; shift += 8)
      v |= static_cast<std::uint32_t>(get8()) << shift;
    return v;
  }
  /// NaN and infinities are read as they are: validate before use.
  template <class T>
  T get_real() {
    const std::uint32_t bits = get32();
    float f = 0.0F;
    std::memcpy(&f, &bits, sizeof f);
    return static_cast<T>(f);
  }
  void get_bytes(std::uint8_t* bytes, int count) {
    for (int i = 0; i < count; ++i) bytes[i] = get8();
  }

 private:
  std::uint8_t bytes_[Bytes] = {};
  int at_ = 0;
};

inline constexpr int kViewBytes = Descriptor::kBytes + 2 + 2 + 4 + 7 * 4;
inline constexpr int kLandmarkHeadBytes = 4 + 12 + 24 + 2 + 2 + 1 + 3;

template <int Views>
constexpr int landmark_bytes() {
  return kLandmarkHeadBytes + Views * kViewBytes;
}

template <class Writer, class T, int Views>
void write_landmark(const LibraryLandmark<T, Views>& landmark, Writer& out) {
  out.put32(landmark.id);
  for (int k = 0; k < 3; ++k) out.put_real(landmark.p_map[k]);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c <= r; ++c) out.put_real(landmark.covariance(r, c));
  }
  out.put16(landmark.sightings);
  out.put16(landmark.searches);
  out.put8(landmark.view_count);
  for (int k = 0; k < 3; ++k) out.put8(0);
  for (int v = 0; v < Views; ++v) {
    const bool used = v < landmark.view_count;
    const LandmarkView<T> view = used ? landmark.views[v] : LandmarkView<T>();
    out.put_bytes(view.descriptor.bytes, Descriptor::kBytes);
    out.put8(view.pose.orientation_bin);
    out.put8(view.pose.scale_index);
    out.put16(0);
    out.put_real(view.focal_px);
    const Quaternion<T>& q = view.T_map_reference.rotation;
    out.put_real(q.w());
    out.put_real(q.x());
    out.put_real(q.y());
    out.put_real(q.z());
    for (int k = 0; k < 3; ++k) out.put_real(view.T_map_reference.translation[k]);
  }
}

/// Reads a record. False when its padding is not zero.
template <class Reader, class T, int Views>
bool read_landmark(Reader& in, LibraryLandmark<T, Views>& landmark) {
  landmark = LibraryLandmark<T, Views>();
  landmark.id = in.get32();
  for (int k = 0; k < 3; ++k) landmark.p_map[k] = in.template get_real<T>();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c <= r; ++c) {
      landmark.covariance(r, c) = in.template get_real<T>();
      landmark.covariance(c, r) = landmark.covariance(r, c);
    }
  }
  landmark.sightings = in.get16();
  landmark.searches = in.get16();
  landmark.view_count = in.get8();
  unsigned padding = 0;
  for (int k = 0; k < 3; ++k) padding |= in.get8();
  for (int v = 0; v < Views; ++v) {
    LandmarkView<T>& view = landmark.views[v];
    in.get_bytes(view.descriptor.bytes, Descriptor::kBytes);
    view.pose.orientation_bin = in.get8();
    view.pose.scale_index = in.get8();
    padding |= in.get16();
    view.focal_px = in.template get_real<T>();
    Quaternion<T>& q = view.T_map_reference.rotation;
    q.w() = in.template get_real<T>();
    q.x() = in.template get_real<T>();
    q.y() = in.template get_real<T>();
    q.z() = in.template get_real<T>();
    for (int k = 0; k < 3; ++k) {
      view.T_map_reference.translation[k] = in.template get_real<T>();
    }
  }
  return padding == 0;
}

}  // namespace cairn::detail
