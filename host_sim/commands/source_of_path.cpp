#include "host_sim/commands/source_of_path.hpp"

#include <algorithm>
#include <filesystem>

namespace cairn::host {

namespace fs = std::filesystem;

namespace {

bool is_seven_scenes(const fs::path& folder) {
  const fs::directory_iterator files(folder);
  return std::any_of(begin(files), end(files), [](const fs::directory_entry& file) {
    const std::string name = file.path().filename().string();
    const std::string ending = ".pose.txt";
    return name.size() > ending.size() &&
           name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
  });
}

std::string kind_of_folder(const fs::path& folder) {
  if (fs::is_directory(folder / "mav0") || fs::exists(folder / "cam0" / "data.csv")) return "euroc";
  if (fs::exists(folder / "rgb.txt")) return "tum-rgbd";
  if (fs::is_directory(folder / "oxts") || fs::is_directory(folder / "image_0")) return "kitti";
  if (fs::is_directory(folder / "image_2") && fs::exists(folder / "calib.txt")) return "kitti";
  if (fs::exists(folder / "cMo_grid.csv")) return "tag-board";
  return is_seven_scenes(folder) ? "seven-scenes" : "video";
}

}  // namespace

std::string source_of_path(const std::string& path) {
  if (!fs::exists(path)) return {};
  return (fs::is_directory(path) ? kind_of_folder(path) : "video") + (":" + path);
}

}  // namespace cairn::host
