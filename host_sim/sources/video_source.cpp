#include "host_sim/sources/video_source.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/csv_units.hpp"
#include "host_sim/io/image_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/pose_file.hpp"
#include "host_sim/io/text_file.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr double kFolderRate = 30.0;
constexpr double kSpeedSigma = 0.1;     // assumed of odometry that states no noise
constexpr double kYawRateSigma = 0.05;  // rad/s
constexpr double kSteeringSigma = 0.087;
constexpr std::int64_t kTruthTolerance_us = 20000;

std::map<std::int64_t, std::int64_t> read_times(const fs::path& path) {
  std::map<std::int64_t, std::int64_t> times;
  if (path.empty()) return times;
  CsvReader csv(path);
  const std::size_t frame = csv.column("frame");
  const TimeColumn time(csv);
  while (csv.next()) {
    const std::int64_t t_us = time.t_us(csv);
    if (!times.empty() && t_us <= times.rbegin()->second) {
      throw InputError(path, csv.line(), "expected times in increasing order");
    }
    const std::int64_t number = csv.integer(frame);
    if (!times.empty() && number <= times.rbegin()->first) {
      throw InputError(path, csv.line(), "expected frame numbers in increasing order");
    }
    times[number] = t_us;
  }
  return times;
}

struct Odometry {
  OdometryModel model;
  std::vector<OdometrySample> samples;
};

Odometry read_odometry(const fs::path& path) {
  CsvReader csv(path);
  Odometry odometry;
  const bool twist = has_quantity(csv, kYawRate);
  const TimeColumn time(csv);
  const QuantityColumn speed = find_quantity(csv, kSpeed);
  const QuantityColumn turn = find_quantity(csv, twist ? kYawRate : kSteering);
  odometry.model.kind = twist ? OdometrySample::Kind::kTwist : OdometrySample::Kind::kAckermann;
  odometry.model.speed_sigma_mps = kSpeedSigma;
  odometry.model.turn_sigma = twist ? kYawRateSigma : kSteeringSigma;
  while (csv.next()) {
    OdometrySample sample;
    sample.t_us = time.t_us(csv);
    sample.kind = odometry.model.kind;
    sample.speed_mps = static_cast<float>(speed.value(csv));
    sample.turn = static_cast<float>(turn.value(csv));
    if (!odometry.samples.empty() && sample.t_us <= odometry.samples.back().t_us) {
      throw InputError(path, csv.line(), "expected times in increasing order");
    }
    if (!twist && odometry.samples.empty()) {
      odometry.model.wheelbase_m = find_quantity(csv, kWheelbase).value(csv);
      if (!(odometry.model.wheelbase_m > 0.0)) {
        throw InputError(path, csv.line(), "wheelbase_m: expected a length above zero");
      }
    }
    odometry.samples.push_back(sample);
  }
  if (odometry.samples.size() < 2) throw InputError(path, "expected two or more odometry rows");
  const auto span =
      static_cast<double>(odometry.samples.back().t_us - odometry.samples.front().t_us);
  odometry.model.period_s = 1e-6 * span / static_cast<double>(odometry.samples.size() - 1);
  return odometry;
}

/// A camera one metre up that looks forward, where the camera file does not say.
Rigid<double> default_mounting() {
  Matrix3<double> R_vehicle_camera;
  R_vehicle_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {Quaternion<double>(R_vehicle_camera), Vector3<double>(0.0, 0.0, 1.0)};
}

/// Pictures of a video file or a folder, one after the other.
class Media {
 public:
  explicit Media(const fs::path& path) : path_(path) {
    if (fs::is_directory(path)) {
      files_ = list_numbered_files(path, std::nullopt, {".png", ".jpg", ".jpeg", ".pgm", ".bmp"});
      return;
    }
    require_file(path, "a video file or a folder of numbered images");
    if (!capture_.open(path.string())) {
      throw InputError(path, "expected a video that OpenCV can decode");
    }
    const double rate = capture_.get(cv::CAP_PROP_FPS);
    if (rate >= 1.0 && rate <= 1000.0) rate_ = rate;
  }

  double rate() const { return rate_; }
  const std::vector<NumberedFile>& files() const { return files_; }

  /// Frames still to come, where the container says.
  int remaining() const {
    const std::size_t all =
        files_.empty()
            ? static_cast<std::size_t>(std::max(0.0, capture_.get(cv::CAP_PROP_FRAME_COUNT)))
            : files_.size();
    return all > position_ ? static_cast<int>(all - position_) : 0;
  }

  /// Goes to the first frame whose number is `first` or more.
  void skip_to(int first) {
    if (files_.empty()) {
      while (static_cast<int>(position_) < first && capture_.grab()) ++position_;
    } else {
      while (position_ < files_.size() && files_[position_].number < first) ++position_;
    }
  }

  bool next(const cv::Size& size, int& number, cv::Mat& grey) {
    if (!files_.empty()) {
      if (position_ == files_.size()) return false;
      const NumberedFile& file = files_[position_++];
      number = file.number;
      read_grey_image(file.path, size, grey);
      return true;
    }
    if (!capture_.read(colour_)) return false;
    number = static_cast<int>(position_++);
    if (colour_.channels() == 1) {
      colour_.copyTo(grey);
    } else {
      cv::cvtColor(colour_, grey, cv::COLOR_BGR2GRAY);
    }
    if (grey.size() != size) {
      throw InputError(path_,
                       fmt::format("expected {}x{} pixels as the camera file says, found {}x{}",
                                   size.width, size.height, grey.cols, grey.rows));
    }
    return true;
  }

 private:
  fs::path path_;
  std::vector<NumberedFile> files_;
  cv::VideoCapture capture_;
  cv::Mat colour_;
  std::size_t position_ = 0;
  double rate_ = kFolderRate;
};

class VideoSource final : public FrameSource {
 public:
  explicit VideoSource(const VideoOptions& options)
      : options_(options), media_(options.media), times_(read_times(options.times)) {
    const CameraFile camera = read_camera_file(options.camera);
    info_.name = "video";
    info_.camera = camera.camera;
    info_.frame_rate_hz = media_.rate();
    info_.inputs = {options.camera};
    if (media_.files().empty()) info_.inputs.push_back(options.media);
    for (const NumberedFile& file : media_.files()) info_.inputs.push_back(file.path);
    if (!options.times.empty()) info_.inputs.push_back(options.times);
    if (!options.truth.empty()) {
      truth_ = read_tum(options.truth);
      info_.inputs.push_back(options.truth);
    }
    if (!options.odometry.empty()) {
      odometry_ = read_odometry(options.odometry);
      info_.odometry = odometry_.model;
      info_.inputs.push_back(options.odometry);
      info_.T_vehicle_camera = camera.T_vehicle_camera.value_or(default_mounting());
    }
    media_.skip_to(options.range.first.value_or(0));
    const int count =
        std::min(media_.remaining(), options.range.count.value_or(media_.remaining()));
    if (count > 0) info_.frame_count = count;
  }

  const SourceInfo& info() const override { return info_; }

  bool next(Frame& frame) override {
    if (options_.range.count.has_value() && given_ >= *options_.range.count) return false;
    int number = 0;
    if (!media_.next({info_.camera.width, info_.camera.height}, number, frame.grey)) {
      if (given_ > 0) return false;
      throw InputError(options_.media, fmt::format("expected frames from number {} on, found none",
                                                   options_.range.first.value_or(0)));
    }
    describe(number, frame);
    ++given_;
    return true;
  }

 private:
  std::int64_t time_of(int number) const {
    if (times_.empty()) return std::llround(1e6 * number / info_.frame_rate_hz);
    const auto found = times_.find(number);
    if (found == times_.end()) {
      throw InputError(options_.times, fmt::format("expected a row for frame {}", number));
    }
    return found->second;
  }

  void describe(int number, Frame& frame) {
    frame.number = number;
    frame.t_us = time_of(number);
    frame.scene_points.clear();
    frame.odometry.clear();
    while (next_sample_ < odometry_.samples.size() &&
           odometry_.samples[next_sample_].t_us <= frame.t_us) {
      if (given_ > 0) frame.odometry.push_back(odometry_.samples[next_sample_]);
      ++next_sample_;
    }
    frame.true_T_world_camera.reset();
    frame.true_T_world_vehicle.reset();
    while (next_truth_ + 1 < truth_.size() && std::abs(truth_[next_truth_ + 1].t_us - frame.t_us) <=
                                                  std::abs(truth_[next_truth_].t_us - frame.t_us)) {
      ++next_truth_;
    }
    if (!truth_.empty() && std::abs(truth_[next_truth_].t_us - frame.t_us) <= kTruthTolerance_us) {
      frame.true_T_world_camera = truth_[next_truth_].pose;
      if (info_.odometry.has_value()) {
        frame.true_T_world_vehicle = *frame.true_T_world_camera * info_.T_vehicle_camera.inverse();
      }
    }
  }

  VideoOptions options_;
  Media media_;
  std::map<std::int64_t, std::int64_t> times_;
  Odometry odometry_;
  std::vector<TimedPose> truth_;
  SourceInfo info_;
  std::size_t next_sample_ = 0;
  std::size_t next_truth_ = 0;
  int given_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> make_video_source(const VideoOptions& options) {
  if (options.camera.empty()) {
    throw UsageError("source video: expected a camera file by --camera");
  }
  return std::make_unique<VideoSource>(options);
}

}  // namespace cairn::host
