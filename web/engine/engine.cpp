#include "engine.h"

#include <cstdlib>
#include <cstring>

#include "cairn/ar/virtual_object.hpp"
#include "cairn/base/hash.hpp"
#include "cairn/cairn.h"
#include "cairn/numeric/math.hpp"
#include "cairn/runtime/input_log.hpp"

#include "clip_reader.hpp"
#include "shading.hpp"

extern "C" __attribute__((import_module("env"), import_name("web_ticks"))) std::uint32_t
web_ticks();  ///< microseconds, from the page

namespace {

constexpr int kMaxPixels = CAIRN_MAX_IMAGE_WIDTH * CAIRN_MAX_IMAGE_HEIGHT;
constexpr float kDriveForward_m = 3.5F;
constexpr float kDriveLeft_m = 0.7F;
constexpr float kDriveHeight_m = 1.0F;
constexpr float kGuessedFocalSigma = 0.2F;  // of a webcam
constexpr float kHeightPerDepth = 0.2F;     // of an object in front of a hand-held camera
constexpr std::uint8_t kNoLine = 128;       // grey of an empty mask; lines are 255, halos 0
constexpr std::uint8_t kOutline[3] = {60, 38, 20};

struct Engine {
  cairn_vehicle_memory vehicle_memory;
  cairn_window_memory window_memory;
  cairn_objects_memory drawn_memory;  // drawn into the drive's frame, as boards do
  cairn_objects_memory shown_memory;  // drawn into the mask: outlines of the shaded ones
  cairn_vehicle* vehicle;
  cairn_window* window;
  cairn_objects* drawn;
  cairn_objects* shown;
  cairn_camera camera;
  cairn_transform T_map_camera;
  cairn_web::ClipReader reader;
  cairn_landmark landmarks[CAIRN_VEHICLE_MAX_LANDMARKS];
  cairn::VirtualObject shape;
  web_result result;
  std::uint8_t* clip;
  std::uint32_t clip_bytes;
  std::uint8_t grey[kMaxPixels];
  std::uint8_t frame[kMaxPixels];  // grey, with the objects drawn into it
  std::uint8_t mask[kMaxPixels];
  std::uint8_t colour[4 * kMaxPixels];
  std::uint8_t shown_picture[4 * kMaxPixels];
  float depths[kMaxPixels];
};

Engine engine;

std::uint32_t read_ticks(void*) {
  return web_ticks();
}

int pixel_count() {
  return engine.camera.width * engine.camera.height;
}

cairn_image image_of(const std::uint8_t* pixels) {
  return {pixels, engine.camera.width, engine.camera.height, engine.camera.width};
}

cairn_canvas canvas_of(std::uint8_t* pixels) {
  return {pixels, engine.camera.width, engine.camera.height, engine.camera.width};
}

void stop() {
  engine.vehicle = nullptr;
  engine.window = nullptr;
  engine.reader = cairn_web::ClipReader();
  engine.result = web_result{};
}

cairn_status make_objects(float height_m) {
  const cairn::Status made = cairn::make_cairn(height_m, engine.shape);
  if (!ok(made)) return static_cast<cairn_status>(made);
  const cairn_status status = cairn_objects_initialise(
      engine.drawn_memory.bytes, sizeof engine.drawn_memory, height_m, &engine.drawn);
  if (status != CAIRN_OK) return status;
  return cairn_objects_initialise(engine.shown_memory.bytes, sizeof engine.shown_memory, height_m,
                                  &engine.shown);
}

cairn_camera camera_of(const cairn::PinholeCamera<float>& c) {
  return {c.fx,     c.fy, c.cx, c.cy, c.k1,
          c.k2,     c.p1, c.p2, c.k3, c.width,
          c.height, c.k4, c.k5, c.k6, static_cast<cairn_lens>(c.lens)};
}

cairn_transform transform_of(const cairn::Rigid<float>& T) {
  return {T.rotation.w(),    T.rotation.x(),    T.rotation.y(),   T.rotation.z(),
          T.translation.x(), T.translation.y(), T.translation.z()};
}

cairn::Rigid<float> rigid_of(const cairn_transform& T) {
  return {{T.qw, T.qx, T.qy, T.qz}, {T.x, T.y, T.z}};
}

cairn::PinholeCamera<float> pinhole() {
  const cairn_camera& c = engine.camera;
  return {c.fx,     c.fy, c.cx, c.cy, c.k1,
          c.k2,     c.p1, c.p2, c.k3, c.width,
          c.height, c.k4, c.k5, c.k6, static_cast<cairn::Lens>(c.lens)};
}

/// As cairn::start_replay().
cairn_status start_vehicle(const cairn::InputLogHeader& header) {
  constexpr float kNoWheelbase_m = 1e-6F;
  cairn_vehicle_parameters parameters = cairn_vehicle_default_parameters();
  parameters.seed = header.seed;
  parameters.sigma_speed_mps = header.speed_sigma_mps;
  parameters.sigma_turn = header.turn_sigma;
  parameters.wheelbase_m = header.wheelbase_m > 0.0F ? header.wheelbase_m : kNoWheelbase_m;
  parameters.sample_period_s = header.odometry_period_s;
  parameters.sigma_pitch_rad = header.tilt.sigma_pitch_rad;
  parameters.sigma_roll_rad = header.tilt.sigma_roll_rad;
  parameters.tilt_time_constant_s = header.tilt.time_constant_s;
  const cairn_vehicle_start start = {header.start_t_us,
                                     header.start_x_m,
                                     header.start_y_m,
                                     header.start_theta_rad,
                                     header.start_position_variance,
                                     header.start_heading_variance};
  const cairn_transform mounting = transform_of(header.T_vehicle_camera);
  const cairn_status status =
      cairn_vehicle_initialise(engine.vehicle_memory.bytes, sizeof engine.vehicle_memory,
                               &engine.camera, &mounting, &start, &parameters, &engine.vehicle);
  if (status != CAIRN_OK) return status;
  return cairn_vehicle_set_ticks(engine.vehicle, &read_ticks, nullptr);
}

void add_odometry(const cairn::OdometrySample& sample) {
  const bool ackermann = sample.kind == cairn::OdometrySample::Kind::kAckermann;
  const cairn_odometry own = {sample.t_us, ackermann ? CAIRN_ACKERMANN : CAIRN_TWIST,
                              sample.speed_mps, sample.turn};
  // A sample that is refused is in the counters, and so in the hash.
  static_cast<void>(cairn_vehicle_add_odometry(engine.vehicle, &own));
}

std::uint64_t hash_of(const std::uint8_t* pixels, int count) {
  cairn::Hash64 hash;
  hash.add_bytes(pixels, count);
  return hash.value();
}

void split(std::uint64_t hash, std::uint32_t (&words)[2]) {
  words[0] = static_cast<std::uint32_t>(hash & 0xFFFFFFFFU);
  words[1] = static_cast<std::uint32_t>(hash >> 32U);
}

/// Landmarks of the map, as pixels of the last frame.
void project_landmarks(std::size_t count) {
  float scale = 1.0F;
  float sigma = 0.0F;
  static_cast<void>(cairn_window_get_focal_scale(engine.window, &scale, &sigma));
  const cairn::PinholeCamera<float> camera = pinhole().with_focal_scale(scale);
  const cairn::Rigid<float> T_camera_map = rigid_of(engine.T_map_camera).inverse();
  web_result& result = engine.result;
  result.points = 0;
  for (std::size_t i = 0; i < count && result.points < WEB_MOST_POINTS; ++i) {
    const float* const p = engine.landmarks[i].position;
    cairn::Vector2<float> pixel;
    if (!ok(camera.project(T_camera_map * cairn::Vector3<float>(p[0], p[1], p[2]), pixel)) ||
        !camera.contains(pixel)) {
      continue;
    }
    result.point_px[2 * result.points] = pixel.x();
    result.point_px[2 * result.points + 1] = pixel.y();
    ++result.points;
  }
}

void report_frame(const cairn_report& report, std::uint64_t frame_hash) {
  web_result& result = engine.result;
  split(frame_hash, result.frame_hash);
  result.status = report.status;
  result.state = report.state;
  result.width = engine.camera.width;
  result.height = engine.camera.height;
  for (int i = 0; i < WEB_STAGES; ++i) {
    result.stage_us[i] = static_cast<std::int32_t>(report.stage_ticks[i]);
  }
  result.searched = report.searched;
  result.matches = report.matches;
  result.inliers = report.inliers;
  result.landmarks = report.landmarks;
  result.work = report.work;
  engine.T_map_camera = report.T_map_camera;
}

/// A pixel's colour with a line of the mask over it: 1 to 127, of which 127 is all.
void add_line(int line, std::uint8_t* out) {
  for (int k = 0; k < 3; ++k) {
    const int below = out[3] > 0 ? out[k] : kOutline[k];
    out[k] = static_cast<std::uint8_t>((below * (127 - line) + kOutline[k] * line) / 127);
  }
  if (out[3] < 2 * line) out[3] = static_cast<std::uint8_t>(2 * line);
}

void put_below(std::uint8_t grey, std::uint8_t* out) {
  for (int k = 0; k < 3; ++k) {
    out[k] = static_cast<std::uint8_t>((out[k] * out[3] + grey * (255 - out[3])) / 255);
  }
  out[3] = 255;
}

/// What is shown: the frame, where it is wanted, under the shaded objects and their outlines.
void blend(bool with_frame) {
  for (int i = 0; i < pixel_count(); ++i) {
    std::uint8_t* const out = engine.shown_picture + 4 * i;
    const std::uint8_t grey = engine.grey[i];
    const int line = engine.mask[i] - kNoLine;
    if (line > 0) add_line(line, out);
    if (!with_frame) continue;
    if (out[3] != 0) {
      put_below(grey, out);
    } else {
      out[0] = out[1] = out[2] = grey;
      out[3] = 255;
    }
  }
}

void shade() {
  const cairn_web::ShadedPicture picture{engine.shown_picture, engine.depths};
  cairn_web::clear(picture, pixel_count());
  if (engine.result.drawn == 0) return;
  const cairn::Rigid<float> T_camera_map = rigid_of(engine.T_map_camera).inverse();
  cairn_transform place;
  for (std::int32_t i = 0; cairn_objects_get_place(engine.shown, i, &place) == CAIRN_OK; ++i) {
    cairn_web::fill_shadow(engine.shape, T_camera_map * rigid_of(place), pinhole(), picture);
  }
  for (std::int32_t i = 0; cairn_objects_get_place(engine.shown, i, &place) == CAIRN_OK; ++i) {
    cairn_web::fill_object(engine.shape, T_camera_map * rigid_of(place), pinhole(), picture);
  }
}

cairn_status draw(cairn_objects* objects, std::uint8_t* pixels) {
  const cairn_canvas canvas = canvas_of(pixels);
  std::int32_t* const count = &engine.result.drawn;
  return engine.vehicle != nullptr ? cairn_vehicle_draw(engine.vehicle, objects, &canvas, count)
                                   : cairn_window_draw(engine.window, objects, &canvas, count);
}

void show(bool with_frame) {
  std::memset(engine.mask, kNoLine, static_cast<std::size_t>(pixel_count()));
  static_cast<void>(draw(engine.shown, engine.mask));
  shade();
  blend(with_frame);
  static_cast<void>(cairn_objects_count(engine.shown, &engine.result.placed));
}

/// The drive's objects, as cairn::augment() places and draws them.
void augment_drive(const cairn_report& report) {
  const std::uint32_t start = web_ticks();
  if (report.state == CAIRN_TRACKING && cairn_objects_wants_one(engine.drawn)) {
    static_cast<void>(
        cairn_vehicle_place_object(engine.vehicle, engine.drawn, kDriveForward_m, kDriveLeft_m));
    static_cast<void>(
        cairn_vehicle_place_object(engine.vehicle, engine.shown, kDriveForward_m, kDriveLeft_m));
  }
  static_cast<void>(draw(engine.drawn, engine.frame));
  engine.result.stage_us[WEB_STAGES - 1] = static_cast<std::int32_t>(web_ticks() - start);
}

void track_drive(const cairn::LogFrame& frame) {
  const std::int32_t own_limit = cairn_vehicle_default_parameters().work_limit;
  static_cast<void>(cairn_vehicle_set_work_limit(
      engine.vehicle, frame.work_limit < 0 ? own_limit : frame.work_limit));
  std::memcpy(engine.frame, engine.grey, static_cast<std::size_t>(pixel_count()));
  const cairn_image image = image_of(engine.grey);
  cairn_report report = {};
  report.status = cairn_vehicle_process_frame(engine.vehicle, &image, frame.t_us, &report);
  engine.result.number = frame.number;
  engine.result.t_us = static_cast<double>(frame.t_us);
  report_frame(report, cairn_vehicle_hash(engine.vehicle));
  augment_drive(report);
  split(hash_of(engine.frame, pixel_count()), engine.result.picture_hash);
  std::size_t count = 0;
  static_cast<void>(cairn_vehicle_get_landmarks(engine.vehicle, engine.landmarks,
                                                CAIRN_VEHICLE_MAX_LANDMARKS, &count));
  project_landmarks(count);
  show(true);
}

/// Median depth of the landmarks in front of the camera, 0 where there are none.
float median_depth() {
  std::size_t count = 0;
  static_cast<void>(cairn_window_get_landmarks(engine.window, engine.landmarks,
                                               CAIRN_WINDOW_MAX_LANDMARKS, &count));
  const cairn::Rigid<float> T_camera_map = rigid_of(engine.T_map_camera).inverse();
  float depths[CAIRN_VEHICLE_MAX_LANDMARKS];
  int found = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float* const p = engine.landmarks[i].position;
    const float depth = (T_camera_map * cairn::Vector3<float>(p[0], p[1], p[2])).z();
    if (!(depth > 0.0F)) continue;
    int k = found++;
    for (; k > 0 && depths[k - 1] > depth; --k) depths[k] = depths[k - 1];
    depths[k] = depth;
  }
  return found > 0 ? depths[found / 2] : 0.0F;
}

}  // namespace

std::uint8_t* web_reserve_clip(std::uint32_t bytes) {
  stop();
  std::free(engine.clip);
  engine.clip = static_cast<std::uint8_t*>(std::malloc(bytes));
  engine.clip_bytes = engine.clip != nullptr ? bytes : 0;
  return engine.clip;
}

std::int32_t web_start_drive() {
  stop();
  cairn::InputLogHeader header;
  const cairn::Status opened = engine.reader.open(engine.clip, engine.clip_bytes, header);
  if (!ok(opened)) return static_cast<cairn_status>(opened);
  if (header.mode != cairn::LogMode::kVehicle) return CAIRN_BAD_CONFIG;
  engine.camera = camera_of(header.camera);
  cairn_status status = start_vehicle(header);
  return status == CAIRN_OK ? make_objects(kDriveHeight_m) : status;
}

std::int32_t web_next_frame() {
  if (engine.vehicle == nullptr) return WEB_DAMAGED;
  for (;;) {
    cairn::LogEvent event = cairn::LogEvent::kEnd;
    cairn::OdometrySample sample;
    cairn::LogFrame frame;
    if (!ok(engine.reader.next(event, sample, frame, engine.grey))) return WEB_DAMAGED;
    if (event == cairn::LogEvent::kEnd) return WEB_END;
    if (event == cairn::LogEvent::kOdometry) {
      add_odometry(sample);
      continue;
    }
    track_drive(frame);
    return WEB_FRAME;
  }
}

std::int32_t web_start_camera(std::int32_t width, std::int32_t height, float fov_rad) {
  stop();
  if (!(fov_rad > 0.1F && fov_rad < 3.0F)) return CAIRN_BAD_CONFIG;
  float sine = 0.0F;
  float cosine = 0.0F;
  cairn::sin_cos(0.5F * fov_rad, sine, cosine);
  const float longer = static_cast<float>(width > height ? width : height);
  const float focal = 0.5F * longer * cosine / sine;
  engine.camera = cairn_camera{};
  engine.camera.fx = engine.camera.fy = focal;
  engine.camera.cx = 0.5F * static_cast<float>(width - 1);
  engine.camera.cy = 0.5F * static_cast<float>(height - 1);
  engine.camera.width = width;
  engine.camera.height = height;
  cairn_window_parameters parameters = cairn_window_default_parameters();
  parameters.focal_sigma = kGuessedFocalSigma;
  cairn_status status =
      cairn_window_initialise(engine.window_memory.bytes, sizeof engine.window_memory,
                              &engine.camera, &parameters, &engine.window);
  if (status == CAIRN_OK) status = cairn_window_set_ticks(engine.window, &read_ticks, nullptr);
  if (status == CAIRN_OK) status = make_objects(1.0F);
  return status;
}

std::uint8_t* web_camera_picture() {
  return engine.colour;
}

std::int32_t web_track_camera(double t_us) {
  if (engine.window == nullptr) return CAIRN_NOT_INITIALISED;
  for (int i = 0; i < pixel_count(); ++i) {
    const std::uint8_t* const c = engine.colour + 4 * i;
    engine.grey[i] = static_cast<std::uint8_t>((77 * c[0] + 150 * c[1] + 29 * c[2] + 128) / 256);
  }
  const cairn_image image = image_of(engine.grey);
  cairn_report report = {};
  constexpr std::int64_t kUntouched = -1;
  report.t_us = kUntouched;
  const cairn_status status =
      cairn_window_process_frame(engine.window, &image, static_cast<std::int64_t>(t_us), &report);
  if (report.t_us == kUntouched) return status;
  ++engine.result.number;
  engine.result.t_us = t_us;
  report_frame(report, cairn_window_hash(engine.window));
  const std::uint32_t start = web_ticks();
  show(false);
  engine.result.stage_us[WEB_STAGES - 1] = static_cast<std::int32_t>(web_ticks() - start);
  std::size_t count = 0;
  static_cast<void>(cairn_window_get_landmarks(engine.window, engine.landmarks,
                                               CAIRN_WINDOW_MAX_LANDMARKS, &count));
  project_landmarks(count);
  return CAIRN_OK;
}

std::int32_t web_place(float x_px, float y_px) {
  if (engine.window == nullptr) return CAIRN_NOT_INITIALISED;
  std::int32_t count = 0;
  static_cast<void>(cairn_objects_count(engine.shown, &count));
  if (count == 0) {
    // The map's unit is its own: the first place says how large an object looks well.
    const float height = kHeightPerDepth * median_depth();
    if (!(height > 0.0F)) return CAIRN_NOT_FOUND;
    const cairn_status made = make_objects(height);
    if (made != CAIRN_OK) return made;
  }
  return cairn_window_place_object_at(engine.window, engine.shown, x_px, y_px);
}

const web_result* web_last_result() {
  return &engine.result;
}

const std::uint8_t* web_shown_picture() {
  return engine.shown_picture;
}

const char* web_status_text(std::int32_t status) {
  return cairn_status_text(static_cast<cairn_status>(status));
}
