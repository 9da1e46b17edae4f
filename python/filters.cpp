#include <array>
#include <memory>
#include <pybind11/stl.h>
#include <vector>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

#include "arrays.hpp"

namespace cairn_python {
namespace {

constexpr int kLandmarks = 128;

py::array_t<double> array_of(const cairn::Matrix3<double>& matrix) {
  py::array_t<double> out({py::ssize_t(3), py::ssize_t(3)});
  for (int i = 0; i < 9; ++i) *out.mutable_data(i / 3, i % 3) = matrix(i / 3, i % 3);
  return out;
}

cairn::Matrix2<double> matrix2_of(const double* values) {
  cairn::Matrix2<double> matrix;
  matrix << values[0], values[1], values[2], values[3];
  return matrix;
}

/// A planar filter in double precision for 2-D landmarks.
template <class Filter>
class Planar {
 public:
  Planar(const std::array<double, 3>& pose, const py::array& covariance)
      : filter_(std::make_unique<Filter>()) {
    const auto own = need_array<double>(covariance, "covariance", {3, 3});
    cairn::Matrix3<double> P;
    for (int i = 0; i < 9; ++i) P(i / 3, i % 3) = *own.data(i / 3, i % 3);
    cairn::PlanarPose<double> start;
    start.position = {pose[0], pose[1]};
    start.heading = pose[2];
    need(filter_->initialise(start, P), "initialise");
  }

  void predict_twist(double speed, double rate, double dt, double sigma_speed, double sigma_rate) {
    need(filter_->predict(cairn::twist_increment<double>(speed, rate, dt, sigma_speed, sigma_rate,
                                                         cairn::IncrementModel::kExactArc)),
         "predict_twist");
  }
  void predict_ackermann(double speed, double steering, double dt, double wheelbase,
                         double sigma_speed, double sigma_steering) {
    need(filter_->predict(cairn::ackermann_increment<double>(speed, steering, dt, wheelbase,
                                                             sigma_speed, sigma_steering,
                                                             cairn::IncrementModel::kExactArc)),
         "predict_ackermann");
  }
  void add_landmark(cairn::LandmarkId id, const std::array<double, 2>& y, const py::array& R) {
    const auto own = need_array<double>(R, "R", {2, 2});
    need(filter_->add_landmark(id, {y[0], y[1]}, matrix2_of(own.data())), "add_landmark");
  }
  py::dict update_points(const py::array& ids, const py::array& points, const py::array& R) {
    const auto own_ids = need_array<std::uint32_t>(ids, "ids", {-1});
    const py::ssize_t count = own_ids.shape(0);
    const auto own_points = need_array<double>(points, "points", {count, 2});
    const auto own_R = need_array<double>(R, "R", {2, 2});
    std::vector<cairn::PointObservation<double>> seen(static_cast<std::size_t>(count));
    for (py::ssize_t i = 0; i < count; ++i) {
      seen[static_cast<std::size_t>(i)] = {*own_ids.data(i),
                                           {*own_points.data(i, 0), *own_points.data(i, 1)},
                                           matrix2_of(own_R.data())};
    }
    cairn::UpdateReport report;
    need(filter_->update_points({seen.data(), static_cast<int>(seen.size())}, report),
         "update_points");
    return summary(report);
  }
  py::dict update_range_bearing(const py::array& ids, const py::array& ranges,
                                const py::array& bearings, double sigma_range, double sigma_bearing,
                                double sensor_offset) {
    const auto own_ids = need_array<std::uint32_t>(ids, "ids", {-1});
    const py::ssize_t count = own_ids.shape(0);
    const auto own_ranges = need_array<double>(ranges, "ranges", {count});
    const auto own_bearings = need_array<double>(bearings, "bearings", {count});
    std::vector<cairn::RangeBearingObservation<double>> seen(static_cast<std::size_t>(count));
    for (py::ssize_t i = 0; i < count; ++i) {
      seen[static_cast<std::size_t>(i)] = {*own_ids.data(i), *own_ranges.data(i),
                                           *own_bearings.data(i), sigma_range, sigma_bearing};
    }
    cairn::UpdateReport report;
    need(filter_->update_range_bearing({seen.data(), static_cast<int>(seen.size())}, sensor_offset,
                                       report),
         "update_range_bearing");
    return summary(report);
  }

  py::array_t<double> pose() const {
    const cairn::PlanarPose<double> own = filter_->pose();
    py::array_t<double> out(3);
    *out.mutable_data(0) = own.position.x();
    *out.mutable_data(1) = own.position.y();
    *out.mutable_data(2) = own.heading;
    return out;
  }
  py::array_t<double> covariance() const { return array_of(filter_->pose_covariance()); }
  py::tuple landmarks() const {
    const py::ssize_t count = filter_->landmark_count();
    py::array_t<std::uint32_t> ids(count);
    py::array_t<double> positions({count, py::ssize_t(2)});
    py::array_t<double> covariances({count, py::ssize_t(2), py::ssize_t(2)});
    for (py::ssize_t i = 0; i < count; ++i) {
      const int slot = static_cast<int>(i);
      *ids.mutable_data(i) = filter_->landmark_id(slot);
      const auto p = filter_->landmark_position(slot);
      const auto P = filter_->landmark_covariance(slot);
      for (int k = 0; k < 2; ++k) *positions.mutable_data(i, k) = p(k);
      for (int k = 0; k < 4; ++k) *covariances.mutable_data(i, k / 2, k % 2) = P(k / 2, k % 2);
    }
    return py::make_tuple(ids, positions, covariances);
  }

 private:
  static py::dict summary(const cairn::UpdateReport& report) {
    py::dict out;
    out["seen"] = report.matches;
    out["gated"] = report.gated;
    out["nis"] = report.nis;
    out["nis_dof"] = report.nis_dof;
    return out;
  }

  std::unique_ptr<Filter> filter_;
};

template <class Filter>
void add_planar(py::module_& module, const char* name, const char* text) {
  using Bound = Planar<Filter>;
  py::class_<Bound>(module, name, text)
      .def(py::init<const std::array<double, 3>&, const py::array&>(), py::arg("pose"),
           py::arg("covariance"), "pose: x, y (m), heading (rad); covariance of it, (3, 3).")
      .def("predict_twist", &Bound::predict_twist, py::arg("speed"), py::arg("yaw_rate"),
           py::arg("dt"), py::arg("sigma_speed"), py::arg("sigma_yaw_rate"),
           "Odometry held for dt seconds: m/s, rad/s.")
      .def("predict_ackermann", &Bound::predict_ackermann, py::arg("speed"), py::arg("steering"),
           py::arg("dt"), py::arg("wheelbase"), py::arg("sigma_speed"), py::arg("sigma_steering"),
           "The same of a car: m/s, rad, s, m.")
      .def("add_landmark", &Bound::add_landmark, py::arg("id"), py::arg("y"), py::arg("R"),
           "A landmark seen at y (m, vehicle frame) with noise covariance R, (2, 2).")
      .def("update_points", &Bound::update_points, py::arg("ids"), py::arg("points"), py::arg("R"),
           "Sightings of landmarks: uint32 (n,), points in the vehicle frame (n, 2), covariance R "
           "of "
           "each. Unknown ids are passed over. Gives how many were seen and gated, and the NIS "
           "with its degrees of freedom.")
      .def("update_range_bearing", &Bound::update_range_bearing, py::arg("ids"), py::arg("ranges"),
           py::arg("bearings"), py::arg("sigma_range"), py::arg("sigma_bearing"),
           py::arg("sensor_offset") = 0.0,
           "The same by ranges (m) and bearings (rad, left positive) from a sensor ahead of the "
           "vehicle's centre.")
      .def_property_readonly("pose", &Bound::pose, "x, y, heading.")
      .def_property_readonly("covariance", &Bound::covariance, "Of the pose, (3, 3).")
      .def("landmarks", &Bound::landmarks, "ids (n,), positions (n, 2), covariances (n, 2, 2).");
}

}  // namespace

void add_filters(py::module_& module) {
  add_planar<cairn::GroupIekfSlam<double, kLandmarks>>(
      module, "GroupIekfSlam",
      "The default planar filter, in double precision, for at most 128 landmarks in the plane.");
  add_planar<cairn::EkfSlam<double, kLandmarks>>(
      module, "EkfSlam", "Plain EKF-SLAM with the same interface: the baseline.");
}

}  // namespace cairn_python
