// Folders of recorded data sets, one file of which is the fuzzer's: each reader ends in a source or
// in an InputError.
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <unistd.h>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "fuzz_input.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/recorded/recording.hpp"
#include "host_sim/sources/data_sets.hpp"

namespace {

namespace fs = std::filesystem;
using namespace cairn::host;

constexpr const char* kSensor =
    "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n"
    "  data: [0, -1, 0, 0.1, 1, 0, 0, 0.2, 0, 0, 1, 0.3, 0, 0, 0, 1]\n"
    "rate_hz: 20\nresolution: [64, 48]\ncamera_model: pinhole\nintrinsics: [60, 60, 32, 24]\n"
    "distortion_model: radial-tangential\ndistortion_coefficients: [-0.1, 0.01, 0, 0]\n";
constexpr const char* kKittiCalibration =
    "P0: 60 0 32 0 0 60 24 0 0 0 1 0\nP1: 60 0 32 -32 0 60 24 0 0 0 1 0\n"
    "P2: 70 0 30 7 0 70 22 0 0 0 1 0\nP3: 60 0 32 0 0 60 24 0 0 0 1 0\n";
constexpr const char* kOxts =
    "49.0 8.4 110.0 0 0 1.57 10 0 10 0 0 0 0 9.8 0 0 9.8 0 0 0.02 0 0 0.02 0.1 0.1 4 10 4 4 0\n";

/// A sound folder of each data set, in memory where the system has such a place.
class Folders {
 public:
  Folders() {
    const fs::path base = fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
    root_ = base / ("cairn-fuzz-sets-" + std::to_string(getpid()));
    write_euroc();
    write_tum();
    write_kitti();
    write_kitti_raw();
    write_landmarks();
  }
  ~Folders() {
    std::error_code ignored;
    fs::remove_all(root_, ignored);
  }
  Folders(const Folders&) = delete;
  Folders& operator=(const Folders&) = delete;

  fs::path operator/(const char* name) const { return root_ / name; }
  void write(const fs::path& name, const std::string& text) const {
    fs::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name, std::ios::binary) << text;
  }
  std::string read(const fs::path& name) const {
    std::ifstream file(root_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  void picture(const fs::path& name) const {
    fs::create_directories((root_ / name).parent_path());
    cv::imwrite((root_ / name).string(), cv::Mat(48, 64, CV_8UC1, cv::Scalar(90)));
  }
  void write_euroc() const {
    write("euroc/mav0/cam0/sensor.yaml", kSensor);
    write("euroc/mav0/cam0/data.csv",
          "#timestamp [ns],filename\n1403636579763555584,a.png\n1403636579813555456,b.png\n");
    write("euroc/mav0/state_groundtruth_estimate0/data.csv",
          "#timestamp, p_RS_R_x [m]\n1403636579763555584,1,2,3,1,0,0,0\n"
          "1403636579813555456,1,2,3,1,0,0,0\n");
    picture("euroc/mav0/cam0/data/a.png");
    picture("euroc/mav0/cam0/data/b.png");
  }
  void write_tum() const {
    write("tum/camera.yaml", "fx: 60\nfy: 60\ncx: 32\ncy: 24\nwidth: 64\nheight: 48\n");
    write("tum/rgb.txt", "# timestamp filename\n1.0 rgb/a.png\n1.033333 rgb/b.png\n");
    write("tum/groundtruth.txt", "# tx ty tz\n1.0 1 2 3 0 0 0 1\n1.03 1 2 3 0 0 0 1\n");
    picture("tum/rgb/a.png");
    picture("tum/rgb/b.png");
  }
  void write_kitti() const {
    write("kitti/calib.txt", kKittiCalibration);
    write("kitti/times.txt", "0.0\n0.103736\n");
    write("kitti/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n");
    picture("kitti/image_0/000000.png");
    picture("kitti/image_0/000001.png");
  }
  void write_kitti_raw() const {
    const fs::path drive = "raw/d/d_drive_0001_sync";
    for (const char* name : {"0000000000", "0000000001"}) {
      picture(drive / "image_00/data" / (std::string(name) + ".png"));
      write(drive / "oxts/data" / (std::string(name) + ".txt"), kOxts);
    }
    for (const char* part : {"image_00", "oxts"}) {
      write(drive / part / "timestamps.txt",
            "2011-09-26 13:02:25.150000000\n2011-09-26 13:02:25.250000000\n");
    }
    write("raw/d/calib_cam_to_cam.txt",
          "calib_time: 09-Jan-2012\nS_rect_00: 64 48\nR_rect_00: 1 0 0 0 1 0 0 0 1\n"
          "P_rect_00: 60 0 32 0 0 60 24 0 0 0 1 0\n");
    write("raw/d/calib_velo_to_cam.txt", "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 -0.08 -0.27\n");
    write("raw/d/calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: -0.81 0.32 -0.8\n");
  }
  void write_landmarks() const {
    write("woods/odom_gt.csv",
          "t_s,v_mps,om_radps,x_true_m,y_true_m,th_true_rad,true_valid\n"
          "0,0,0,3,0,-2.9,1\n0.1,0,0,3,0,-2.9,1\n");
    write("woods/obs.csv", "t_s,landmark_id(1..17),range_m,bearing_rad\n0,10,1.3,1.9\n");
    write("woods/landmarks.csv", "landmark_id,x_m,y_m\n10,1,2\n");
    write("mrclam/Robot1_Odometry.dat", "1.0 0.1 0\n1.1 0.1 0\n");
    write("mrclam/Robot1_Measurement.dat", "1.05 63 2.0 0.1\n");
    write("mrclam/Robot1_Groundtruth.dat", "1.0 1 2 0\n1.2 1 2 0\n");
    write("mrclam/Landmark_Groundtruth.dat", "6 1.9 -5.5 0.0001 0.0001\n");
    write("mrclam/Barcodes.dat", "1 5\n6 63\n");
    write("park/odom.csv", "t,speed_mps,steering_rad\n0,1,0\n0.1,1,0\n");
    write("park/trees.csv", "t,z0,z1,z2\n0.05,10,0.1,0.3\n");
    write("park/gps.csv", "t_s,east_m,north_m\n0,1,2\n");
  }

  fs::path root_;
};

struct Changed {
  const char* file;
  std::function<void(const Folders&)> read;
};

const std::vector<Changed>& changed_files() {
  const auto euroc = [](const Folders& f) { make_euroc_source(f / "euroc", {}, {}); };
  const auto tum = [](const Folders& f) {
    make_tum_rgbd_source(f / "tum", f / "tum/camera.yaml", {});
  };
  const auto kitti = [](const Folders& f) { make_kitti_source(f / "kitti", {}, 1); };
  const auto raw = [](const Folders& f) {
    make_kitti_raw_source(f / "raw/d/d_drive_0001_sync", {});
  };
  const auto woods = [](const Folders& f) {
    read_lost_in_the_woods(f / "woods", RecordingProfile::kPlain);
  };
  const auto mrclam = [](const Folders& f) {
    read_mrclam(f / "mrclam", 1, RecordingProfile::kCalibrated);
  };
  const auto park = [](const Folders& f) { read_victoria_park(f / "park"); };
  static const std::vector<Changed> all = {
      {"euroc/mav0/cam0/sensor.yaml", euroc},
      {"euroc/mav0/cam0/data.csv", euroc},
      {"euroc/mav0/state_groundtruth_estimate0/data.csv", euroc},
      {"tum/rgb.txt", tum},
      {"tum/groundtruth.txt", tum},
      {"kitti/calib.txt", kitti},
      {"kitti/times.txt", kitti},
      {"kitti/poses.txt", kitti},
      {"raw/d/calib_cam_to_cam.txt", raw},
      {"raw/d/calib_velo_to_cam.txt", raw},
      {"raw/d/d_drive_0001_sync/oxts/timestamps.txt", raw},
      {"raw/d/d_drive_0001_sync/oxts/data/0000000001.txt", raw},
      {"woods/odom_gt.csv", woods},
      {"woods/obs.csv", woods},
      {"woods/landmarks.csv", woods},
      {"mrclam/Robot1_Odometry.dat", mrclam},
      {"mrclam/Robot1_Measurement.dat", mrclam},
      {"mrclam/Robot1_Groundtruth.dat", mrclam},
      {"mrclam/Landmark_Groundtruth.dat", mrclam},
      {"mrclam/Barcodes.dat", mrclam},
      {"park/odom.csv", park},
      {"park/trees.csv", park},
      {"park/gps.csv", park},
  };
  return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size < 1) return 0;
  static const Folders folders;
  const Changed& changed = changed_files()[bytes[0] % changed_files().size()];
  const std::string sound = folders.read(changed.file);
  folders.write(changed.file, std::string(reinterpret_cast<const char*>(bytes + 1), size - 1));
  try {
    changed.read(folders);
  } catch (const InputError& error) {
    PROMISE(10, std::string(error.what()).find('/') != std::string::npos);
  }
  folders.write(changed.file, sound);
  return 0;
}
