#pragma once

#include <cstdint>
#include <initializer_list>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <stdexcept>
#include <string>

#include "cairn/base/status.hpp"
#include "cairn/cairn.h"
#include "cairn/vision/image.hpp"

namespace cairn_python {

namespace py = pybind11;

/// ValueError "what: status", unless it is ok.
inline void need(cairn_status status, const char* what) {
  if (status != CAIRN_OK)
    throw py::value_error(std::string(what) + ": " + cairn_status_text(status));
}
inline void need(cairn::Status status, const char* what) {
  if (!ok(status)) throw py::value_error(std::string(what) + ": " + to_string(status));
}

/// An array of this type and shape (-1: any extent), its rows without gaps. TypeError and
/// ValueError name what is wrong: nothing is converted in silence.
template <class T>
py::array_t<T, py::array::c_style> need_array(const py::array& array, const char* name,
                                              std::initializer_list<py::ssize_t> shape) {
  if (!py::isinstance<py::array_t<T>>(array)) {
    throw py::type_error(std::string(name) + ": expected " +
                         py::str(py::dtype::of<T>()).cast<std::string>() + ", got " +
                         py::str(array.dtype()).cast<std::string>());
  }
  bool good = array.ndim() == static_cast<py::ssize_t>(shape.size());
  std::string wanted;
  py::ssize_t axis = 0;
  for (const py::ssize_t extent : shape) {
    good = good && (extent < 0 || array.shape(axis) == extent);
    wanted += (axis++ > 0 ? ", " : "") + (extent < 0 ? std::string("n") : std::to_string(extent));
  }
  if (!good) {
    const py::object got = array.attr("shape");
    throw py::value_error(std::string(name) + ": expected the shape (" + wanted + "), got " +
                          py::str(got).cast<std::string>());
  }
  return py::array_t<T, py::array::c_style>::ensure(array);
}

/// A grey picture, rows by columns.
class Picture {
 public:
  explicit Picture(const py::array& array)
      : pixels_(need_array<std::uint8_t>(array, "image", {-1, -1})) {}

  int width() const { return static_cast<int>(pixels_.shape(1)); }
  int height() const { return static_cast<int>(pixels_.shape(0)); }
  cairn_image image() const { return {pixels_.data(), width(), height(), width()}; }
  cairn::ImageView view() const { return {pixels_.data(), width(), height(), width()}; }

 private:
  py::array_t<std::uint8_t, py::array::c_style> pixels_;
};

void add_trackers(py::module_& module);
void add_filters(py::module_& module);
void add_vision(py::module_& module);

}  // namespace cairn_python
