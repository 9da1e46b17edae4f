#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/io/text_file.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "host_sim/sources/listed_files.hpp"
#include "host_sim/sources/true_poses.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

PinholeCamera<double> published_camera(const fs::path& folder) {
  PinholeCamera<double> camera;
  camera.width = 640;
  camera.height = 480;
  const std::string name = fs::absolute(folder).lexically_normal().string();
  const auto set = [&](double fx, double fy, double cx, double cy) {
    camera.fx = fx;
    camera.fy = fy;
    camera.cx = cx;
    camera.cy = cy;
  };
  const auto distort = [&](double k1, double k2, double p1, double p2, double k3) {
    camera.k1 = k1;
    camera.k2 = k2;
    camera.p1 = p1;
    camera.p2 = p2;
    camera.k3 = k3;
  };
  if (name.find("freiburg1") != std::string::npos) {
    set(517.3, 516.5, 318.6, 255.3);
    distort(0.2624, -0.9531, -0.0054, 0.0026, 1.1633);
  } else if (name.find("freiburg2") != std::string::npos) {
    set(520.9, 521.0, 325.1, 249.7);
    distort(0.2312, -0.7849, -0.0033, -0.0001, 0.9172);
  } else if (name.find("freiburg3") != std::string::npos) {
    set(535.4, 539.2, 320.1, 247.6);
  } else {
    throw InputError(folder,
                     "expected 'freiburg1', 'freiburg2' or 'freiburg3' in the folder's name,"
                     " or a camera file by --camera");
  }
  return camera;
}

}  // namespace

std::unique_ptr<FrameSource> make_tum_rgbd_source(const fs::path& folder,
                                                  const fs::path& camera_file,
                                                  const FrameRange& range, LensCheck lens) {
  require_folder(folder, "a folder with rgb.txt");
  require_file(folder / "rgb.txt", "the list of pictures of TUM RGB-D");
  SourceInfo info;
  info.name = "tum-rgbd";
  if (camera_file.empty()) {
    info.camera = published_camera(folder);
  } else {
    const CameraFile file = read_camera_file(camera_file, lens);
    info.camera = file.camera;
    info.T_body_camera = file.T_body_camera;
    info.focal_sigma = file.focal_sigma;
    info.readout = file.readout;
    info.inputs.push_back(camera_file);
  }
  info.frame_rate_hz = 30.0;
  const fs::path list = folder / "rgb.txt";
  const fs::path truth_path = folder / "groundtruth.txt";
  info.inputs.push_back(list);
  std::vector<TimedPose> truth;
  if (fs::exists(truth_path)) {
    truth = read_tum(truth_path);
    info.inputs.push_back(truth_path);
  } else {
    info.note = "no groundtruth.txt, so no true poses";
  }
  std::vector<SequenceFrame> frames;
  LineReader lines(list);
  for (TextLine line; lines.next(line);) {
    const std::vector<std::string_view> fields = split_blanks(line.text);
    if (fields.size() != 2) throw InputError(list, line.number, "expected: time file");
    SequenceFrame frame;
    frame.known.number = static_cast<int>(frames.size());
    frame.known.t_us =
        parse_time_us(parse_number(fields[0], list, line.number, "time"), 1e6, list, line.number);
    if (!frames.empty() && frame.known.t_us <= frames.back().known.t_us) {
      throw InputError(list, line.number, "expected times in increasing order");
    }
    frame.image = folder / inside_folder(std::string(fields[1]), list, line.number);
    if (!truth.empty()) frame.known.true_T_world_camera = pose_near(truth, frame.known.t_us);
    frames.push_back(std::move(frame));
  }
  if (frames.empty()) throw InputError(list, "expected lines of: time file");
  std::vector<std::int64_t> frame_times;
  for (const SequenceFrame& frame : frames) frame_times.push_back(frame.known.t_us);
  check_frame_times(list, frame_times);
  if (!truth.empty()) {
    check_truth(truth_path, truth, {frame_times.front(), frame_times.back()}, info);
  }
  return make_image_sequence(std::move(info), std::move(frames), range, list);
}

}  // namespace cairn::host
