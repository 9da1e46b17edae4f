#include "host_sim/sources/gyro_source.hpp"

#include <utility>

#include <fmt/format.h>

namespace cairn::host {
namespace {

constexpr std::int64_t kBeforeFirst_us = 100000;
constexpr std::int64_t kLeastStep_us = 100;

class GyroSource final : public FrameSource {
 public:
  GyroSource(std::unique_ptr<FrameSource> source, std::vector<AngularRateSample> samples,
             const GyroParameters& parameters, std::filesystem::path path)
      : source_(std::move(source)),
        samples_(std::move(samples)),
        path_(std::move(path)),
        info_(source_->info()) {
    info_.gyro = parameters;
    info_.inputs.push_back(path_);
    warnings_ = info_.warnings.size();
    check_times(parameters);
  }

  const SourceInfo& info() const override { return info_; }
  std::optional<TimeSpan> span() const override { return source_->span(); }

  bool next(Frame& frame) override {
    const bool more = source_->next(frame);
    const std::vector<std::string>& warnings = source_->info().warnings;
    for (; warnings_ < warnings.size(); ++warnings_) info_.warnings.push_back(warnings[warnings_]);
    info_.damaged = source_->info().damaged || foreign_;
    if (!more) {
      warn();
      return false;
    }
    frame.gyro.clear();
    while (next_ < samples_.size() && samples_[next_].t_us <= frame.t_us) {
      const bool late = begun_ || samples_[next_].t_us > frame.t_us - kBeforeFirst_us;
      if (late) frame.gyro.push_back(samples_[next_]);
      ++next_;
    }
    ++frames_;
    without_ += frame.gyro.empty() ? 1 : 0;
    begun_ = true;
    return true;
  }

 private:
  void check_times(const GyroParameters& parameters) {
    std::vector<std::int64_t> times;
    times.reserve(samples_.size());
    for (const AngularRateSample& sample : samples_) times.push_back(sample.t_us);
    const TimeSpan own{times.front(), times.back()};
    const auto warning = check_overlap(path_, "the gyroscope", times, source_->span().value_or(own),
                                       kLeastStep_us, parameters.max_gap_us);
    if (!warning) return;
    info_.warnings.push_back(*warning);
    warned_ = true;
  }

  void warn() {
    if (warned_ || 2 * without_ <= frames_) return;
    warned_ = true;
    foreign_ = info_.damaged = without_ == frames_;
    info_.warnings.push_back(
        fmt::format("{}: {} of {} frames have no sample of the gyroscope since the frame before: "
                    "its times are not those of the frames",
                    path_.string(), without_, frames_));
  }

  std::unique_ptr<FrameSource> source_;
  std::vector<AngularRateSample> samples_;
  std::filesystem::path path_;
  SourceInfo info_;
  std::size_t next_ = 0;
  std::size_t warnings_ = 0;
  int frames_ = 0;
  int without_ = 0;
  bool begun_ = false;
  bool warned_ = false;
  bool foreign_ = false;  ///< of another clock than the frames
};

}  // namespace

std::unique_ptr<FrameSource> add_gyro(std::unique_ptr<FrameSource> source,
                                      std::vector<AngularRateSample> samples,
                                      const GyroParameters& parameters,
                                      const std::filesystem::path& path) {
  return std::make_unique<GyroSource>(std::move(source), std::move(samples), parameters, path);
}

}  // namespace cairn::host
