// COLMAP's cameras.txt: CAMERA_ID MODEL WIDTH HEIGHT PARAMETERS, one camera a line.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "host_sim/io/camera_formats/camera_formats.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/text_file.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

using Members = std::vector<double PinholeCamera<double>::*>;
using Camera = PinholeCamera<double>;

/// Parameters of a model in order.
struct Model {
  std::string_view name;
  bool one_focal_length;
  Members parameters;
  Lens lens = Lens::kRadialTangential;
};

const std::vector<Model>& models() {
  static const std::vector<Model> known = {
      {"SIMPLE_PINHOLE", true, {&Camera::fx, &Camera::cx, &Camera::cy}},
      {"PINHOLE", false, {&Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy}},
      {"SIMPLE_RADIAL", true, {&Camera::fx, &Camera::cx, &Camera::cy, &Camera::k1}},
      {"RADIAL", true, {&Camera::fx, &Camera::cx, &Camera::cy, &Camera::k1, &Camera::k2}},
      {"OPENCV",
       false,
       {&Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy, &Camera::k1, &Camera::k2, &Camera::p1,
        &Camera::p2}},
      {"FULL_OPENCV",
       false,
       {&Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy, &Camera::k1, &Camera::k2, &Camera::p1,
        &Camera::p2, &Camera::k3, &Camera::k4, &Camera::k5, &Camera::k6}},
      {"OPENCV_FISHEYE",
       false,
       {&Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy, &Camera::k1, &Camera::k2, &Camera::k3,
        &Camera::k4},
       Lens::kFisheye}};
  return known;
}

bool is_upper_word(std::string_view word) {
  return !word.empty() && std::all_of(word.begin(), word.end(), [](char c) {
    return c == '_' || std::isupper(static_cast<unsigned char>(c)) != 0 ||
           std::isdigit(static_cast<unsigned char>(c)) != 0;
  });
}

int side(std::string_view field, const fs::path& path, int line) {
  const double value = parse_number(field, path, line, "an image side");
  if (!(value >= kLeastImageSide && value <= kLargestImageSide) || value != std::floor(value)) {
    throw InputError(path, line,
                     fmt::format("expected an image side of {} to {} pixels, found {}",
                                 kLeastImageSide, kLargestImageSide, value));
  }
  return static_cast<int>(value);
}

}  // namespace

bool is_colmap_text(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line)) {
    const std::vector<std::string_view> fields = split_blanks(line);
    if (fields.empty() || fields[0].front() == '#') continue;
    const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
    return fields.size() >= 2 && std::all_of(fields[0].begin(), fields[0].end(), is_digit) &&
           is_upper_word(fields[1]);
  }
  return false;
}

PinholeCamera<double> read_colmap(const fs::path& path) {
  LineReader lines(path);
  TextLine line;
  lines.next(line);
  const std::vector<std::string_view> fields = split_blanks(line.text);
  if (fields.size() < 4) {
    throw InputError(path, line.number, "expected CAMERA_ID MODEL WIDTH HEIGHT PARAMETERS");
  }
  const auto model = std::find_if(models().begin(), models().end(),
                                  [&](const Model& m) { return m.name == fields[1]; });
  if (model == models().end()) {
    std::string known;
    for (const Model& m : models()) known += fmt::format("{}{}", known.empty() ? "" : ", ", m.name);
    throw InputError(path, line.number,
                     fmt::format("expected one of the models {}, found '{}'", known, fields[1]));
  }
  Camera camera;
  camera.width = side(fields[2], path, line.number);
  camera.height = side(fields[3], path, line.number);
  if (fields.size() != 4 + model->parameters.size()) {
    throw InputError(path, line.number,
                     fmt::format("expected {} parameters of {}, found {}", model->parameters.size(),
                                 model->name, fields.size() - 4));
  }
  for (std::size_t i = 0; i < model->parameters.size(); ++i) {
    camera.*(model->parameters[i]) = parse_number(fields[4 + i], path, line.number, "a parameter");
  }
  camera.lens = model->lens;
  if (model->one_focal_length) camera.fy = camera.fx;
  camera.cx -= 0.5;
  camera.cy -= 0.5;
  if (lines.next(line)) {
    throw InputError(path, line.number, "expected one camera, found a second one: leave one line");
  }
  return camera;
}

}  // namespace cairn::host
