// The vision front end against OpenCV's, single thread. Each iteration runs both, one after the
// other, so that what else the machine does hits both alike; `speedup` is the ratio of the medians.

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#if __has_include(<opencv2/xfeatures2d.hpp>)
#include <opencv2/xfeatures2d.hpp>
#define CAIRN_HAS_OPENCV_FREAK 1
#else
#define CAIRN_HAS_OPENCV_FREAK 0
#endif

#include "cairn/vision/fast.hpp"
#include "cairn/vision/freak.hpp"
#include "cairn/vision/hamming.hpp"

namespace {

using Clock = std::chrono::steady_clock;

const char* const kImages[] = {
    "homography/graf/img1.png", "homography/graf/img3.png", "homography/churchill/1.png",
    "seven_scenes_redkitchen/frame-000000.color.jpg", "desk_tag_board/gray/0000.png"};

cv::Mat read_image(int index) {
  return cv::imread(std::string(CAIRN_SOURCE_DIR "/../shared/data/") + kImages[index],
                    cv::IMREAD_GRAYSCALE);
}

cairn::ImageView view_of(const cv::Mat& m) {
  return {m.data, m.cols, m.rows, static_cast<int>(m.step)};
}

template <class F>
double microseconds(F run) {
  const auto start = Clock::now();
  run();
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

template <class Theirs, class Ours>
void run_pairs(benchmark::State& state, Theirs theirs, Ours ours) {
  std::vector<double> their_us;
  std::vector<double> our_us;
  for (auto _ : state) {
    their_us.push_back(microseconds(theirs));
    our_us.push_back(microseconds(ours));
  }
  state.counters["opencv_us"] = median(their_us);
  state.counters["cairn_us"] = median(our_us);
  state.counters["speedup"] = median(their_us) / median(our_us);
}

std::vector<cairn::Corner> detect(const cv::Mat& image, int threshold) {
  static const auto scratch = std::make_unique<cairn::FastScratch<4096>>();
  std::vector<cairn::Corner> corners(20000);
  cairn::FastReport report;
  (void)cairn::detect_fast(view_of(image), {0, 0, image.cols, image.rows}, threshold, *scratch,
                           corners.data(), static_cast<int>(corners.size()), report);
  corners.resize(static_cast<std::size_t>(report.found - report.dropped));
  return corners;
}

void fast(benchmark::State& state) {
  const cv::Mat image = read_image(static_cast<int>(state.range(0)));
  if (image.empty()) return state.SkipWithError("no image");
  const auto scratch = std::make_unique<cairn::FastScratch<4096>>();
  std::vector<cairn::Corner> corners(20000);
  std::vector<cv::KeyPoint> keypoints;
  cairn::FastReport report;
  run_pairs(
      state, [&] { cv::FAST(image, keypoints, 20, true); },
      [&] {
        (void)cairn::detect_fast(view_of(image), {0, 0, image.cols, image.rows}, 20, *scratch,
                                 corners.data(), static_cast<int>(corners.size()), report);
      });
  state.counters["corners"] = report.found;
  state.SetLabel(kImages[state.range(0)]);
}

std::vector<cairn::Corner> describable(const cv::Mat& image, std::size_t count) {
  std::vector<cairn::Corner> corners = detect(image, 20);
  const int margin = cairn::freak_margin(0);
  corners.erase(std::remove_if(corners.begin(), corners.end(),
                               [&](const cairn::Corner& c) {
                                 return c.x < margin || c.y < margin || c.x > image.cols - margin ||
                                        c.y > image.rows - margin;
                               }),
                corners.end());
  if (corners.size() > count) corners.resize(count);
  return corners;
}

enum FreakMode { kSelfOriented, kSteered, kUpright };

/// OpenCV's FREAK cannot be steered: what a user of it has in place of steering is
/// self-orientation.
void freak(benchmark::State& state) {
  const cv::Mat image = read_image(0);
  if (image.empty()) return state.SkipWithError("no image");
  const auto mode = static_cast<FreakMode>(state.range(0));
  const auto corners = describable(image, static_cast<std::size_t>(state.range(1)));
  std::vector<cairn::Descriptor> descriptors(corners.size());
  const auto ours = [&] {
    for (std::size_t i = 0; i < corners.size(); ++i) {
      std::uint8_t bin = 0;
      const cairn::FreakPose pose{static_cast<std::uint8_t>(mode == kSteered ? 37 * i : 0), 0};
      if (mode == kSelfOriented) {
        (void)cairn::describe_freak(view_of(image), corners[i].x, corners[i].y, descriptors[i],
                                    bin);
      } else {
        (void)cairn::describe_freak(view_of(image), corners[i].x, corners[i].y, pose,
                                    descriptors[i]);
      }
    }
    benchmark::DoNotOptimize(descriptors.data());
  };
  const char* const names[] = {"self-oriented", "steered", "upright"};
  state.SetLabel(names[mode]);
#if CAIRN_HAS_OPENCV_FREAK
  // The first use builds its table of 8 MB; that is not counted.
  const auto oracle = cv::xfeatures2d::FREAK::create(mode != kUpright);
  std::vector<cv::KeyPoint> keypoints;
  for (const auto& c : corners) keypoints.emplace_back(c.x, c.y, 7.0F);
  cv::Mat theirs;
  oracle->compute(image, keypoints, theirs);
  run_pairs(
      state, [&] { oracle->compute(image, keypoints, theirs); }, ours);
  state.counters["us_per_descriptor"] =
      state.counters["cairn_us"] / static_cast<double>(corners.size());
#else
  std::vector<double> our_us;
  for (auto _ : state) our_us.push_back(microseconds(ours));
  state.counters["cairn_us"] = median(our_us);
  state.counters["us_per_descriptor"] = median(our_us) / static_cast<double>(corners.size());
#endif
}

void matcher(benchmark::State& state) {
  const cv::Mat first = read_image(0);
  const cv::Mat second = read_image(1);
  if (first.empty() || second.empty()) return state.SkipWithError("no image");
  const auto describe = [](const cv::Mat& image, std::size_t count) {
    std::vector<cairn::Descriptor> descriptors;
    for (const auto& c : describable(image, count)) {
      cairn::Descriptor d;
      std::uint8_t bin = 0;
      (void)cairn::describe_freak(view_of(image), c.x, c.y, d, bin);
      descriptors.push_back(d);
    }
    return descriptors;
  };
  auto queries = describe(first, static_cast<std::size_t>(state.range(0)));
  auto candidates = describe(second, static_cast<std::size_t>(state.range(1)));
  const cv::Mat query_rows(static_cast<int>(queries.size()), 64, CV_8U, queries.data());
  const cv::Mat candidate_rows(static_cast<int>(candidates.size()), 64, CV_8U, candidates.data());
  const cv::BFMatcher brute_force(cv::NORM_HAMMING);
  std::vector<cv::DMatch> matches;
  run_pairs(
      state, [&] { brute_force.match(query_rows, candidate_rows, matches); },
      [&] {
        for (const auto& q : queries) {
          benchmark::DoNotOptimize(
              cairn::match_hamming(q, {candidates.data(), static_cast<int>(candidates.size())}));
        }
      });
}

void orb_and_freak(benchmark::State& state) {
  const cv::Mat image = read_image(0);
  if (image.empty()) return state.SkipWithError("no image");
  const auto corners = describable(image, 500);
  std::vector<cv::KeyPoint> keypoints;
  for (const auto& c : corners) keypoints.emplace_back(c.x, c.y, 31.0F, 0.0F);
  const auto orb = cv::ORB::create(500, 1.2F, 1);
  cv::Mat rows;
  std::vector<cairn::Descriptor> descriptors(corners.size());
  run_pairs(
      state, [&] { orb->compute(image, keypoints, rows); },
      [&] {
        for (std::size_t i = 0; i < corners.size(); ++i) {
          (void)cairn::describe_freak(view_of(image), corners[i].x, corners[i].y,
                                      cairn::FreakPose{}, descriptors[i]);
        }
        benchmark::DoNotOptimize(descriptors.data());
      });
}

}  // namespace

BENCHMARK(fast)->DenseRange(0, 4)->Unit(benchmark::kMicrosecond);
BENCHMARK(freak)->ArgsProduct({{0, 1, 2}, {50, 500}})->Unit(benchmark::kMicrosecond);
BENCHMARK(matcher)->Args({100, 1000})->Args({500, 1000})->Unit(benchmark::kMicrosecond);
BENCHMARK(orb_and_freak)->Unit(benchmark::kMicrosecond);

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
