/* Replays an input log by the C interface and prints the lines of tests/target/replay.cpp: number,
   time, status and hash of every frame, and of the drawn picture.

   usage: c_replay LOG [overlay] */

#include <string.h>

#include "cairn/cairn.h"
#include "cairn/port/files.h"
#include "cairn/port/port.h"

#include "log_file.h"
#include "text.h"

#ifdef CAIRN_PORT_FRAMES_SECTION
__attribute__((section(".frames")))
#endif
static uint8_t pixels[CAIRN_MAX_IMAGE_WIDTH * CAIRN_MAX_IMAGE_HEIGHT];

static cairn_vehicle_memory vehicle_memory;
static cairn_handheld_memory handheld_memory;
static cairn_window_memory window_memory;
static cairn_objects_memory objects_memory;

static cairn_vehicle* vehicle;
static cairn_handheld* handheld;
static cairn_window* window;
static cairn_objects* objects;

static int fail(const char* what, cairn_status status) {
  cairn_port_write(what);
  cairn_port_write(": ");
  cairn_port_write(cairn_status_text(status));
  cairn_port_write("\n");
  return 2;
}

static cairn_status start_vehicle(const struct log_header* header) {
  const float no_wheelbase_m = 1e-6F; /* as cairn::start_replay() */
  cairn_vehicle_parameters parameters = cairn_vehicle_default_parameters();
  parameters.seed = header->seed;
  parameters.sigma_speed_mps = header->speed_sigma_mps;
  parameters.sigma_turn = header->turn_sigma;
  parameters.wheelbase_m = header->wheelbase_m > 0.0F ? header->wheelbase_m : no_wheelbase_m;
  parameters.sample_period_s = header->odometry_period_s;
  return cairn_vehicle_initialise(vehicle_memory.bytes, sizeof vehicle_memory, &header->camera,
                                  &header->T_vehicle_camera, &header->start, &parameters, &vehicle);
}

static cairn_status start_handheld(const struct log_header* header) {
  cairn_handheld_parameters parameters = cairn_handheld_default_parameters();
  parameters.seed = header->seed;
  parameters.adaptive_fading = header->adaptive_fading;
  parameters.fading_factor = header->fading;
  return cairn_handheld_initialise(handheld_memory.bytes, sizeof handheld_memory, &header->camera,
                                   &parameters, &handheld);
}

static cairn_status start_window(const struct log_header* header) {
  cairn_window_parameters parameters = cairn_window_default_parameters();
  parameters.seed = header->seed;
  parameters.focal_sigma = header->focal_sigma;
  return cairn_window_initialise(window_memory.bytes, sizeof window_memory, &header->camera,
                                 &parameters, &window);
}

static cairn_status start(const struct log_header* header) {
  if (header->window) return start_window(header);
  return header->handheld ? start_handheld(header) : start_vehicle(header);
}

static cairn_status process(const struct log_frame* frame, const cairn_image* image,
                            cairn_report* report) {
  const int32_t limit = frame->work_limit;
  if (vehicle != NULL) {
    const cairn_status limited = cairn_vehicle_set_work_limit(
        vehicle, limit < 0 ? cairn_vehicle_default_parameters().work_limit : limit);
    if (limited != CAIRN_OK) return limited;
    return cairn_vehicle_process_frame(vehicle, image, frame->t_us, report);
  }
  if (window != NULL) {
    const cairn_status limited = cairn_window_set_work_limit(
        window, limit < 0 ? cairn_window_default_parameters().work_limit : limit);
    if (limited != CAIRN_OK) return limited;
    return cairn_window_process_frame(window, image, frame->t_us, report);
  }
  const cairn_status limited = cairn_handheld_set_work_limit(
      handheld, limit < 0 ? cairn_handheld_default_parameters().work_limit : limit);
  if (limited != CAIRN_OK) return limited;
  return cairn_handheld_process_frame(handheld, image, frame->t_us, report);
}

static uint64_t hash(void) {
  if (vehicle != NULL) return cairn_vehicle_hash(vehicle);
  return window != NULL ? cairn_window_hash(window) : cairn_handheld_hash(handheld);
}

static void print_frame(const struct log_frame* frame, const cairn_report* report) {
  cairn_port_write("frame ");
  write_decimal(frame->number);
  cairn_port_write(" ");
  write_decimal((uint64_t)frame->t_us);
  cairn_port_write(" ");
  cairn_port_write(cairn_status_text(report->status));
  cairn_port_write(" ");
  write_hex64(hash());
  cairn_port_write("\n");
}

/* FNV-1a, as cairn::Hash64. */
static uint64_t hash_of_pixels(uint32_t count) {
  uint64_t hash = 0xCBF29CE484222325U;
  for (uint32_t i = 0; i < count; ++i) hash = (hash ^ pixels[i]) * 0x100000001B3U;
  return hash;
}

static void place_object(void) {
  if (vehicle != NULL) {
    (void)cairn_vehicle_place_object(vehicle, objects, 3.5F, 0.7F);
  } else if (window != NULL) {
    (void)cairn_window_place_object(window, objects);
  } else {
    (void)cairn_handheld_place_object(handheld, objects);
  }
}

static cairn_status draw_objects(const cairn_canvas* canvas) {
  if (vehicle != NULL) return cairn_vehicle_draw(vehicle, objects, canvas, NULL);
  return window != NULL ? cairn_window_draw(window, objects, canvas, NULL)
                        : cairn_handheld_draw(handheld, objects, canvas, NULL);
}

static cairn_status draw(const struct log_header* header, const struct log_frame* frame,
                         const cairn_report* report) {
  const cairn_canvas canvas = {pixels, header->camera.width, header->camera.height,
                               header->camera.width};
  if (report->state == CAIRN_TRACKING && cairn_objects_wants_one(objects)) place_object();
  const cairn_status status = draw_objects(&canvas);
  cairn_port_write("overlay ");
  write_decimal(frame->number);
  cairn_port_write(" ");
  write_hex64(hash_of_pixels((uint32_t)(canvas.width * canvas.height)));
  cairn_port_write("\n");
  return status;
}

static int replay(int32_t file, const struct log_header* header, int with_overlay) {
  const cairn_image image = {pixels, header->camera.width, header->camera.height,
                             header->camera.width};
  for (;;) {
    cairn_odometry sample;
    struct log_frame frame;
    switch (log_next(file, &sample, &frame, pixels, sizeof pixels)) {
      case LOG_ODOMETRY:
        /* A sample that is refused is in the counters, and so in the hash. */
        if (vehicle != NULL) (void)cairn_vehicle_add_odometry(vehicle, &sample);
        break;
      case LOG_FRAME: {
        cairn_report report;
        memset(&report, 0, sizeof report);
        report.status = process(&frame, &image, &report);
        print_frame(&frame, &report);
        const cairn_status drawn = with_overlay ? draw(header, &frame, &report) : CAIRN_OK;
        if (drawn != CAIRN_OK) return fail("drawing", drawn);
        break;
      }
      case LOG_END:
        return 0;
      default:
        return fail("log", CAIRN_CORRUPT);
    }
  }
}

int main(int argc, char** argv) {
  if (argc < 2) {
    cairn_port_write("usage: c_replay LOG [overlay]\n");
    return 2;
  }
  int32_t file = -1;
  struct log_header header;
  if (!log_open(argv[1], &file, &header)) return fail(argv[1], CAIRN_CORRUPT);
  cairn_status status = start(&header);
  if (status == CAIRN_OK) {
    status = cairn_objects_initialise(objects_memory.bytes, sizeof objects_memory, 1.0F, &objects);
  }
  if (status != CAIRN_OK) return fail("start", status);
  const int result = replay(file, &header, argc > 2 && strcmp(argv[2], "overlay") == 0);
  cairn_file_close(file);
  return result;
}
