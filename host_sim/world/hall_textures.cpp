#include "host_sim/world/hall_textures.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <opencv2/imgproc.hpp>

#include "host_sim/world/hall_pictures.hpp"

namespace cairn::host {
namespace {

void draw_window(cv::Mat& image, const cv::Rect& place, GaussianRandom& random) {
  box(image, place, 245);
  const int bar = std::max(3, place.width / 24);
  cv::Mat view =
      image({place.x + bar, place.y + bar, place.width - 2 * bar, place.height - 2 * bar});
  draw_landscape(view, random);
  box(image, {place.x + place.width / 2 - bar / 2, place.y, bar, place.height}, 245);
  box(image, {place.x, place.y + place.height / 2 - bar / 2, place.width, bar}, 245);
  box(image, {place.x - bar, place.y + place.height, place.width + 2 * bar, 2 * bar}, 215);
}

void draw_door(cv::Mat& image, const cv::Rect& place, int number) {
  box(image, {place.x - 12, place.y - 12, place.width + 24, place.height + 12}, 95);
  box(image, place, 130);
  const int inset = place.width / 8;
  for (int panel = 0; panel < 3; ++panel) {
    const cv::Rect field(place.x + inset, place.y + inset + panel * place.height / 3,
                         place.width - 2 * inset, place.height / 3 - 2 * inset);
    box(image, field, 112);
    cv::rectangle(image, field, cv::Scalar(150), 3);
  }
  cv::circle(image, {place.x + place.width * 7 / 8, place.y + place.height / 2}, 7, cv::Scalar(220),
             cv::FILLED, cv::LINE_AA);
  box(image, {place.x + place.width / 4, place.y - 62, place.width / 2, 40}, 40);
  label(image, "EXIT " + std::to_string(number), {place.x + place.width / 2, place.y - 42}, 22,
        240);
}

void draw_planks(cv::Mat& image, int count, int base, bool vertical, GaussianRandom& random) {
  const int extent = vertical ? image.cols : image.rows;
  for (int k = 0; k < count; ++k) {
    const int first = extent * k / count;
    const int last = extent * (k + 1) / count;
    const cv::Rect plank = vertical ? cv::Rect(first, 0, last - first, image.rows)
                                    : cv::Rect(0, first, image.cols, last - first);
    box(image, plank, base - 14 + random.below(28));
    cv::rectangle(image, plank, cv::Scalar(base - 60), 1);
  }
}

}  // namespace

cv::Mat paint_poster(int width_px, int height_px, GaussianRandom& random) {
  cv::Mat image(height_px, width_px, CV_8UC1, cv::Scalar(0));
  draw_picture(image, {0, 0, width_px, height_px}, random.below(4), random);
  add_mottle(image, 6, 4.0, random);
  return image;
}

cv::Mat paint_floor(int side_px, double px_per_m, GaussianRandom& random) {
  cv::Mat image(side_px, side_px, CV_8UC1, cv::Scalar(120));
  const double tile_px = 0.8 * px_per_m;
  const int tiles = static_cast<int>(side_px / tile_px);
  for (int r = 0; r < tiles; ++r) {
    for (int c = 0; c < tiles; ++c) {
      const int x = round_to_int(c * tile_px);
      const int y = round_to_int(r * tile_px);
      const int size = round_to_int(tile_px);
      box(image, {x, y, size, size}, 108 + random.below(28) + ((r + c) % 2) * 14);
      cv::rectangle(image, {x, y, size, size}, cv::Scalar(88), 2);
    }
  }
  add_mottle(image, 40, 5.0, random);
  add_mottle(image, 7, 5.0, random);
  // Scuffs and spots: no two tiles look alike.
  for (int k = 0; k < 1500; ++k) {
    const int y = random.below(side_px);
    const cv::Point at(random.below(side_px), y);
    const int level = random.below(2) == 0 ? 60 + random.below(30) : 165 + random.below(50);
    const int turn_deg = random.below(180);
    const cv::Size axes{2 + random.below(5), 1 + random.below(4)};
    cv::ellipse(image, at, axes, turn_deg, 0, 360, cv::Scalar(level), cv::FILLED, cv::LINE_AA);
  }
  return image;
}

cv::Mat paint_ceiling(int side_px, double px_per_m, GaussianRandom& random) {
  cv::Mat image(side_px, side_px, CV_8UC1, cv::Scalar(185));
  add_mottle(image, 20, 3.0, random);
  const int pitch = round_to_int(2.5 * px_per_m);
  for (int k = 0; k * pitch < side_px; ++k) {
    box(image, {k * pitch - 3, 0, 6, side_px}, 120);
    box(image, {0, k * pitch - 3, side_px, 6}, 120);
  }
  for (int r = 0; (r + 1) * pitch <= side_px; ++r) {
    for (int c = 0; (c + 1) * pitch <= side_px; ++c) {
      const cv::Point centre(c * pitch + pitch / 2, r * pitch + pitch / 2);
      const bool along = (r + c) % 2 == 0;
      const int a = pitch * 3 / 10;
      const int b = pitch / 9;
      box(image,
          {centre.x - (along ? a : b), centre.y - (along ? b : a), 2 * (along ? a : b),
           2 * (along ? b : a)},
          random.below(6) == 0 ? 150 : 250);
    }
  }
  return image;
}

cv::Mat paint_wall(double length_m, double height_m, double px_per_m, int number,
                   const std::vector<WallPicture>& pictures, GaussianRandom& random) {
  const int width = round_to_int(length_m * px_per_m);
  const int height = round_to_int(height_m * px_per_m);
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(178));
  add_mottle(image, 48, 4.0, random);
  add_mottle(image, 5, 3.5, random);
  const auto px = [&](double m) { return round_to_int(m * px_per_m); };
  const int rail = height - px(0.9);
  box(image, {0, rail, width, px(0.9)}, 112);
  for (int x = 0; x < width; x += px(0.55)) {
    cv::rectangle(image, {x + px(0.05), rail + px(0.14), px(0.45), px(0.6)},
                  cv::Scalar(92 + random.below(12)), 3);
  }
  box(image, {0, rail - px(0.03), width, px(0.07)}, 75);
  box(image, {0, height - px(0.1), width, px(0.1)}, 60);
  box(image, {0, 0, width, px(0.12)}, 205);

  int style = number;
  for (const WallPicture& picture : pictures) {
    const cv::Rect place(px(picture.left_m), height - px(picture.bottom_m + picture.height_m),
                         px(picture.width_m), px(picture.height_m));
    draw_picture(image, place, style++, random);
  }
  for (const double x : {4.1, 15.0}) {
    draw_window(image, {px(x), height - px(2.5), px(1.5), px(1.35)}, random);
  }
  draw_door(image, {px(9.5), height - px(2.1), px(1.0), px(2.1)}, number);
  label(image, std::string(1, static_cast<char>('A' + number)), {px(11.6), height - px(2.55)},
        px(0.45), 45);
  add_vertical_shade(image, 1.08, 0.88);
  return image;
}

cv::Mat paint_crate(int width_px, int height_px, int number, GaussianRandom& random) {
  cv::Mat image(height_px, width_px, CV_8UC1);
  draw_planks(image, 5, 150, false, random);
  const int rim = std::min(width_px, height_px) / 9;
  cv::rectangle(image, {rim / 2, rim / 2, width_px - rim, height_px - rim}, cv::Scalar(112), rim);
  cv::line(image, {rim, height_px - rim}, {width_px - rim, rim}, cv::Scalar(124), rim, cv::LINE_AA);
  const cv::Rect plate(width_px * 3 / 10, height_px * 3 / 10, width_px * 4 / 10,
                       height_px * 4 / 10);
  box(image, plate, 225);
  label(image, std::to_string(number), {width_px / 2, height_px / 2}, height_px * 0.22, 30);
  for (const int x : {rim / 2, width_px - rim / 2}) {
    for (const int y : {rim / 2, height_px - rim / 2}) {
      cv::circle(image, {x, y}, rim / 4, cv::Scalar(40), cv::FILLED, cv::LINE_AA);
    }
  }
  add_mottle(image, 4, 6.0, random);
  add_vertical_shade(image, 1.05, 0.85);
  return image;
}

cv::Mat paint_books(int width_px, int height_px, double px_per_m, GaussianRandom& random) {
  cv::Mat image(height_px, width_px, CV_8UC1, cv::Scalar(70));
  const int board = round_to_int(0.035 * px_per_m);
  const int shelves = std::max(2, round_to_int(height_px / (0.38 * px_per_m)));
  for (int shelf = 0; shelf < shelves; ++shelf) {
    const int top = height_px * shelf / shelves + board;
    const int bottom = height_px * (shelf + 1) / shelves;
    box(image, {0, top - board, width_px, board}, 165);
    box(image, {0, top, width_px, bottom - top}, 35);
    int x = board;
    while (x < width_px - board) {
      const int thickness =
          std::min(round_to_int(random.uniform(0.03, 0.085) * px_per_m), width_px - board - x);
      if (random.below(8) != 0) {
        const int height = (bottom - top) * (60 + random.below(36)) / 100;
        const cv::Rect book(x, bottom - height, thickness, height);
        const int level = 50 + random.below(190);
        box(image, book, level);
        const int stripe = level > 140 ? level - 100 : level + 90;
        box(image, {x, bottom - height * 4 / 5, thickness, std::max(2, height / 9)}, stripe);
        cv::rectangle(image, book, cv::Scalar(25), 1);
      }
      x += thickness;
    }
  }
  box(image, {0, 0, board, height_px}, 150);
  box(image, {width_px - board, 0, board, height_px}, 150);
  add_mottle(image, 4, 4.0, random);
  return image;
}

cv::Mat paint_cabinet(int width_px, int height_px, GaussianRandom& random) {
  cv::Mat image(height_px, width_px, CV_8UC1, cv::Scalar(140));
  const int columns = std::max(1, width_px * 2 / height_px);
  const int rows = 2 + random.below(2);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const cv::Rect drawer(width_px * c / columns + 4, height_px * r / rows + 4,
                            width_px / columns - 8, height_px / rows - 8);
      box(image, drawer, 155 + random.below(45));
      cv::rectangle(image, drawer, cv::Scalar(85), 2);
      const cv::Point knob(drawer.x + drawer.width / 2, drawer.y + drawer.height / 4);
      box(image, {knob.x - 14, knob.y - 4, 28, 8}, 40);
      if (random.below(2) == 0) {
        const cv::Rect tag(drawer.x + drawer.width / 5, drawer.y + drawer.height / 2,
                           drawer.width / 4, drawer.height / 4);
        box(image, tag, 235);
        label(image, std::to_string(10 + random.below(89)),
              {tag.x + tag.width / 2, tag.y + tag.height / 2}, tag.height * 0.55, 40);
      }
    }
  }
  add_mottle(image, 5, 4.0, random);
  add_vertical_shade(image, 1.05, 0.85);
  return image;
}

cv::Mat paint_pillar(int width_px, int height_px, int number, GaussianRandom& random) {
  cv::Mat image(height_px, width_px, CV_8UC1, cv::Scalar(168));
  const int course = width_px * 2 / 5;
  for (int r = 0; r * course < height_px; ++r) {
    const int offset = (r % 2) * width_px / 4;
    for (int c = -1; c < 3; ++c) {
      const cv::Rect stone = cv::Rect(c * width_px / 2 + offset, r * course, width_px / 2, course) &
                             cv::Rect(0, 0, width_px, height_px);
      if (stone.empty()) continue;
      box(image, stone, 150 + random.below(45));
      cv::rectangle(image, stone, cv::Scalar(110), 2);
    }
  }
  const cv::Rect sign(width_px / 10, height_px * 4 / 10, width_px * 8 / 10, width_px * 8 / 10);
  box(image, sign, 35);
  label(image, "P" + std::to_string(number), {width_px / 2, sign.y + sign.height / 2},
        sign.height * 0.4, 235);
  add_mottle(image, 5, 5.0, random);
  add_vertical_shade(image, 1.1, 0.85);
  return image;
}

cv::Mat paint_table_top(int width_px, int height_px, GaussianRandom& random) {
  cv::Mat image(height_px, width_px, CV_8UC1);
  draw_planks(image, 6, 165, true, random);
  for (int k = 0; k < 5; ++k) {
    const int top = random.below(height_px * 6 / 10);
    const cv::Rect paper(random.below(width_px * 7 / 10), top, width_px / 6, height_px / 4);
    box(image, paper, 235);
    for (int line = 0; line < 4; ++line) {
      box(image, {paper.x + 6, paper.y + 8 + line * paper.height / 5, paper.width * 3 / 4, 3}, 80);
    }
  }
  add_mottle(image, 5, 5.0, random);
  return image;
}

}  // namespace cairn::host
