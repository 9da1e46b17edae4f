/* What the C interface refuses, and that a refused call changes nothing; maps in the caller's
   buffer; objects. Prints each check that fails; exit status 1 then. */

#include <math.h>
#include <string.h>

#include "cairn/cairn.h"
#include "cairn/port/port.h"

#include "text.h"

static int failures = 0;

static void check(int good, const char* what, int line) {
  if (good) return;
  ++failures;
  cairn_port_write("line ");
  write_decimal((uint64_t)line);
  cairn_port_write(": ");
  cairn_port_write(what);
  cairn_port_write("\n");
}
#define CHECK(condition) check((condition) != 0, #condition, __LINE__)

enum { kWidth = 320, kHeight = 240 };
static cairn_vehicle_memory vehicle_memory;
static cairn_handheld_memory handheld_memory;
static cairn_window_memory window_memory;
static cairn_objects_memory objects_memory;
static uint8_t pixels[kWidth * kHeight];
static uint8_t map[CAIRN_VEHICLE_MAP_BYTES];

static const cairn_camera kCamera = {
    .fx = 250.0F, .fy = 250.0F, .cx = 159.5F, .cy = 119.5F, .width = kWidth, .height = kHeight};
static const cairn_transform kForwards = {0.5F, -0.5F, 0.5F, -0.5F, 0.35F, 0.0F, 1.0F};
static const cairn_image kImage = {pixels, kWidth, kHeight, kWidth};

static cairn_vehicle* make_vehicle(void) {
  cairn_vehicle* vehicle = NULL;
  CHECK(cairn_vehicle_initialise(vehicle_memory.bytes, sizeof vehicle_memory, &kCamera, &kForwards,
                                 NULL, NULL, &vehicle) == CAIRN_OK);
  return vehicle;
}

static cairn_status make(void* memory, size_t bytes, const cairn_camera* camera,
                         const cairn_transform* mounting, const cairn_vehicle_start* start,
                         const cairn_vehicle_parameters* parameters) {
  cairn_vehicle* vehicle = (cairn_vehicle*)1;
  const cairn_status status =
      cairn_vehicle_initialise(memory, bytes, camera, mounting, start, parameters, &vehicle);
  CHECK((status == CAIRN_OK) == (vehicle != NULL));
  return status;
}

static void impossible_starts_are_refused(void) {
  uint8_t* const bytes = vehicle_memory.bytes;
  const size_t size = sizeof vehicle_memory;
  CHECK(make(NULL, size, &kCamera, &kForwards, NULL, NULL) == CAIRN_INVALID_ARGUMENT);
  CHECK(make(bytes, 0, &kCamera, &kForwards, NULL, NULL) == CAIRN_INVALID_ARGUMENT);
  CHECK(make(bytes, size / 2, &kCamera, &kForwards, NULL, NULL) == CAIRN_INVALID_ARGUMENT);
  CHECK(make(bytes + 4, size, &kCamera, &kForwards, NULL, NULL) == CAIRN_INVALID_ARGUMENT);
  CHECK(make(bytes, size, NULL, &kForwards, NULL, NULL) == CAIRN_INVALID_ARGUMENT);
  CHECK(make(bytes, size, &kCamera, NULL, NULL, NULL) == CAIRN_INVALID_ARGUMENT);
  CHECK(cairn_vehicle_initialise(bytes, size, &kCamera, &kForwards, NULL, NULL, NULL) ==
        CAIRN_INVALID_ARGUMENT);

  cairn_camera camera = kCamera;
  camera.fx = 0.0F;
  CHECK(make(bytes, size, &camera, &kForwards, NULL, NULL) == CAIRN_BAD_CONFIG);
  camera = kCamera;
  camera.width = CAIRN_MAX_IMAGE_WIDTH + 1;
  CHECK(make(bytes, size, &camera, &kForwards, NULL, NULL) == CAIRN_BAD_CONFIG);
  camera.width = INT32_MIN;
  CHECK(make(bytes, size, &camera, &kForwards, NULL, NULL) == CAIRN_BAD_CONFIG);
  const cairn_transform no_rotation = {0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 1.0F};
  CHECK(make(bytes, size, &kCamera, &no_rotation, NULL, NULL) == CAIRN_BAD_CONFIG);
  cairn_vehicle_parameters parameters = cairn_vehicle_default_parameters();
  parameters.sigma_px = -1.0F;
  CHECK(make(bytes, size, &kCamera, &kForwards, NULL, &parameters) == CAIRN_BAD_CONFIG);
  cairn_vehicle_start start = {0};
  start.position_variance = -1.0F;
  CHECK(make(bytes, size, &kCamera, &kForwards, &start, NULL) == CAIRN_INVALID_ARGUMENT);
  start.position_variance = 0.0F;
  start.x_m = NAN;
  CHECK(make(bytes, size, &kCamera, &kForwards, &start, NULL) == CAIRN_NON_FINITE_INPUT);
}

static void null_is_refused(void) {
  cairn_vehicle* const v = make_vehicle();
  cairn_odometry sample = {0};
  cairn_report report;
  cairn_health health;
  cairn_vehicle_pose pose;
  size_t count = 0;
  const cairn_status refused = CAIRN_INVALID_ARGUMENT;
  CHECK(cairn_vehicle_reset(NULL, NULL) == refused);
  CHECK(cairn_vehicle_add_odometry(NULL, &sample) == refused);
  CHECK(cairn_vehicle_add_odometry(v, NULL) == refused);
  CHECK(cairn_vehicle_process_frame(NULL, &kImage, 0, &report) == refused);
  CHECK(cairn_vehicle_process_frame(v, NULL, 0, &report) == refused);
  CHECK(cairn_vehicle_set_work_limit(NULL, 1) == refused);
  CHECK(cairn_vehicle_set_ticks(NULL, NULL, NULL) == refused);
  CHECK(cairn_vehicle_get_pose(NULL, &pose) == refused);
  CHECK(cairn_vehicle_get_pose(v, NULL) == refused);
  CHECK(cairn_vehicle_get_landmarks(v, NULL, 1, &count) == refused);
  CHECK(cairn_vehicle_get_landmarks(v, NULL, 0, NULL) == refused);
  CHECK(cairn_vehicle_get_health(NULL, &health) == refused);
  CHECK(cairn_vehicle_get_health(v, NULL) == refused);
  CHECK(cairn_vehicle_save_map(v, NULL, 1, &count) == refused);
  CHECK(cairn_vehicle_save_map(v, map, 1, NULL) == refused);
  CHECK(cairn_vehicle_load_map(v, NULL, 1) == refused);
  CHECK(cairn_vehicle_write_map(v, NULL, NULL) == refused);
  CHECK(cairn_vehicle_read_map(v, NULL, NULL, 1) == refused);
  CHECK(cairn_vehicle_draw(v, NULL, NULL, NULL) == refused);
  CHECK(cairn_vehicle_place_object(NULL, NULL, 0.0F, 0.0F) == refused);
  CHECK(cairn_vehicle_hash(NULL) == 0);
  CHECK(cairn_handheld_process_frame(NULL, &kImage, 0, &report) == refused);
  CHECK(cairn_handheld_get_covariance(NULL, NULL) == refused);
  CHECK(cairn_handheld_place_object(NULL, NULL) == refused);
  CHECK(cairn_handheld_place_object_at(NULL, NULL, 0.0F, 0.0F) == refused);
  CHECK(cairn_handheld_reset(NULL) == refused);
  CHECK(cairn_window_process_frame(NULL, &kImage, 0, &report) == refused);
  CHECK(cairn_window_add_angular_rate(NULL, NULL) == refused);
  CHECK(cairn_window_get_gyro(NULL, NULL) == refused);
  CHECK(cairn_window_set_work_limit(NULL, 1) == refused);
  CHECK(cairn_window_set_ticks(NULL, NULL, NULL) == refused);
  CHECK(cairn_window_get_covariance(NULL, NULL) == refused);
  CHECK(cairn_window_get_landmarks(NULL, NULL, 0, &count) == refused);
  CHECK(cairn_window_get_focal_scale(NULL, NULL, NULL) == refused);
  CHECK(cairn_window_get_health(NULL, &health) == refused);
  CHECK(cairn_window_place_object(NULL, NULL) == refused);
  CHECK(cairn_window_place_object_at(NULL, NULL, 0.0F, 0.0F) == refused);
  CHECK(cairn_window_draw(NULL, NULL, NULL, NULL) == refused);
  CHECK(cairn_window_reset(NULL) == refused);
  CHECK(cairn_window_hash(NULL) == 0);
  CHECK(cairn_objects_place(NULL, &kForwards) == refused);
  CHECK(cairn_objects_count(NULL, NULL) == refused);
  CHECK(cairn_objects_get_place(NULL, 0, NULL) == refused);
  CHECK(!cairn_objects_wants_one(NULL));
}

static void a_refused_input_changes_nothing(void) {
  cairn_vehicle* const v = make_vehicle();
  cairn_report report;
  CHECK(cairn_vehicle_process_frame(v, &kImage, 1000, &report) != CAIRN_INVALID_ARGUMENT);
  CHECK(report.t_us == 1000);
  unsigned char before[sizeof report];
  memcpy(before, &report, sizeof report);
  cairn_image narrow = kImage;
  narrow.width = kWidth - 1;
  CHECK(cairn_vehicle_process_frame(v, &narrow, 2000, &report) == CAIRN_INVALID_ARGUMENT);
  CHECK(cairn_vehicle_process_frame(v, &kImage, 1000, &report) == CAIRN_DUPLICATE);
  CHECK(cairn_vehicle_process_frame(v, &kImage, 1, &report) == CAIRN_TIME_BACKWARDS);
  unsigned char after[sizeof report];
  memcpy(after, &report, sizeof report);
  CHECK(memcmp(before, after, sizeof report) == 0);
  cairn_odometry sample = {2000, CAIRN_TWIST, NAN, 0.0F};
  CHECK(cairn_vehicle_add_odometry(v, &sample) == CAIRN_NON_FINITE_INPUT);
  sample.speed_mps = 0.1F;
  sample.kind = (cairn_odometry_kind)7;
  CHECK(cairn_vehicle_add_odometry(v, &sample) == CAIRN_INVALID_ARGUMENT);
  CHECK(cairn_vehicle_set_work_limit(v, -1) == CAIRN_INVALID_ARGUMENT);
  cairn_health health;
  CHECK(cairn_vehicle_get_health(v, &health) == CAIRN_OK);
  CHECK(health.images_refused == 1 && health.non_finite_inputs == 1 && health.time_errors == 2);
}

static void odometry_moves_the_pose_and_reset_takes_it_back(void) {
  cairn_vehicle* const v = make_vehicle();
  const cairn_odometry still = {0, CAIRN_TWIST, 1.0F, 0.0F};
  const cairn_odometry moved = {500000, CAIRN_TWIST, 1.0F, 0.0F};
  CHECK(cairn_vehicle_add_odometry(v, &still) == CAIRN_OK);
  CHECK(cairn_vehicle_add_odometry(v, &moved) == CAIRN_OK);
  cairn_vehicle_pose pose;
  CHECK(cairn_vehicle_get_pose(v, &pose) == CAIRN_OK);
  CHECK(pose.x_m > 0.4F && pose.x_m < 0.6F && pose.y_m == 0.0F);
  CHECK(pose.covariance[0] > 0.0F && pose.covariance[8] > 0.0F);
  cairn_vehicle_start start = {0};
  start.y_m = 2.0F;
  start.heading_rad = 1.0F;
  CHECK(cairn_vehicle_reset(v, &start) == CAIRN_OK);
  CHECK(cairn_vehicle_get_pose(v, &pose) == CAIRN_OK);
  CHECK(pose.x_m == 0.0F && pose.y_m == 2.0F);
  CHECK(pose.covariance[0] > 0.99e-4F && pose.covariance[0] < 1.01e-4F);  // what calibration leaves
  CHECK(pose.heading_rad > 0.9999F && pose.heading_rad < 1.0001F);
}

static void a_map_needs_its_room_and_its_bytes(void) {
  cairn_vehicle* const v = make_vehicle();
  size_t used = 0;
  CHECK(cairn_vehicle_save_map(v, map, sizeof map, &used) == CAIRN_OK);
  CHECK(used > 0 && used <= sizeof map);
  CHECK(cairn_vehicle_load_map(v, map, used) == CAIRN_OK);
  CHECK(cairn_vehicle_load_map(v, map, used - 1) == CAIRN_CORRUPT);
  CHECK(cairn_vehicle_load_map(v, map, 0) == CAIRN_CORRUPT);
  map[used - 1] ^= 1U;
  CHECK(cairn_vehicle_load_map(v, map, used) == CAIRN_CORRUPT);
  map[used - 1] ^= 1U;
  CHECK(cairn_vehicle_save_map(v, map, used - 1, &used) == CAIRN_BUDGET_EXCEEDED);
}

static void objects_stand_where_they_are_put(void) {
  cairn_vehicle* const v = make_vehicle();
  cairn_objects* objects = NULL;
  uint8_t* const bytes = objects_memory.bytes;
  CHECK(cairn_objects_initialise(bytes, 16, 1.0F, &objects) == CAIRN_INVALID_ARGUMENT);
  CHECK(cairn_objects_initialise(bytes, sizeof objects_memory, 0.0F, &objects) ==
        CAIRN_INVALID_ARGUMENT);
  CHECK(objects == NULL);
  CHECK(cairn_objects_initialise(bytes, sizeof objects_memory, 1.0F, &objects) == CAIRN_OK);
  CHECK(cairn_objects_wants_one(objects));
  const cairn_canvas canvas = {pixels, kWidth, kHeight, kWidth};
  int32_t drawn = -1;
  CHECK(cairn_vehicle_draw(v, objects, &canvas, &drawn) == CAIRN_NOT_INITIALISED);
  (void)cairn_vehicle_process_frame(v, &kImage, 0, NULL);
  CHECK(cairn_vehicle_place_object(v, objects, NAN, 0.0F) == CAIRN_NON_FINITE_INPUT);
  CHECK(cairn_vehicle_place_object(v, objects, 3.5F, 0.0F) == CAIRN_OK);
  CHECK(cairn_vehicle_draw(v, objects, &canvas, &drawn) == CAIRN_OK);
  CHECK(drawn == 1);
  cairn_canvas small = canvas;
  small.height = 10;
  CHECK(cairn_vehicle_draw(v, objects, &small, &drawn) == CAIRN_INVALID_ARGUMENT);
  for (int i = 1; i < 8; ++i) {
    CHECK(cairn_vehicle_place_object(v, objects, 3.5F, (float)i) == CAIRN_OK);
  }
  CHECK(cairn_vehicle_place_object(v, objects, 3.5F, 9.0F) == CAIRN_FULL);
  int32_t count = 0;
  CHECK(cairn_objects_count(objects, &count) == CAIRN_OK && count == 8);
  cairn_transform place;
  CHECK(cairn_objects_get_place(objects, 2, &place) == CAIRN_OK);
  CHECK(fabsf(place.x - 3.5F) < 1e-3F && fabsf(place.y - 2.0F) < 1e-3F);
  CHECK(cairn_objects_get_place(objects, -1, &place) == CAIRN_NOT_FOUND);
  CHECK(cairn_objects_get_place(objects, 8, &place) == CAIRN_NOT_FOUND);
  CHECK(cairn_objects_get_place(objects, 0, NULL) == CAIRN_INVALID_ARGUMENT);
}

static void a_hand_held_camera_starts_and_resets(void) {
  cairn_handheld* h = NULL;
  CHECK(cairn_handheld_initialise(handheld_memory.bytes, 8, &kCamera, NULL, &h) ==
        CAIRN_INVALID_ARGUMENT);
  cairn_handheld_parameters parameters = cairn_handheld_default_parameters();
  parameters.fading_factor = 0.5F;
  CHECK(cairn_handheld_initialise(handheld_memory.bytes, sizeof handheld_memory, &kCamera,
                                  &parameters, &h) == CAIRN_BAD_CONFIG);
  CHECK(h == NULL);
  CHECK(cairn_handheld_initialise(handheld_memory.bytes, sizeof handheld_memory, &kCamera, NULL,
                                  &h) == CAIRN_OK);
  cairn_report report;
  memset(pixels, 90, sizeof pixels);
  (void)cairn_handheld_process_frame(h, &kImage, 0, &report);
  CHECK(report.state == CAIRN_INITIALISING && report.landmarks == 0);
  CHECK(cairn_handheld_process_frame(h, &kImage, 0, &report) == CAIRN_DUPLICATE);
  float covariance[36];
  CHECK(cairn_handheld_get_covariance(h, covariance) == CAIRN_OK);
  cairn_objects* objects = NULL;
  CHECK(cairn_objects_initialise(objects_memory.bytes, sizeof objects_memory, 1.0F, &objects) ==
        CAIRN_OK);
  CHECK(cairn_handheld_place_object(h, objects) == CAIRN_NOT_FOUND);
  CHECK(cairn_handheld_place_object_at(h, objects, 0.0F, kHeight - 1) == CAIRN_NOT_FOUND);
  CHECK(cairn_handheld_place_object_at(h, objects, 0.0F, kHeight) == CAIRN_INVALID_ARGUMENT);
  CHECK(cairn_handheld_place_object_at(h, objects, NAN, 0.0F) == CAIRN_INVALID_ARGUMENT);
  CHECK(cairn_handheld_place_object_at(h, NULL, 0.0F, 0.0F) == CAIRN_INVALID_ARGUMENT);
  size_t used = 0;
  CHECK(cairn_handheld_save_map(h, map, sizeof map, &used) == CAIRN_OK);
  CHECK(cairn_handheld_load_map(h, map, used) == CAIRN_OK);
  CHECK(cairn_handheld_reset(h) == CAIRN_OK);
  CHECK(cairn_handheld_process_frame(h, &kImage, 0, &report) != CAIRN_DUPLICATE);
}

static void the_earliest_time_is_a_time(void) {
  cairn_window* w = NULL;
  CHECK(cairn_window_initialise(window_memory.bytes, sizeof window_memory, &kCamera, NULL, &w) ==
        CAIRN_OK);
  cairn_report report = {0};
  CHECK(cairn_window_process_frame(w, &kImage, INT64_MIN, &report) != CAIRN_INVALID_ARGUMENT);
  CHECK(report.t_us == INT64_MIN);
  CHECK(report.T_map_camera.qw != 0.0F);
}

static void a_window_starts_and_resets(void) {
  cairn_window* w = NULL;
  CHECK(cairn_window_initialise(window_memory.bytes, 8, &kCamera, NULL, &w) ==
        CAIRN_INVALID_ARGUMENT);
  CHECK(cairn_window_initialise(window_memory.bytes, sizeof window_memory, NULL, NULL, &w) ==
        CAIRN_INVALID_ARGUMENT);
  cairn_window_parameters parameters = cairn_window_default_parameters();
  parameters.gyro.qw = 0.5F;
  CHECK(cairn_window_initialise(window_memory.bytes, sizeof window_memory, &kCamera, &parameters,
                                &w) == CAIRN_BAD_CONFIG);
  parameters.gyro.qw = 1.0F;
  parameters.row_time_s = 0.01F;
  CHECK(cairn_window_initialise(window_memory.bytes, sizeof window_memory, &kCamera, &parameters,
                                &w) == CAIRN_BAD_CONFIG);
  parameters.row_time_s = 0.0F;
  parameters.focal_sigma = -0.01F;
  CHECK(cairn_window_initialise(window_memory.bytes, sizeof window_memory, &kCamera, &parameters,
                                &w) == CAIRN_BAD_CONFIG);
  CHECK(w == NULL);
  CHECK(cairn_window_initialise(window_memory.bytes, sizeof window_memory, &kCamera, NULL, &w) ==
        CAIRN_OK);
  cairn_report report;
  memset(pixels, 90, sizeof pixels);
  (void)cairn_window_process_frame(w, &kImage, 0, &report);
  CHECK(report.state == CAIRN_INITIALISING && report.landmarks == 0);
  CHECK(cairn_window_process_frame(w, &kImage, 0, &report) == CAIRN_DUPLICATE);
  cairn_health health;
  CHECK(cairn_window_get_health(w, &health) == CAIRN_OK);
  CHECK(health.time_errors == 1);
  CHECK(cairn_window_set_work_limit(w, -1) == CAIRN_INVALID_ARGUMENT);
  const cairn_angular_rate rate = {1000, 0.1F, 0.2F, 0.3F};
  CHECK(cairn_window_add_angular_rate(w, &rate) == CAIRN_OK);
  CHECK(cairn_window_add_angular_rate(w, &rate) == CAIRN_DUPLICATE);
  cairn_gyro gyro;
  CHECK(cairn_window_get_gyro(w, &gyro) == CAIRN_OK);
  CHECK(gyro.trust == CAIRN_GYRO_UNPROVEN && gyro.samples == 1 && gyro.refused == 1);
  float scale = 0.0F;
  float sigma = 0.0F;
  CHECK(cairn_window_get_focal_scale(w, &scale, &sigma) == CAIRN_OK);
  CHECK(scale == 1.0F && sigma == cairn_window_default_parameters().focal_sigma);
  size_t count = 1;
  CHECK(cairn_window_get_landmarks(w, NULL, 0, &count) == CAIRN_OK);
  CHECK(count == 0);
  cairn_objects* objects = NULL;
  CHECK(cairn_objects_initialise(objects_memory.bytes, sizeof objects_memory, 1.0F, &objects) ==
        CAIRN_OK);
  CHECK(cairn_window_place_object(w, objects) == CAIRN_NOT_FOUND);
  CHECK(cairn_window_place_object_at(w, objects, 0.0F, kHeight) == CAIRN_INVALID_ARGUMENT);
  CHECK(cairn_window_place_object_at(w, objects, 0.0F, kHeight - 1) == CAIRN_NOT_FOUND);
  CHECK(cairn_window_reset(w) == CAIRN_OK);
  CHECK(cairn_window_process_frame(w, &kImage, 0, &report) != CAIRN_DUPLICATE);
}

int main(void) {
  CHECK(strcmp(cairn_status_text(CAIRN_TIME_GAP), "time_gap") == 0);
  CHECK(strcmp(cairn_status_text((cairn_status)99), "unknown") == 0);
  impossible_starts_are_refused();
  null_is_refused();
  a_refused_input_changes_nothing();
  odometry_moves_the_pose_and_reset_takes_it_back();
  a_map_needs_its_room_and_its_bytes();
  objects_stand_where_they_are_put();
  a_hand_held_camera_starts_and_resets();
  the_earliest_time_is_a_time();
  a_window_starts_and_resets();
  cairn_port_write(failures == 0 ? "passed\n" : "FAILED\n");
  return failures == 0 ? 0 : 1;
}
