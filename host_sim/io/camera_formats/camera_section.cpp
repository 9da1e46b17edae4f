#include "host_sim/io/camera_formats/camera_section.hpp"

#include <cctype>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/number_text.hpp"
#include "host_sim/io/pose_file.hpp"

namespace cairn::host {
namespace {

using nlohmann::json;

constexpr double kMostDistance_m = 50.0;  // of a camera on its vehicle; further ones are in mm

bool all_zero(const json& value) {
  if (value.is_string()) {
    std::string text = value.get<std::string>();
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    double number = 0.0;
    return text.empty() || text == "false" || text == "no" ||
           (number_problem(text, number).empty() && number == 0.0);
  }
  if (value.is_object() && value.contains("data")) return all_zero(value["data"]);
  for (const json& item : value) {
    if (!all_zero(item)) return false;
  }
  return true;
}

}  // namespace

CameraSection::CameraSection(std::filesystem::path file, const json& object, std::string path)
    : file_(std::move(file)), object_(&object), path_(std::move(path)) {}

bool CameraSection::has(const std::string& key) const {
  return object_->is_object() && object_->contains(key);
}

bool CameraSection::has_child(const std::string& key) const {
  return has(key) && (*object_)[key].is_object();
}

std::string CameraSection::one_of(std::initializer_list<const char*> keys) const {
  std::string found;
  for (const char* key : keys) {
    if (!has(key)) continue;
    if (!found.empty()) fail(key, fmt::format("expected this key or '{}', found both", found));
    found = key;
  }
  return found;
}

std::vector<std::string> CameraSection::keys() const {
  std::vector<std::string> names;
  if (object_->is_object()) {
    for (const auto& [name, value] : object_->items()) names.push_back(name);
  }
  return names;
}

std::vector<std::string> CameraSection::unread_keys() const {
  std::vector<std::string> names;
  for (const std::string& name : keys()) {
    if (read_->count(name) == 0) names.push_back(name);
  }
  return names;
}

const json& CameraSection::take(const std::string& key, const std::string& what) const {
  if (!has(key)) fail(key, fmt::format("missing; expected {}", what));
  read_->insert(key);
  return (*object_)[key];
}

double CameraSection::number(const std::string& key, const std::string& what) const {
  return to_number(take(key, what), key, what);
}

std::string CameraSection::text(const std::string& key, const std::string& what) const {
  const json& value = take(key, what);
  if (!value.is_string()) fail(key, fmt::format("expected {}, found a list or keys", what));
  return value.get<std::string>();
}

std::vector<double> CameraSection::numbers(const std::string& key, const std::string& what) const {
  const json& value = take(key, what);
  const json* list = &value;
  if (value.is_object() && value.contains("data")) list = &value["data"];
  if (!list->is_array()) fail(key, fmt::format("expected {}, found {}", what, shown(key)));
  std::vector<double> values;
  collect(*list, key, what, values);
  if (value.is_object() && value.contains("rows") && value.contains("cols")) {
    const double told = to_number(value["rows"], key, what) * to_number(value["cols"], key, what);
    if (told > static_cast<double>(values.size())) {
      fail(key, fmt::format("expected {}, as many numbers as its rows and cols say, {}, found {}",
                            what, told, values.size()));
    }
  }
  return values;
}

std::vector<double> CameraSection::matrix(const std::string& key, int rows, int cols,
                                          const std::string& what) const {
  const json& value = take(key, what);
  std::vector<double> m = numbers(key, what);
  bool fits = m.size() == static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  if (value.is_object()) {
    for (const auto& [side, length] : {std::pair{"rows", rows}, std::pair{"cols", cols}}) {
      if (value.contains(side)) fits = fits && to_number(value[side], key, what) == length;
    }
  } else if (!value.empty() && value[0].is_array()) {
    for (const json& row : value) {
      fits = fits && row.is_array() && row.size() == static_cast<std::size_t>(cols);
    }
  }
  if (!fits) {
    fail(key, fmt::format("expected {} ({}x{} numbers), found {}", what, rows, cols, shown(key)));
  }
  return m;
}

int CameraSection::extent(const std::string& key, const std::string& what) const {
  return to_extent(number(key, what), key);
}

int CameraSection::to_extent(double value, const std::string& key) const {
  if (!(value >= kLeastImageSide && value <= kLargestImageSide) || value != std::floor(value)) {
    fail(key, fmt::format("expected an image side of {} to {} pixels, found {}", kLeastImageSide,
                          kLargestImageSide, value));
  }
  return static_cast<int>(value);
}

std::optional<Rigid<double>> CameraSection::find_pose(const std::string& key) const {
  if (!has(key)) return std::nullopt;
  const std::vector<double> m = matrix(key, 4, 4, "a pose matrix, row by row");
  Matrix3<double> rotation;
  rotation << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
  Rigid<double> pose;
  if (!to_rotation(rotation, pose.rotation)) fail(key, "expected a rotation in the left 3x3 block");
  if (m[12] != 0.0 || m[13] != 0.0 || m[14] != 0.0 || m[15] != 1.0) {
    fail(key, "expected 0 0 0 1 in the last row");
  }
  pose.translation = {m[3], m[7], m[11]};
  const double distance_m = pose.translation.norm();
  if (!(distance_m <= kMostDistance_m)) {
    fail(key, fmt::format("expected a place in m, at most {:.0f} m away, found one {:.6g} m away",
                          kMostDistance_m, distance_m));
  }
  return pose;
}

CameraSection CameraSection::child(const std::string& key) const {
  const json& value = take(key, "keys of a calibration");
  if (!value.is_object()) fail(key, "expected keys of a calibration");
  return {file_, value, path_ + key + "."};
}

CameraSection CameraSection::element(const std::string& key, std::size_t index) const {
  const json& value = take(key, "a list of calibrations");
  if (!value.is_array() || index >= value.size() || !value[index].is_object()) {
    fail(key, "expected a list of calibrations");
  }
  return {file_, value[index], fmt::format("{}{}[{}].", path_, key, index)};
}

std::size_t CameraSection::length(const std::string& key) const {
  return has(key) && (*object_)[key].is_array() ? (*object_)[key].size() : 0;
}

void CameraSection::fail(const std::string& key, const std::string& problem) const {
  throw InputError(file_, path_ + key, problem);
}

std::string CameraSection::shown(const std::string& key) const {
  constexpr std::size_t kLongest = 80;
  std::string text = (*object_)[key].is_string()
                         ? (*object_)[key].get<std::string>()
                         : (*object_)[key].dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return fmt::format("'{}'", text);
}

bool CameraSection::is_zero(const std::string& key) const {
  return all_zero((*object_)[key]);
}

double CameraSection::to_number(const json& value, const std::string& key,
                                const std::string& what) const {
  double number = 0.0;
  if (!value.is_string()) fail(key, fmt::format("expected {}, found a list or keys", what));
  const auto text = value.get<std::string>();
  const std::string problem = number_problem(text, number);
  if (!problem.empty()) {
    fail(key, fmt::format("expected {} ({}), found '{}'", what, problem, text));
  }
  return number;
}

void CameraSection::collect(const json& list, const std::string& key, const std::string& what,
                            std::vector<double>& values) const {
  for (const json& item : list) {
    if (item.is_array()) {
      collect(item, key, what, values);
    } else {
      values.push_back(to_number(item, key, what));
    }
  }
}

}  // namespace cairn::host
