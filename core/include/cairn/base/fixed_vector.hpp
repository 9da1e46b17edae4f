#pragma once

#include <cstddef>
#include <type_traits>

namespace cairn {

/// Vector of at most `Capacity` elements with its storage inside: no heap.
/// Elements are plain values; an element beyond size() keeps whatever it held last.
template <class T, int Capacity>
class FixedVector {
  static_assert(Capacity > 0, "capacity must be positive");
  // Not is_trivially_copyable: fixed-size Eigen types declare their own assignment.
  static_assert(std::is_trivially_destructible<T>::value, "elements are plain values");

 public:
  using value_type = T;

  static constexpr int capacity() { return Capacity; }
  int size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == Capacity; }

  /// Appends `value`; false (and nothing changed) when full.
  bool push_back(const T& value) {
    if (full()) return false;
    items_[size_++] = value;
    return true;
  }
  void pop_back() {
    if (size_ > 0) --size_;
  }
  void clear() { size_ = 0; }
  /// Sets the size, clamped to [0, Capacity]; new elements are value-initialised.
  void resize(int size) {
    const int target = size < 0 ? 0 : (size > Capacity ? Capacity : size);
    for (int i = size_; i < target; ++i) items_[i] = T{};
    size_ = target;
  }
  /// Removes element `index` by moving the last one into its place. O(1), changes the order.
  void remove_unordered(int index) {
    items_[index] = items_[size_ - 1];
    --size_;
  }

  T& operator[](int index) { return items_[index]; }
  const T& operator[](int index) const { return items_[index]; }
  T& back() { return items_[size_ - 1]; }
  const T& back() const { return items_[size_ - 1]; }
  T* data() { return items_; }
  const T* data() const { return items_; }
  T* begin() { return items_; }
  T* end() { return items_ + size_; }
  const T* begin() const { return items_; }
  const T* end() const { return items_ + size_; }

 private:
  T items_[Capacity] = {};
  int size_ = 0;
};

/// Read-only view of a contiguous run of values owned by the caller.
template <class T>
struct Span {
  const T* data = nullptr;
  int size = 0;

  Span() = default;
  Span(const T* first, int count) : data(first), size(count) {}
  template <int Capacity>
  Span(const FixedVector<T, Capacity>& v) : data(v.data()), size(v.size()) {}  // NOLINT: view

  const T& operator[](int index) const { return data[index]; }
  const T* begin() const { return data; }
  const T* end() const { return data + size; }
};

}  // namespace cairn
