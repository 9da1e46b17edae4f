#include "host_sim/world/hall_pictures.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace cairn::host {

void add_mottle(cv::Mat& image, int cell_px, double amplitude, GaussianRandom& random) {
  cv::Mat coarse(image.rows / cell_px + 2, image.cols / cell_px + 2, CV_16SC1);
  for (int y = 0; y < coarse.rows; ++y) {
    for (int x = 0; x < coarse.cols; ++x) {
      coarse.at<std::int16_t>(y, x) =
          static_cast<std::int16_t>(round_to_int(random.normal(amplitude * 16.0)));
    }
  }
  for (int y = 0; y < image.rows; ++y) {
    std::uint8_t* row = image.ptr<std::uint8_t>(y);
    const int cy = y / cell_px;
    const int fy = y % cell_px;
    const std::int16_t* upper = coarse.ptr<std::int16_t>(cy);
    const std::int16_t* lower = coarse.ptr<std::int16_t>(cy + 1);
    for (int x = 0; x < image.cols; ++x) {
      const int cx = x / cell_px;
      const int fx = x % cell_px;
      const int top = upper[cx] * (cell_px - fx) + upper[cx + 1] * fx;
      const int bottom = lower[cx] * (cell_px - fx) + lower[cx + 1] * fx;
      const int shade = (top * (cell_px - fy) + bottom * fy) / (cell_px * cell_px * 16);
      row[x] = static_cast<std::uint8_t>(std::clamp(row[x] + shade, 0, 255));
    }
  }
}

void add_vertical_shade(cv::Mat& image, double top_gain, double bottom_gain) {
  for (int y = 0; y < image.rows; ++y) {
    const double f = static_cast<double>(y) / image.rows;
    const int gain = static_cast<int>(256.0 * (top_gain + f * (bottom_gain - top_gain)));
    std::uint8_t* row = image.ptr<std::uint8_t>(y);
    for (int x = 0; x < image.cols; ++x) {
      row[x] = static_cast<std::uint8_t>(std::min(255, row[x] * gain >> 8));
    }
  }
}

void box(cv::Mat& image, const cv::Rect& rect, int level) {
  cv::rectangle(image, rect, cv::Scalar(level), cv::FILLED);
}

void label(cv::Mat& image, const std::string& text, cv::Point centre, double height_px, int level) {
  const double scale = height_px / 22.0;
  const int thickness = std::max(1, round_to_int(height_px / 7.0));
  int baseline = 0;
  const cv::Size size =
      cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, thickness, &baseline);
  cv::putText(image, text, {centre.x - size.width / 2, centre.y + size.height / 2},
              cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar(level), thickness, cv::LINE_AA);
}

namespace {

void draw_blocks(cv::Mat& area, GaussianRandom& random) {
  const int columns = 3 + random.below(3);
  const int rows = std::max(3, columns * area.rows / area.cols);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const cv::Rect cell(c * area.cols / columns, r * area.rows / rows, area.cols / columns + 1,
                          area.rows / rows + 1);
      box(area, cell & cv::Rect(0, 0, area.cols, area.rows), 30 + random.below(200));
    }
  }
}

void draw_shapes(cv::Mat& area, GaussianRandom& random) {
  area.setTo(150 + random.below(80));
  const int count = 7 + random.below(5);
  const int unit = std::min(area.cols, area.rows);
  for (int i = 0; i < count; ++i) {
    const int y = random.below(area.rows);
    const cv::Point at(random.below(area.cols), y);
    const int size = unit / 10 + random.below(unit / 4);
    const int level = random.below(2) == 0 ? 20 + random.below(70) : 150 + random.below(100);
    if (random.below(3) == 0) {
      cv::circle(area, at, size / 2, cv::Scalar(level), cv::FILLED, cv::LINE_AA);
      continue;
    }
    const double turn = random.uniform(0.0, 3.14);
    std::vector<cv::Point> corners;
    const int sides = 3 + random.below(2);
    for (int k = 0; k < sides; ++k) {
      double sine = 0.0;
      double cosine = 0.0;
      sin_cos(turn + kTwoPi<double> * k / sides, sine, cosine);
      corners.emplace_back(at.x + round_to_int(size * cosine), at.y + round_to_int(size * sine));
    }
    cv::fillConvexPoly(area, corners, cv::Scalar(level), cv::LINE_AA);
  }
}

void draw_notice(cv::Mat& area, GaussianRandom& random) {
  area.setTo(225);
  static const char* const kTitles[] = {"HALL", "MAP",  "SLAM", "CAIRN",
                                        "ROOM", "TOUR", "LAB",  "EXPO"};
  label(area, kTitles[random.below(8)], {area.cols / 2, area.rows / 7}, area.cols / 6.0, 25);
  const int lines = 8;
  for (int k = 0; k < lines; ++k) {
    const int y = area.rows * (28 + 8 * k) / 100;
    int x = area.cols / 10;
    while (x < area.cols * 8 / 10) {
      const int word = area.cols / 20 + random.below(area.cols / 6);
      box(area, {x, y, std::min(word, area.cols * 9 / 10 - x), std::max(2, area.rows / 32)},
          50 + random.below(60));
      x += word + area.cols / 24;
    }
  }
}

}  // namespace

void draw_landscape(cv::Mat& area, GaussianRandom& random) {
  for (int y = 0; y < area.rows; ++y) {
    const int level = 235 - 70 * y / area.rows;
    area.row(y).setTo(level);
  }
  cv::circle(area, {area.cols / 5 + random.below(area.cols / 2), area.rows / 4}, area.rows / 9,
             cv::Scalar(252), cv::FILLED, cv::LINE_AA);
  for (int ridge = 0; ridge < 3; ++ridge) {
    const int level = 150 - 50 * ridge;
    const int base = area.rows * (4 + 2 * ridge) / 10;
    std::vector<cv::Point> outline{{0, area.rows}};
    const int peaks = 4 + random.below(3);
    for (int k = 0; k <= 2 * peaks; ++k) {
      const int lift = (k % 2 == 1 ? 1 : 0) * (area.rows / 8 + random.below(area.rows / 6));
      outline.emplace_back(area.cols * k / (2 * peaks), base - lift);
    }
    outline.emplace_back(area.cols, area.rows);
    const cv::Point* points = outline.data();
    const int count = static_cast<int>(outline.size());
    cv::fillPoly(area, &points, &count, 1, cv::Scalar(level), cv::LINE_AA);
  }
}

void draw_picture(cv::Mat& image, const cv::Rect& place, int style, GaussianRandom& random) {
  const int frame = std::max(3, std::min(place.width, place.height) / 20);
  box(image, place, random.below(2) == 0 ? 40 : 70);
  cv::Mat area =
      image({place.x + frame, place.y + frame, place.width - 2 * frame, place.height - 2 * frame});
  switch (style & 3) {
    case 0:
      draw_landscape(area, random);
      break;
    case 1:
      draw_shapes(area, random);
      break;
    case 2:
      draw_notice(area, random);
      break;
    default:
      draw_blocks(area, random);
      break;
  }
}

}  // namespace cairn::host
