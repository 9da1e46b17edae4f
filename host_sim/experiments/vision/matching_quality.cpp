#include "host_sim/experiments/vision/matching_quality.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include <fmt/format.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "cairn/vision/freak.hpp"

#include "host_sim/experiments/vision/describe_image.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/output_file.hpp"

namespace cairn::host {
namespace {

constexpr int kBorder = 70;  // room for the largest pattern
constexpr int kQueries = 300;
constexpr int kCandidates = 1000;
constexpr double kSamePlace_px = 2.5;
constexpr double kDegree = CV_PI / 180;

/// Two images and the map of points from the first to the second.
struct Pair {
  std::string group;
  cv::Mat first;
  cv::Mat second;
  cv::Matx33d map;
};

cv::Point2d apply(const cv::Matx33d& map, const cv::Point2d& p) {
  const cv::Vec3d q = map * cv::Vec3d(p.x, p.y, 1);
  return {q[0] / q[2], q[1] / q[2]};
}

/// Relative roll and scale of the map at a point of the first image.
struct LocalChange {
  double roll_rad = 0;
  double log2_scale = 0;
};
LocalChange change_at(const cv::Matx33d& map, const cv::Point2d& p) {
  const cv::Point2d origin = apply(map, p);
  const cv::Point2d dx = apply(map, p + cv::Point2d(1, 0)) - origin;
  const cv::Point2d dy = apply(map, p + cv::Point2d(0, 1)) - origin;
  const double determinant = dx.x * dy.y - dx.y * dy.x;
  return {std::atan2(dx.y - dy.x, dx.x + dy.y), std::log2(std::sqrt(std::abs(determinant)))};
}

struct Method {
  std::string name;
  enum Kind { kSelf, kSelfFull, kUpright, kSteered, kOrb, kOrbSteered } kind;
  bool steer_scale = false;
  double roll_error_rad = 0;
  double scale_error = 0;
};

const std::vector<Method> kMethods = {
    {"FREAK self-oriented (OpenCV)", Method::kSelf},
    {"FREAK self-oriented, full precision", Method::kSelfFull},
    {"FREAK upright", Method::kUpright},
    {"FREAK steered by roll", Method::kSteered},
    {"FREAK steered by roll and scale", Method::kSteered, true},
    {"the same, errors 3 deg, 6 %", Method::kSteered, true, 3 * kDegree, 0.06},
    {"the same, errors 8 deg, 15 %", Method::kSteered, true, 8 * kDegree, 0.15},
    {"ORB", Method::kOrb},
    {"ORB steered by roll", Method::kOrbSteered},
};

/// Scale index and orientation of a described point: the reference looks at the coarser scale when
/// the second image shows less detail, because indices below 0 do not exist.
FreakPose pose_of(const Method& method, const LocalChange& change, bool reference) {
  FreakPose pose;
  if (method.kind != Method::kSteered) return pose;
  if (!reference) {
    pose.orientation_bin = static_cast<std::uint8_t>(std::lround(change.roll_rad * 128 / CV_PI));
  }
  if (method.steer_scale) {
    const double index = (reference ? -16 : 16) * change.log2_scale;
    pose.scale_index = static_cast<std::uint8_t>(std::lround(std::clamp(index, 0.0, 24.0)));
  }
  return pose;
}

cv::Mat describe_orb(const Method& method, const cv::Mat& image,
                     const std::vector<cv::Point>& points, const std::vector<LocalChange>& changes,
                     bool reference) {
  std::vector<cv::KeyPoint> keypoints;
  for (std::size_t i = 0; i < points.size(); ++i) {
    float angle = 0;
    if (method.kind == Method::kOrb) {
      // Intensity centroid, as ORB computes it when it detects: over the disc of radius 15.
      double m10 = 0;
      double m01 = 0;
      for (int v = -15; v <= 15; ++v) {
        const int reach = static_cast<int>(std::lround(std::sqrt(15.0 * 15.0 - v * v)));
        for (int u = -reach; u <= reach; ++u) {
          const int value = image.at<std::uint8_t>(points[i].y + v, points[i].x + u);
          m10 += u * value;
          m01 += v * value;
        }
      }
      angle = static_cast<float>(std::atan2(m01, m10) / kDegree);
    } else if (!reference) {
      angle = static_cast<float>(changes[i].roll_rad / kDegree);
    }
    keypoints.emplace_back(cv::Point2f(points[i]), 31.0F, angle < 0 ? angle + 360 : angle, 0.0F, 0);
  }
  cv::Mat rows;
  cv::ORB::create(5000, 1.2F, 1, 31, 0, 2, cv::ORB::FAST_SCORE)->compute(image, keypoints, rows);
  return rows;
}

cv::Mat describe(const Method& method, const cv::Mat& image, const std::vector<cv::Point>& points,
                 std::vector<LocalChange> changes, bool reference) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (LocalChange& change : changes) {
    if (reference) break;
    change.roll_rad += method.roll_error_rad * normal(random);
    change.log2_scale += method.scale_error * normal(random) / std::log(2.0);
  }
  if (method.kind == Method::kOrb || method.kind == Method::kOrbSteered) {
    return describe_orb(method, image, points, changes, reference);
  }
  cv::Mat rows(static_cast<int>(points.size()), Descriptor::kBytes, CV_8U);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Descriptor descriptor;
    std::uint8_t bin = 0;
    Status status = Status::kOk;
    if (method.kind == Method::kSelf || method.kind == Method::kSelfFull) {
      status = describe_freak(
          view_of(image), points[i].x, points[i].y, descriptor, bin,
          method.kind == Method::kSelf ? FreakOrientation::kOpenCv : FreakOrientation::kFull);
    } else {
      status = describe_freak(view_of(image), points[i].x, points[i].y,
                              pose_of(method, changes[i], reference), descriptor);
    }
    if (!ok(status)) throw std::logic_error("a point inside the border cannot be described");
    std::copy(descriptor.bytes, descriptor.bytes + Descriptor::kBytes,
              rows.ptr(static_cast<int>(i)));
  }
  return rows;
}

bool inside(const cv::Mat& image, const cv::Point2d& p) {
  return p.x >= kBorder && p.y >= kBorder && p.x < image.cols - kBorder &&
         p.y < image.rows - kBorder;
}

std::vector<cv::Point> strong_points(const cv::Mat& image, int threshold, int count,
                                     const cv::Mat* other, const cv::Matx33d& map) {
  std::vector<cv::Point> points;
  for (const Corner& c : strongest(detect_corners(image, threshold), 0)) {
    const cv::Point p(c.x, c.y);
    if (!inside(image, p) || (other != nullptr && !inside(*other, apply(map, p)))) continue;
    points.push_back(p);
    if (static_cast<int>(points.size()) == count) break;
  }
  return points;
}

/// Percent of right nearest neighbours, one value per method; empty when too little is in view.
std::vector<double> evaluate(const Pair& pair) {
  std::vector<cv::Point> queries;
  std::vector<std::vector<int>> right;
  const auto candidates = strong_points(pair.second, 15, kCandidates, nullptr, pair.map);
  for (const auto& q : strong_points(pair.first, 20, kQueries, &pair.second, pair.map)) {
    std::vector<int> same;
    for (std::size_t j = 0; j < candidates.size(); ++j) {
      if (cv::norm(apply(pair.map, q) - cv::Point2d(candidates[j])) <= kSamePlace_px) {
        same.push_back(static_cast<int>(j));
      }
    }
    if (same.empty()) continue;
    queries.push_back(q);
    right.push_back(same);
  }
  if (queries.size() < 15) return {};
  std::vector<LocalChange> query_changes;
  std::vector<LocalChange> candidate_changes;
  for (const auto& q : queries) query_changes.push_back(change_at(pair.map, q));
  for (const auto& c : candidates) {
    candidate_changes.push_back(change_at(pair.map, apply(pair.map.inv(), c)));
  }
  std::vector<double> percent;
  for (const Method& method : kMethods) {
    const cv::Mat a = describe(method, pair.first, queries, query_changes, true);
    const cv::Mat b = describe(method, pair.second, candidates, candidate_changes, false);
    std::vector<cv::DMatch> matches;
    cv::BFMatcher(cv::NORM_HAMMING).match(a, b, matches);
    int correct = 0;
    for (const auto& m : matches) {
      const auto& same = right[static_cast<std::size_t>(m.queryIdx)];
      correct += std::count(same.begin(), same.end(), m.trainIdx) > 0 ? 1 : 0;
    }
    percent.push_back(100.0 * correct / static_cast<double>(queries.size()));
  }
  return percent;
}

struct Change {
  const char* group;
  double rotation_deg;
  double scale;
  double blur_px;
  double noise;
  double perspective;
};
constexpr Change kChanges[] = {
    {"rotation", 15, 1, 0, 2, 0},      {"rotation", 30, 1, 0, 2, 0},
    {"rotation", 90, 1, 0, 2, 0},      {"rotation", 160, 1, 0, 2, 0},
    {"scale 0.67", 0, 0.67, 0, 2, 0},  {"scale 0.8", 0, 0.8, 0, 2, 0},
    {"scale 1.25", 0, 1.25, 0, 2, 0},  {"scale 1.5", 0, 1.5, 0, 2, 0},
    {"scale 2", 0, 2, 0, 2, 0},        {"rotation+scale", 30, 1.25, 0, 2, 0},
    {"blur", 0, 1, 1.5, 2, 0},         {"blur", 0, 1, 2.5, 2, 0},
    {"noise", 0, 1, 0, 5, 0},          {"noise", 0, 1, 0, 10, 0},
    {"perspective", 10, 1, 0, 2, 9e-4}};

Pair warped(const cv::Mat& image, const Change& change) {
  const cv::Point2f centre(static_cast<float>(image.cols) / 2, static_cast<float>(image.rows) / 2);
  const cv::Mat affine = cv::getRotationMatrix2D(centre, -change.rotation_deg, change.scale);
  cv::Matx33d map = cv::Matx33d::eye();
  for (int r = 0; r < 2; ++r) {
    for (int c = 0; c < 3; ++c) map(r, c) = affine.at<double>(r, c);
  }
  const cv::Matx33d tilt(1, 0, 0, 0, 1, 0, change.perspective, change.perspective / 2, 1);
  const cv::Matx33d to_centre(1, 0, -centre.x, 0, 1, -centre.y, 0, 0, 1);
  map = to_centre.inv() * tilt * to_centre * map;
  Pair pair{change.group, image, {}, map};
  cv::warpPerspective(image, pair.second, map, image.size(),
                      change.scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR, cv::BORDER_REFLECT);
  if (change.blur_px > 0) cv::GaussianBlur(pair.second, pair.second, {}, change.blur_px);
  cv::Mat noise(image.size(), CV_32F);
  cv::RNG(12345).fill(noise, cv::RNG::NORMAL, 0, change.noise);
  cv::Mat sum;
  pair.second.convertTo(sum, CV_32F);
  sum += noise;
  sum.convertTo(pair.second, CV_8U);
  return pair;
}

cv::Matx33d read_homography(const std::filesystem::path& file) {
  std::ifstream in(file);
  cv::Matx33d map;
  for (double& value : map.val) in >> value;
  if (!in) throw InputError(file, "expected nine numbers of a homography");
  return map;
}

}  // namespace

std::map<int, PairQuality> measure_matching_quality(const std::filesystem::path& homography_sets,
                                                    const Shard& shard) {
  std::map<int, PairQuality> pairs;
  int number = 0;
  const auto add = [&](const auto& make_pair) {
    if (shard.has(static_cast<std::size_t>(number))) {
      const Pair pair = make_pair();
      pairs[number] = {pair.group, evaluate(pair)};
    }
    ++number;
  };
  const std::filesystem::path graf = homography_sets / "graf";
  for (const auto& file : {graf / "img1.png", homography_sets / "churchill" / "1.png"}) {
    const cv::Mat image = read_grey(file);
    for (const Change& change : kChanges) add([&] { return warped(image, change); });
  }
  const cv::Mat first = read_grey(graf / "img1.png");
  for (const int other : {2, 3, 4}) {
    add([&] {
      return Pair{fmt::format("graf 1-{}", other), first,
                  read_grey(graf / fmt::format("img{}.png", other)),
                  read_homography(graf / fmt::format("H1to{}p", other))};
    });
  }
  return pairs;
}

std::vector<QualityResult> mean_quality(const std::vector<PairQuality>& pairs) {
  std::vector<QualityResult> results;
  for (const PairQuality& pair : pairs) {
    for (std::size_t i = 0; i < pair.percent.size(); ++i) {
      const auto same = [&](const QualityResult& r) {
        return r.method == kMethods[i].name && r.group == pair.group;
      };
      auto found = std::find_if(results.begin(), results.end(), same);
      if (found == results.end()) {
        results.push_back({kMethods[i].name, pair.group, 0, 0});
        found = results.end() - 1;
      }
      found->correct_percent =
          (found->correct_percent * found->pairs + pair.percent[i]) / (found->pairs + 1);
      ++found->pairs;
    }
  }
  return results;
}

void write_quality(const std::vector<QualityResult>& results, const std::filesystem::path& file) {
  OutputFile out(file);
  out.print("method,group,correct_percent,pairs\n");
  for (const QualityResult& r : results) {
    out.print("\"{}\",{},{:.1f},{}\n", r.method, r.group, r.correct_percent, r.pairs);
  }
  out.finish();
}

std::string quality_table(const std::vector<QualityResult>& results) {
  std::vector<std::string> groups;
  for (const QualityResult& r : results) {
    if (r.method == kMethods[0].name) groups.push_back(r.group);
  }
  std::string table = "| nearest neighbour right, % |";
  for (const auto& g : groups) table += fmt::format(" {} |", g);
  table += " mean |\n| --- |";
  for (std::size_t i = 0; i <= groups.size(); ++i) table += " --- |";
  table += '\n';
  for (const Method& method : kMethods) {
    table += fmt::format("| {} |", method.name);
    double sum = 0;
    for (const auto& g : groups) {
      for (const QualityResult& r : results) {
        if (r.method != method.name || r.group != g) continue;
        table += fmt::format(" {:.1f} |", r.correct_percent);
        sum += r.correct_percent;
      }
    }
    table += fmt::format(" {:.1f} |\n", sum / static_cast<double>(groups.size()));
  }
  return table;
}

}  // namespace cairn::host
