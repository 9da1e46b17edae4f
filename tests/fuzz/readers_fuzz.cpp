// Files of the host: each ends in a result or in an InputError that names the file.
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

#include "fuzz_input.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/sources/frame_times.hpp"
#include "host_sim/sources/gyro_file.hpp"
#include "host_sim/sources/odometry_file.hpp"

namespace {

namespace fs = std::filesystem;
using namespace cairn::host;

/// In memory where the system has such a place: a file for each execution.
class Folder {
 public:
  Folder() {
    const fs::path base = fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
    path_ = base / ("cairn-fuzz-" + std::to_string(getpid()));
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size < 1 || size > 65536) return 0;
  static const char* const names[] = {"camera.yaml", "camera.json",  "camera.xml",
                                      "cameras.txt", "odometry.csv", "truth.tum",
                                      "times.csv",   "gyro.csv",     "sensor.yaml"};
  const std::size_t kind = bytes[0] % 9U;
  static const Folder folder;
  const fs::path path = folder.path() / names[kind];
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes + 1), static_cast<std::streamsize>(size - 1));
  try {
    if (kind < 4) {
      const CameraFile camera = read_camera_file(path);
      PROMISE(10, ok(camera.camera.validate()));
    } else if (kind == 4) {
      PROMISE(10, read_odometry(path).samples.size() >= 2);
    } else if (kind == 5) {
      static_cast<void>(read_tum(path));
    } else if (kind == 6) {
      static_cast<void>(FrameTimes(path));
    } else if (kind == 7) {
      PROMISE(10, read_gyro(path).size() >= 2);
    } else {
      const ImuFile imu = read_imu_file(path);
      PROMISE(10, imu.noise_density || imu.T_body_imu);
    }
  } catch (const InputError& error) {
    PROMISE(10, std::string(error.what()).find(names[kind]) != std::string::npos);
  }
  return 0;
}
