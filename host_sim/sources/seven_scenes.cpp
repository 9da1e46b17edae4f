#include <cmath>

#include <fmt/format.h>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/picture_folder.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/io/text_file.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "host_sim/sources/scene_tracks.hpp"

namespace cairn::host {

std::unique_ptr<FrameSource> make_seven_scenes_source(const std::filesystem::path& folder,
                                                      const std::filesystem::path& camera_file,
                                                      const FrameRange& range, LensCheck lens) {
  require_folder(folder, "a folder with frame-N.color.png or .jpg and frame-N.pose.txt");
  SourceInfo info;
  info.name = "seven-scenes";
  if (camera_file.empty()) {
    info.camera.fx = info.camera.fy = 520.0;
    info.camera.cx = 320.0;
    info.camera.cy = 240.0;
    info.camera.width = 640;
    info.camera.height = 480;
  } else {
    const CameraFile file = read_camera_file(camera_file, lens);
    info.camera = file.camera;
    info.focal_sigma = file.focal_sigma;
    info.readout = file.readout;
    info.inputs.push_back(camera_file);
  }
  info.frame_rate_hz = 30.0;
  info.note = "times from the frame numbers at 30 Hz";
  std::vector<SequenceFrame> frames;
  for (const NumberedFile& file :
       list_numbered_files(folder, "frame-", {".color.png", ".color.jpg"})) {
    std::string name = file.path.filename().string();
    name.erase(name.size() - std::string(".color.png").size());
    const std::filesystem::path pose = folder / (name + ".pose.txt");
    SequenceFrame frame;
    frame.image = file.path;
    frame.known.number = file.number;
    frame.known.t_us = std::llround(1e6 * file.number / info.frame_rate_hz);
    frame.known.true_T_world_camera = read_matrix_pose(pose);
    info.inputs.push_back(pose);
    frames.push_back(std::move(frame));
  }
  keep_range(range, folder, frames);
  const int points = add_scene_tracks(info.camera, SceneTrackSettings{}, frames);
  info.note += fmt::format("; {} scene points triangulated with the reference poses", points);
  return make_image_sequence(std::move(info), std::move(frames), range.in_colour);
}

}  // namespace cairn::host
