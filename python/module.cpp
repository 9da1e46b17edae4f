#include "cairn/version.hpp"

#include "arrays.hpp"

PYBIND11_MODULE(cairn, module) {
  module.doc() =
      "Cairn on numpy arrays: trackers, planar and monocular filters, corners and descriptors. "
      "Units "
      "and frames: docs/explanation/architecture.md of the project.";
  module.attr("__version__") = cairn::kVersion;
  cairn_python::add_trackers(module);
  cairn_python::add_filters(module);
  cairn_python::add_vision(module);
}
