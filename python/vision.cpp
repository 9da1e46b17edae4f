#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include "cairn/vision/fast.hpp"
#include "cairn/vision/freak.hpp"
#include "cairn/vision/hamming.hpp"

#include "arrays.hpp"

namespace cairn_python {
namespace {

using Scratch = cairn::FastScratch<cairn::ImageView::kMaxExtent>;
constexpr py::ssize_t kDescriptorBytes = cairn::Descriptor::kBytes;

/// (n, 3) of x, y, score, in raster order.
py::array_t<std::int32_t> detect_fast(const py::array& image, int threshold, int capacity) {
  const Picture picture(image);
  if (capacity < 1) throw py::value_error("capacity: expected 1 or more");
  const auto scratch = std::make_unique<Scratch>();
  std::vector<cairn::Corner> corners(static_cast<std::size_t>(capacity));
  cairn::FastReport report;
  need(cairn::detect_fast(picture.view(), {0, 0, picture.width(), picture.height()}, threshold,
                          *scratch, corners.data(), capacity, report),
       "detect_fast");
  const py::ssize_t count = report.found - report.dropped;
  py::array_t<std::int32_t> out({count, py::ssize_t(3)});
  auto rows = out.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < count; ++i) {
    const cairn::Corner& corner = corners[static_cast<std::size_t>(i)];
    rows(i, 0) = corner.x;
    rows(i, 1) = corner.y;
    rows(i, 2) = corner.score;
  }
  return out;
}

/// Descriptors, orientation bins, and which of the points have one.
py::tuple describe_freak(const py::array& image, const py::array& points) {
  const Picture picture(image);
  if (points.ndim() != 2 || points.shape(1) < 2) {
    throw py::value_error("points: expected the shape (n, 2 or more): x, y, ...");
  }
  const auto all = need_array<std::int32_t>(points, "points", {-1, points.shape(1)});
  const py::ssize_t count = all.shape(0);
  py::array_t<std::uint8_t> descriptors({count, kDescriptorBytes});
  py::array_t<std::uint8_t> bins(count);
  py::array_t<bool> described(count);
  const auto xy = all.unchecked<2>();
  for (py::ssize_t i = 0; i < count; ++i) {
    cairn::Descriptor descriptor;
    std::uint8_t bin = 0;
    const cairn::Status status =
        cairn::describe_freak(picture.view(), xy(i, 0), xy(i, 1), descriptor, bin);
    if (status != cairn::Status::kOutOfView) need(status, "describe_freak");
    std::memcpy(descriptors.mutable_data(i, 0), descriptor.bytes, kDescriptorBytes);
    *bins.mutable_data(i) = bin;
    *described.mutable_data(i) = ok(status);
  }
  return py::make_tuple(descriptors, bins, described);
}

std::vector<cairn::Descriptor> descriptors_of(const py::array& array, const char* name) {
  const auto bytes = need_array<std::uint8_t>(array, name, {-1, kDescriptorBytes});
  std::vector<cairn::Descriptor> all(static_cast<std::size_t>(bytes.shape(0)));
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::memcpy(all[i].bytes, bytes.data(static_cast<py::ssize_t>(i), 0), kDescriptorBytes);
  }
  return all;
}

/// (n, 3) of index (-1: none), distance, second distance.
py::array_t<std::int32_t> match_hamming(const py::array& queries, const py::array& candidates) {
  const std::vector<cairn::Descriptor> from = descriptors_of(queries, "queries");
  const std::vector<cairn::Descriptor> to = descriptors_of(candidates, "candidates");
  py::array_t<std::int32_t> out({static_cast<py::ssize_t>(from.size()), py::ssize_t(3)});
  auto rows = out.mutable_unchecked<2>();
  for (std::size_t i = 0; i < from.size(); ++i) {
    const cairn::HammingMatch match =
        cairn::match_hamming(from[i], {to.data(), static_cast<int>(to.size())});
    const auto row = static_cast<py::ssize_t>(i);
    rows(row, 0) = match.index;
    rows(row, 1) = match.distance;
    rows(row, 2) = match.second_distance;
  }
  return out;
}

}  // namespace

void add_vision(py::module_& module) {
  module.def(
      "detect_fast", &detect_fast, py::arg("image"), py::arg("threshold"),
      py::arg("capacity") = 10000,
      "FAST-9/16 corners of a uint8 picture, as cv::FAST with suppression: an int32 array (n, 3) "
      "of x, y, score in raster order. More than `capacity`: those of lowest score are left out.");
  module.def(
      "describe_freak", &describe_freak, py::arg("image"), py::arg("points"),
      "FREAK descriptors at points (int32, x and y in the first two columns): uint8 (n, 64), "
      "orientation bins (n,) of 1/256 turn, and bool (n,): false where the pattern leaves the "
      "picture.");
  module.def("match_hamming", &match_hamming, py::arg("queries"), py::arg("candidates"),
             "Best candidate of each query: int32 (n, 3) of index (-1: none), distance, second "
             "distance (513: none).");
}

}  // namespace cairn_python
