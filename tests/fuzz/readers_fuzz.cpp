// Files of the host: each ends in a result or in an InputError that names the file.
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <unistd.h>
#include <vector>

#include "fuzz_input.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/picture_header.hpp"
#include "host_sim/io/picture_name.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/recorded/number_table.hpp"
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

void read_table(const fs::path& path, bool commas) {
  TableFormat format;
  format.header = commas ? "t_s,x,y" : "";
  format.commas = commas;
  format.columns = 3;
  format.increasing = true;
  const NumberTable table = read_number_table(path, format);
  PROMISE(10, table.rows.size() == table.lines.size());
  for (const std::vector<double>& row : table.rows) PROMISE(10, row.size() == 3);
}

/// A picture by its first bytes, as the whole file and cut, and the name of one.
void read_picture(const std::uint8_t* bytes, std::size_t size) {
  const std::string file(reinterpret_cast<const char*>(bytes), size);
  const std::optional<PictureHeader> header = read_picture_header(file);
  PROMISE(10, !header || (header->width >= 0 && header->height >= 0 && header->brightest > 0));
  if (file.find('\0') != std::string::npos || file.find('/') != std::string::npos) return;
  const PictureName name(fs::path(file + ".png"));
  PROMISE(10, name.texts.size() == name.numbers.size() + 1);
  static_cast<void>(ends_in_date_time(name));
  try {
    for (const std::string& number : name.numbers) {
      PROMISE(10, to_number(name.path, number) >= 0);
    }
    const std::optional<std::size_t> seconds = name.decimal_seconds();
    if (seconds) static_cast<void>(decimal_time_us(name, *seconds));
  } catch (const InputError&) {
    return;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size < 1 || size > 65536) return 0;
  static const char* const names[] = {"camera.yaml",  "camera.json", "camera.xml",  "cameras.txt",
                                      "odometry.csv", "truth.tum",   "times.csv",   "gyro.csv",
                                      "sensor.yaml",  "numbers.csv", "numbers.dat", "picture"};
  constexpr std::size_t kKinds = sizeof names / sizeof names[0];
  const std::size_t kind = bytes[0] % kKinds;
  if (kind == kKinds - 1) {
    read_picture(bytes + 1, size - 1);
    return 0;
  }
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
    } else if (kind == 8) {
      const ImuFile imu = read_imu_file(path);
      PROMISE(10, imu.noise_density || imu.T_body_imu);
    } else {
      read_table(path, kind == 9);
    }
  } catch (const InputError& error) {
    PROMISE(10, std::string(error.what()).find(names[kind]) != std::string::npos);
  }
  return 0;
}
