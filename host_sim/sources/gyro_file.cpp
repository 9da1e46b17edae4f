#include "host_sim/sources/gyro_file.hpp"

#include <cmath>

#include <fmt/format.h>

#include "host_sim/io/camera_formats/camera_section.hpp"
#include "host_sim/io/config_document.hpp"
#include "host_sim/io/csv_units.hpp"
#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

Quantity rate_about(const char* column, const char* ros_field, const char* axis) {
  const std::string name = axis;
  return {column,
          {"w" + name, "gyro_" + name, "gyroscope_" + name, "omega_" + name, "g" + name,
           "gyro" + name, "angular_velocity_" + name, "w_rs_s_" + name},
          {{"radps", 1.0},
           {"rad/s", 1.0},
           {"rad_s^-1", 1.0},
           {"rad_s-1", 1.0},
           {"rad_s", 1.0},
           {"degps", kDegree},
           {"dps", kDegree},
           {"deg/s", kDegree},
           {"deg_s", kDegree},
           {"\xC2\xB0/s", kDegree}},
          ros_field};
}

/// The columns that the documentation names, in rad/s, else one with a unit in its name.
QuantityColumn rate_column(const CsvReader& csv, const char* name, const char* axis) {
  if (csv.has(name)) return {csv.column(name), 1.0};
  static const char* const kColumns[3] = {"wx_radps", "wy_radps", "wz_radps"};
  static const char* const kFields[3] = {"angular_velocity.x", "angular_velocity.y",
                                         "angular_velocity.z"};
  const int i = axis[0] - 'x';
  return find_quantity(csv, rate_about(kColumns[i], kFields[i], axis));
}

/// A column `t` without a unit is in seconds, unless it counts from 1970.
class GyroTime {
 public:
  explicit GyroTime(const CsvReader& csv) : plain_(csv.has("t")), time_(csv) {
    if (plain_) index_ = csv.column("t");
  }
  std::int64_t t_us(const CsvReader& csv) const {
    constexpr double kYear2001_s = 1e9;
    if (!plain_ || csv.number(index_) >= kYear2001_s) return time_.t_us(csv);
    return parse_time_us(csv.number(index_), 1e6, csv.path(), csv.line());
  }

 private:
  bool plain_;
  std::size_t index_ = 0;
  TimeColumn time_;
};

std::optional<double> find_positive(const CameraSection& section, const char* key) {
  if (!section.has(key)) return std::nullopt;
  const char* const kWhat = "a number above 0 and at most 1";
  const double number = section.number(key, kWhat);
  if (number > 0.0 && number <= 1.0) return number;
  section.fail(key, fmt::format("expected {}, found {}", kWhat, number));
}

}  // namespace

std::vector<AngularRateSample> read_gyro(const fs::path& path) {
  CsvReader csv(path);
  const GyroTime time(csv);
  const QuantityColumn columns[3] = {rate_column(csv, "wx", "x"), rate_column(csv, "wy", "y"),
                                     rate_column(csv, "wz", "z")};
  std::vector<AngularRateSample> samples;
  while (csv.next()) {
    AngularRateSample sample;
    sample.t_us = time.t_us(csv);
    if (!samples.empty() && sample.t_us <= samples.back().t_us) {
      throw InputError(path, csv.line(),
                       fmt::format("expected times in increasing order, found {:.6f} s after "
                                   "{:.6f} s",
                                   1e-6 * static_cast<double>(sample.t_us),
                                   1e-6 * static_cast<double>(samples.back().t_us)));
    }
    for (int i = 0; i < 3; ++i) {
      const double value = columns[i].value(csv);
      constexpr auto kMost = static_cast<double>(GyroParameters::kLargestRate_radps);
      if (!(std::abs(value) <= kMost)) {
        csv.fail(columns[i].index,
                 fmt::format("expected a rate in rad/s of at most {} either way, found {:.6g}",
                             kMost, value));
      }
      sample.rate_radps(i) = static_cast<float>(value);
    }
    samples.push_back(sample);
  }
  if (samples.size() < 2) throw InputError(path, "expected two or more rows of a gyroscope");
  return samples;
}

ImuFile read_imu_file(const fs::path& path) {
  const nlohmann::json document =
      parse_config_document(path, read_config_text(path, "the description of an IMU"));
  const CameraSection whole(path, document);
  const CameraSection section = whole.has("imu0") ? whole.child("imu0") : whole;
  ImuFile file;
  file.noise_density = find_positive(section, "gyroscope_noise_density");
  file.bias_walk = find_positive(section, "gyroscope_random_walk");
  file.T_body_imu = section.find_pose("T_BS");
  if (!file.noise_density && !file.T_body_imu) {
    throw InputError(path, "expected gyroscope_noise_density or T_BS, as in EuRoC's sensor.yaml");
  }
  return file;
}

}  // namespace cairn::host
