#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "arrays.hpp"

namespace cairn_python {
namespace {

const char* const kStates[] = {"initialising", "tracking", "uncertain", "lost"};

py::array_t<float> array_of(const float* values, py::ssize_t rows, py::ssize_t columns) {
  return py::array_t<float>({rows, columns}, values);
}

/// (qw, qx, qy, qz, x, y, z)
py::array_t<float> array_of(const cairn_transform& T) {
  const float values[] = {T.qw, T.qx, T.qy, T.qz, T.x, T.y, T.z};
  return py::array_t<float>(7, values);
}

cairn_transform transform_of(const py::array& array) {
  const auto own = need_array<float>(array, "T_vehicle_camera", {7});
  const float* const v = own.data();
  return {v[0], v[1], v[2], v[3], v[4], v[5], v[6]};
}

py::dict dict_of(const cairn_report& report) {
  py::dict out;
  out["t_us"] = report.t_us;
  out["status"] = cairn_status_text(report.status);
  out["state"] = kStates[report.state];
  out["T_map_camera"] = array_of(report.T_map_camera);
  out["searched"] = report.searched;
  out["matches"] = report.matches;
  out["inliers"] = report.inliers;
  out["landmarks"] = report.landmarks;
  out["reactivated"] = report.reactivated;
  out["work"] = report.work;
  out["relocalised"] = report.relocalised;
  return out;
}

py::dict dict_of(const cairn_health& h) {
  py::dict out;
#define CAIRN_COUNTER(name) out[#name] = h.name
  CAIRN_COUNTER(non_finite_inputs);
  CAIRN_COUNTER(time_errors);
  CAIRN_COUNTER(images_refused);
  CAIRN_COUNTER(frame_gaps);
  CAIRN_COUNTER(odometry_refused);
  CAIRN_COUNTER(odometry_glitches);
  CAIRN_COUNTER(odometry_timeouts);
  CAIRN_COUNTER(repeated_images);
  CAIRN_COUNTER(innovations_used);
  CAIRN_COUNTER(innovations_gated);
  CAIRN_COUNTER(innovations_singular);
  CAIRN_COUNTER(ransac_no_consensus);
  CAIRN_COUNTER(landmarks_added);
  CAIRN_COUNTER(landmarks_removed);
  CAIRN_COUNTER(landmarks_replaced);
  CAIRN_COUNTER(landmarks_refused);
  CAIRN_COUNTER(candidates_dropped);
  CAIRN_COUNTER(corners_dropped);
  CAIRN_COUNTER(searches_deferred);
  CAIRN_COUNTER(covariance_repairs);
  CAIRN_COUNTER(depth_repairs);
  CAIRN_COUNTER(reacquisitions);
  CAIRN_COUNTER(resets);
  CAIRN_COUNTER(losses);
  CAIRN_COUNTER(landmarks_archived);
  CAIRN_COUNTER(landmarks_reactivated);
  CAIRN_COUNTER(map_messages_dropped);
  CAIRN_COUNTER(relocalisations);
  CAIRN_COUNTER(false_relocalisations_refused);
  CAIRN_COUNTER(budget_exceeded);
  CAIRN_COUNTER(low_texture_frames);
  CAIRN_COUNTER(mount_suspicions);
  CAIRN_COUNTER(ground_suspicions);
  CAIRN_COUNTER(yaw_suspicions);
#undef CAIRN_COUNTER
  return out;
}

/// What the trackers' calls are named.
struct VehicleCalls {
  using Tracker = cairn_vehicle;
  using Memory = cairn_vehicle_memory;
  static constexpr std::size_t kLandmarks = CAIRN_VEHICLE_MAX_LANDMARKS;
  static constexpr std::size_t kMapBytes = CAIRN_VEHICLE_MAP_BYTES;
  static constexpr auto kProcess = &cairn_vehicle_process_frame;
  static constexpr auto kLandmarksOf = &cairn_vehicle_get_landmarks;
  static constexpr auto kHealthOf = &cairn_vehicle_get_health;
  static constexpr auto kHash = &cairn_vehicle_hash;
  static constexpr auto kSave = &cairn_vehicle_save_map;
  static constexpr auto kLoad = &cairn_vehicle_load_map;
};
struct HandheldCalls {
  using Tracker = cairn_handheld;
  using Memory = cairn_handheld_memory;
  static constexpr std::size_t kLandmarks = CAIRN_HANDHELD_MAX_LANDMARKS;
  static constexpr std::size_t kMapBytes = CAIRN_HANDHELD_MAP_BYTES;
  static constexpr auto kProcess = &cairn_handheld_process_frame;
  static constexpr auto kLandmarksOf = &cairn_handheld_get_landmarks;
  static constexpr auto kHealthOf = &cairn_handheld_get_health;
  static constexpr auto kHash = &cairn_handheld_hash;
  static constexpr auto kSave = &cairn_handheld_save_map;
  static constexpr auto kLoad = &cairn_handheld_load_map;
};

struct WindowCalls {
  using Tracker = cairn_window;
  using Memory = cairn_window_memory;
  static constexpr std::size_t kLandmarks = CAIRN_WINDOW_MAX_LANDMARKS;
  static constexpr auto kProcess = &cairn_window_process_frame;
  static constexpr auto kLandmarksOf = &cairn_window_get_landmarks;
  static constexpr auto kHealthOf = &cairn_window_get_health;
  static constexpr auto kHash = &cairn_window_hash;
};

template <class Calls>
class Tracker {
 public:
  /// The frame's report. ValueError for a frame that was refused.
  py::dict process_frame(const py::array& image, std::int64_t t_us) {
    const Picture picture(image);
    const cairn_image own = picture.image();
    cairn_report report = {};
    const std::int64_t untouched = t_us == 0 ? 1 : 0;
    report.t_us = untouched;
    const cairn_status status = Calls::kProcess(tracker_, &own, t_us, &report);
    if (report.t_us == untouched) need(status, "process_frame");
    report.status = status;
    return dict_of(report);
  }
  py::tuple landmarks() const {
    std::vector<cairn_landmark> all(Calls::kLandmarks);
    std::size_t count = 0;
    need(Calls::kLandmarksOf(tracker_, all.data(), all.size(), &count), "landmarks");
    const auto rows = static_cast<py::ssize_t>(count);
    py::array_t<std::uint32_t> ids(rows);
    py::array_t<float> positions({rows, py::ssize_t(3)});
    py::array_t<float> covariances({rows, py::ssize_t(3), py::ssize_t(3)});
    for (py::ssize_t i = 0; i < rows; ++i) {
      const cairn_landmark& landmark = all[static_cast<std::size_t>(i)];
      *ids.mutable_data(i) = landmark.id;
      std::copy_n(landmark.position, 3, positions.mutable_data(i, 0));
      std::copy_n(landmark.covariance, 9, covariances.mutable_data(i, 0, 0));
    }
    return py::make_tuple(ids, positions, covariances);
  }
  py::dict health() const {
    cairn_health own = {};
    need(Calls::kHealthOf(tracker_, &own), "health");
    return dict_of(own);
  }
  std::uint64_t hash() const { return Calls::kHash(tracker_); }

 protected:
  std::unique_ptr<typename Calls::Memory> memory_ = std::make_unique<typename Calls::Memory>();
  typename Calls::Tracker* tracker_ = nullptr;
};

/// A tracker whose map can be saved.
template <class Calls>
class MappingTracker : public Tracker<Calls> {
 public:
  py::bytes save_map() {
    std::vector<std::uint8_t> bytes(Calls::kMapBytes);
    std::size_t used = 0;
    need(Calls::kSave(this->tracker_, bytes.data(), bytes.size(), &used), "save_map");
    return py::bytes(reinterpret_cast<const char*>(bytes.data()), used);
  }
  void load_map(const std::string& bytes) {
    need(Calls::kLoad(this->tracker_, reinterpret_cast<const std::uint8_t*>(bytes.data()),
                      bytes.size()),
         "load_map");
  }
};

class Vehicle : public MappingTracker<VehicleCalls> {
 public:
  Vehicle(const cairn_camera& camera, const py::array& T_vehicle_camera,
          const cairn_vehicle_start& start, const cairn_vehicle_parameters& parameters) {
    const cairn_transform mounting = transform_of(T_vehicle_camera);
    need(cairn_vehicle_initialise(memory_.get(), sizeof *memory_, &camera, &mounting, &start,
                                  &parameters, &tracker_),
         "VehicleTracker");
  }
  std::string add(std::int64_t t_us, cairn_odometry_kind kind, float speed, float turn) {
    const cairn_odometry sample = {t_us, kind, speed, turn};
    const cairn_status status = cairn_vehicle_add_odometry(tracker_, &sample);
    // Gated and gaps are taken, or may be: they are told.
    if (status != CAIRN_GATED && status != CAIRN_TIME_GAP) need(status, "odometry");
    return cairn_status_text(status);
  }
  py::tuple pose() const {
    cairn_vehicle_pose own = {};
    need(cairn_vehicle_get_pose(tracker_, &own), "pose");
    const float values[] = {own.x_m, own.y_m, own.heading_rad};
    return py::make_tuple(py::array_t<float>(3, values), array_of(own.covariance, 3, 3));
  }
};

class Handheld : public MappingTracker<HandheldCalls> {
 public:
  Handheld(const cairn_camera& camera, const cairn_handheld_parameters& parameters) {
    need(cairn_handheld_initialise(memory_.get(), sizeof *memory_, &camera, &parameters, &tracker_),
         "HandheldTracker");
  }
  py::array_t<float> covariance() const {
    float own[36];
    need(cairn_handheld_get_covariance(tracker_, own), "covariance");
    return array_of(own, 6, 6);
  }
};

class Window : public Tracker<WindowCalls> {
 public:
  py::tuple focal_scale() const {
    float scale = 1.0F;
    float sigma = 0.0F;
    need(cairn_window_get_focal_scale(tracker_, &scale, &sigma), "focal_scale");
    return py::make_tuple(scale, sigma);
  }
  Window(const cairn_camera& camera, const cairn_window_parameters& parameters) {
    need(cairn_window_initialise(memory_.get(), sizeof *memory_, &camera, &parameters, &tracker_),
         "WindowTracker");
  }
  bool add_angular_rate(std::int64_t t_us, float x, float y, float z) {
    const cairn_angular_rate sample{t_us, x, y, z};
    return cairn_window_add_angular_rate(tracker_, &sample) == CAIRN_OK;
  }
  py::dict gyro() const {
    cairn_gyro own;
    need(cairn_window_get_gyro(tracker_, &own), "gyro");
    const char* const kTrust[] = {"unproven", "agrees", "contradicted"};
    py::dict result;
    result["trust"] = kTrust[own.trust];
    result["difference"] = own.difference;
    result["bias"] = py::make_tuple(own.bias_x_radps, own.bias_y_radps, own.bias_z_radps);
    result["bias_sigma"] = own.bias_sigma_radps;
    result["time_offset_s"] = own.time_offset_s;
    result["time_offset_sigma_s"] = own.time_offset_sigma_s;
    result["samples"] = own.samples;
    result["refused"] = own.refused;
    result["saturated"] = own.saturated;
    result["gaps"] = own.gaps;
    return result;
  }
  py::array_t<float> covariance() const {
    float own[36];
    need(cairn_window_get_covariance(tracker_, own), "covariance");
    return array_of(own, 6, 6);
  }
};

template <class Class, class Bound>
void add_common(Bound& bound) {
  bound
      .def("process_frame", &Class::process_frame, py::arg("image"), py::arg("t_us"),
           "Tracks one frame (uint8, rows by columns) and gives its report. ValueError when it is "
           "refused: its size, or a time that is not later than the last.")
      .def("landmarks", &Class::landmarks,
           "ids (n,), positions in the map (n, 3), covariances (n, 3, 3).")
      .def("health", &Class::health, "Counters since the start.")
      .def_property_readonly("hash", &Class::hash,
                             "Fingerprint of the last accepted frame, equal on every target.");
}

template <class Class, class Bound>
void add_map(Bound& bound) {
  bound.def("save_map", &Class::save_map, "The map as bytes.")
      .def("load_map", &Class::load_map, py::arg("bytes"),
           "Takes a saved map in place of the present one. ValueError: nothing changed.");
}

#define CAIRN_FIELD(type, name) def_readwrite(#name, &type::name)

void add_settings(py::module_& module) {
  py::class_<cairn_camera>(
      module, "Camera",
      "Camera with OpenCV's distortion, rational where k4 to k6 are given, or a "
      "fisheye with k1 to k4; px.")
      .def(py::init([](int width, int height, float fx, float fy, float cx, float cy, float k1,
                       float k2, float p1, float p2, float k3, float k4, float k5, float k6,
                       bool fisheye) {
             const cairn_lens lens = fisheye ? CAIRN_LENS_FISHEYE : CAIRN_LENS_RADIAL_TANGENTIAL;
             return cairn_camera{fx, fy,    cx,     cy, k1, k2, p1,  p2,
                                 k3, width, height, k4, k5, k6, lens};
           }),
           py::arg("width"), py::arg("height"), py::arg("fx"), py::arg("fy"), py::arg("cx"),
           py::arg("cy"), py::arg("k1") = 0.0F, py::arg("k2") = 0.0F, py::arg("p1") = 0.0F,
           py::arg("p2") = 0.0F, py::arg("k3") = 0.0F, py::arg("k4") = 0.0F, py::arg("k5") = 0.0F,
           py::arg("k6") = 0.0F, py::arg("fisheye") = false);
  py::class_<cairn_vehicle_start>(module, "VehicleStart", "Where the vehicle starts, in the map.")
      .def(py::init([](std::int64_t t_us, float x, float y, float heading, float position_variance,
                       float heading_variance) {
             return cairn_vehicle_start{t_us, x, y, heading, position_variance, heading_variance};
           }),
           py::arg("t_us") = 0, py::arg("x") = 0.0F, py::arg("y") = 0.0F, py::arg("heading") = 0.0F,
           py::arg("position_variance") = 0.0F, py::arg("heading_variance") = 0.0F);
  py::class_<cairn_vehicle_parameters>(module, "VehicleParameters", "As in cairn/c_api/vehicle.h.")
      .def(py::init(&cairn_vehicle_default_parameters))
      .CAIRN_FIELD(cairn_vehicle_parameters, sigma_speed_mps)
      .CAIRN_FIELD(cairn_vehicle_parameters, sigma_turn)
      .CAIRN_FIELD(cairn_vehicle_parameters, wheelbase_m)
      .CAIRN_FIELD(cairn_vehicle_parameters, sample_period_s)
      .CAIRN_FIELD(cairn_vehicle_parameters, sigma_px)
      .CAIRN_FIELD(cairn_vehicle_parameters, floor_sigma_m)
      .CAIRN_FIELD(cairn_vehicle_parameters, sigma_pitch_rad)
      .CAIRN_FIELD(cairn_vehicle_parameters, sigma_roll_rad)
      .CAIRN_FIELD(cairn_vehicle_parameters, tilt_time_constant_s)
      .CAIRN_FIELD(cairn_vehicle_parameters, work_limit)
      .CAIRN_FIELD(cairn_vehicle_parameters, max_step_us)
      .CAIRN_FIELD(cairn_vehicle_parameters, seed);
  py::class_<cairn_handheld_parameters>(module, "HandheldParameters",
                                        "As in cairn/c_api/handheld.h.")
      .def(py::init(&cairn_handheld_default_parameters))
      .CAIRN_FIELD(cairn_handheld_parameters, sigma_px)
      .CAIRN_FIELD(cairn_handheld_parameters, least_velocity_noise)
      .CAIRN_FIELD(cairn_handheld_parameters, most_velocity_noise)
      .CAIRN_FIELD(cairn_handheld_parameters, least_rate_noise)
      .CAIRN_FIELD(cairn_handheld_parameters, most_rate_noise)
      .CAIRN_FIELD(cairn_handheld_parameters, fading_factor)
      .CAIRN_FIELD(cairn_handheld_parameters, adaptive_fading)
      .CAIRN_FIELD(cairn_handheld_parameters, estimate_focal_length)
      .CAIRN_FIELD(cairn_handheld_parameters, work_limit)
      .CAIRN_FIELD(cairn_handheld_parameters, max_step_us)
      .CAIRN_FIELD(cairn_handheld_parameters, seed);
  py::class_<cairn_gyro_parameters>(module, "GyroParameters", "As in cairn/c_api/window.h.")
      .def(py::init([] { return cairn_window_default_parameters().gyro; }))
      .CAIRN_FIELD(cairn_gyro_parameters, qw)
      .CAIRN_FIELD(cairn_gyro_parameters, qx)
      .CAIRN_FIELD(cairn_gyro_parameters, qy)
      .CAIRN_FIELD(cairn_gyro_parameters, qz)
      .CAIRN_FIELD(cairn_gyro_parameters, noise_density)
      .CAIRN_FIELD(cairn_gyro_parameters, bias_sigma_radps)
      .CAIRN_FIELD(cairn_gyro_parameters, bias_walk)
      .CAIRN_FIELD(cairn_gyro_parameters, time_sigma_s)
      .CAIRN_FIELD(cairn_gyro_parameters, range_radps);
  py::class_<cairn_window_parameters>(module, "WindowParameters", "As in cairn/c_api/window.h.")
      .def(py::init(&cairn_window_default_parameters))
      .CAIRN_FIELD(cairn_window_parameters, sigma_px)
      .CAIRN_FIELD(cairn_window_parameters, focal_sigma)
      .CAIRN_FIELD(cairn_window_parameters, work_limit)
      .CAIRN_FIELD(cairn_window_parameters, max_step_us)
      .CAIRN_FIELD(cairn_window_parameters, seed)
      .CAIRN_FIELD(cairn_window_parameters, gyro)
      .CAIRN_FIELD(cairn_window_parameters, row_time_s)
      .CAIRN_FIELD(cairn_window_parameters, column_time_s);
}

#undef CAIRN_FIELD

}  // namespace

void add_trackers(py::module_& module) {
  add_settings(module);
  py::class_<Vehicle> vehicle(module, "VehicleTracker",
                              "Camera tracking on a planar vehicle, from video and odometry.");
  vehicle
      .def(py::init<const cairn_camera&, const py::array&, const cairn_vehicle_start&,
                    const cairn_vehicle_parameters&>(),
           py::arg("camera"), py::arg("T_vehicle_camera"), py::arg("start") = cairn_vehicle_start{},
           py::arg("parameters") = cairn_vehicle_default_parameters(),
           "T_vehicle_camera: float32 (qw, qx, qy, qz, x, y, z).")
      .def(
          "add_twist",
          [](Vehicle& own, std::int64_t t_us, float speed, float rate) {
            return own.add(t_us, CAIRN_TWIST, speed, rate);
          },
          py::arg("t_us"), py::arg("speed"), py::arg("yaw_rate"),
          "Odometry since the sample before: m/s, rad/s. Gives \"ok\", \"gated\" or \"time_gap\".")
      .def(
          "add_ackermann",
          [](Vehicle& own, std::int64_t t_us, float speed, float steering) {
            return own.add(t_us, CAIRN_ACKERMANN, speed, steering);
          },
          py::arg("t_us"), py::arg("speed"), py::arg("steering"),
          "The same with a steering angle, rad.")
      .def("pose", &Vehicle::pose, "(x, y, heading) in the map and its covariance, (3, 3).");
  add_common<Vehicle>(vehicle);
  add_map<Vehicle>(vehicle);
  py::class_<Handheld> handheld(module, "HandheldTracker",
                                "Camera tracking from video alone by the filter MonoEkf.");
  handheld
      .def(py::init<const cairn_camera&, const cairn_handheld_parameters&>(), py::arg("camera"),
           py::arg("parameters") = cairn_handheld_default_parameters())
      .def("covariance", &Handheld::covariance,
           "Of position (map axes) and rotation vector (camera axes), (6, 6).");
  add_common<Handheld>(handheld);
  add_map<Handheld>(handheld);
  py::class_<Window> window(module, "WindowTracker",
                            "Camera tracking from video alone by a window of keyframes, for video "
                            "that nobody tuned for.");
  window
      .def(py::init<const cairn_camera&, const cairn_window_parameters&>(), py::arg("camera"),
           py::arg("parameters") = cairn_window_default_parameters())
      .def("covariance", &Window::covariance,
           "Of position (map axes) and rotation vector (camera axes), (6, 6).")
      .def("focal_scale", &Window::focal_scale,
           "The focal length as a factor on the one that was told, and its standard deviation.")
      .def("add_angular_rate", &Window::add_angular_rate, py::arg("t_us"), py::arg("x"),
           py::arg("y"), py::arg("z"),
           "Takes a gyroscope's sample, rad/s about its own axes; before the frame that it "
           "precedes. "
           "False: refused or saturated, and counted.")
      .def("gyro", &Window::gyro,
           "Whether the gyroscope turns as the pictures do, its bias and time offset.");
  add_common<Window>(window);
}

}  // namespace cairn_python
