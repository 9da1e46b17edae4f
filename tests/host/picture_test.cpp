#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "host_sim/io/image_file.hpp"
#include "host_sim/io/jpeg_check.hpp"
#include "host_sim/io/picture_folder.hpp"
#include "input_messages.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

cv::Mat noise_picture(int depth = CV_8U) {
  cv::Mat image(48, 64, CV_MAKETYPE(depth, 1));
  cv::randu(image, 0, depth == CV_8U ? 255 : 4095);
  return image;
}

const std::vector<std::string>& endings() {
  static const std::vector<std::string> all = {".png", ".jpg", ".pgm", ".ppm", ".bmp"};
  return all;
}

std::filesystem::path write_picture(const TemporaryFolder& folder, const std::string& name) {
  const auto path = folder.path() / name;
  cv::Mat image = noise_picture();
  if (path.extension() == ".ppm") cv::merge(std::vector<cv::Mat>{image, image, image}, image);
  cv::imwrite(path.string(), image);
  return path;
}

TEST(ImageFile, RefusesWhatIsNotAWholeImage) {
  const TemporaryFolder folder;
  cv::Mat grey;
  for (const std::string& ending : endings()) {
    const auto path = write_picture(folder, "whole" + ending);
    EXPECT_NO_THROW(read_grey_image(path, {64, 48}, grey)) << ending;
    EXPECT_TRUE(says(message_of([&] {
                       read_grey_image(path, {32, 48}, grey);
                     }),
                     {"32x48", "found 64x48"}));
    const std::string bytes = bytes_of(path);
    for (const std::size_t kept : {bytes.size() / 2, bytes.size() - 3}) {
      const auto cut = folder.write("cut" + ending, bytes.substr(0, kept));
      EXPECT_TRUE(says(message_of([&] { read_grey_image(cut, {}, grey); }), {"cut", "cut short"}));
    }
  }
  const auto text = folder.write("text.png", "not a picture");
  EXPECT_TRUE(says(message_of([&] { read_grey_image(text, {}, grey); }), {"text.png", "decodes"}));
}

TEST(ImageFile, BytesBehindTheEndAreNotPartOfThePicture) {
  const TemporaryFolder folder;
  for (const std::string& ending : endings()) {
    const auto path = write_picture(folder, "whole" + ending);
    cv::Mat plain, padded;
    read_grey_image(path, {64, 48}, plain);
    for (const std::string& behind :
         {std::string(5000, '\0'), "trailer" + std::string(9000, 'x')}) {
      const auto longer = folder.write("longer" + ending, bytes_of(path) + behind);
      ASSERT_NO_THROW(read_grey_image(longer, {64, 48}, padded)) << ending;
      EXPECT_EQ(cv::norm(plain, padded, cv::NORM_INF), 0.0) << ending;
    }
  }
}

TEST(ImageFile, AThumbnailInsideDoesNotEndAJpeg) {
  const TemporaryFolder folder;
  const auto path = write_picture(folder, "whole.jpg");
  const std::string bytes = bytes_of(path);
  // An APP1 segment with a small JPEG's end mark in it, as cameras write thumbnails.
  const std::string thumbnail = std::string("\xFF\xE1\x00\x08", 4) +
                                "\xFF\xD8\xFF\xD9"
                                "ab";
  const std::string with = bytes.substr(0, 2) + thumbnail + bytes.substr(2);
  cv::Mat grey;
  EXPECT_NO_THROW(read_grey_image(folder.write("with.jpg", with), {64, 48}, grey));
  const auto cut = folder.write("cut.jpg", with.substr(0, with.size() / 2));
  EXPECT_TRUE(says(message_of([&] { read_grey_image(cut, {}, grey); }), {"cut short"}));
}

/// A decoder makes up what is missing.
TEST(ImageFile, RefusesAJpegWhoseDataIsDamaged) {
  set_jpeg_check(find_jpeg_damage);
  const TemporaryFolder folder;
  const auto path = write_picture(folder, "whole.jpg");
  const std::string bytes = bytes_of(path);
  const std::size_t half = bytes.size() / 2;
  cv::Mat grey;
  EXPECT_NO_THROW(read_grey_image(path, {64, 48}, grey));
  const std::string cut = bytes.substr(0, half) + "\xFF\xD9";
  std::string zeroed = bytes;
  zeroed.replace(half, 200, std::string(200, '\0'));
  for (const std::string& damaged : {cut, zeroed}) {
    const auto file = folder.write("damaged.jpg", damaged);
    EXPECT_TRUE(says(message_of([&] {
                       read_grey_image(file, {64, 48}, grey);
                     }),
                     {"damaged.jpg", "damaged", "Corrupt JPEG data"}));
    EXPECT_THROW(read_colour_image(file, {64, 48}), InputError);
  }
  // Stray bytes before the end mark, as some cameras write them.
  const std::string padded = bytes.substr(0, bytes.size() - 2) + std::string(8, '\0') + "\xFF\xD9";
  EXPECT_NO_THROW(read_grey_image(folder.write("padded.jpg", padded), {64, 48}, grey));
}

TEST(ImageFile, PicturesAsTextMayEndWithTheirLastNumber) {
  const TemporaryFolder folder;
  cv::Mat grey;
  for (const char* end : {"", "\n", "\r\n", " # end"}) {
    const std::string text = std::string("P2\n# by hand\n3 2\n255\n0 10 20\n30 40 250") + end;
    read_grey_image(folder.write("text.pgm", text), {3, 2}, grey);
    EXPECT_EQ(grey.at<std::uint8_t>(0, 1), 10) << end;
    EXPECT_EQ(grey.at<std::uint8_t>(1, 2), 250) << end;
  }
  read_grey_image(folder.write("text.ppm", "P3 1 2 255 9 9 9 200 200 200"), {1, 2}, grey);
  EXPECT_EQ(grey.at<std::uint8_t>(1, 0), 200);
  for (const char* cut : {"P2 3 2 255 0 10 20 30 40", "P2 3 2 255", "P3 1 2 255 9 9 9 200 200",
                          "P2 3 2 255 0 10 20 30 40 x"}) {
    EXPECT_TRUE(says(message_of([&] { read_grey_image(folder.write("cut.pgm", cut), {}, grey); }),
                     {"cut.pgm", "image"}))
        << cut;
  }
}

TEST(ImageFile, SizesAreCheckedBeforeDecoding) {
  const TemporaryFolder folder;
  std::string bytes = bytes_of(write_picture(folder, "small.png"));
  bytes.replace(16, 8, std::string("\x00\x00\x75\x30\x00\x00\x75\x30", 8));  // 30000x30000
  const auto path = folder.write("large.png", bytes);
  cv::Mat grey;
  EXPECT_TRUE(says(message_of([&] { read_grey_image(path, {}, grey); }),
                   {"large.png", "pixels", "30000x30000"}));
  EXPECT_TRUE(says(message_of([&] {
                     read_grey_image(folder.write("huge.pgm", "P5 99999999 99999999 255\n"), {},
                                     grey);
                   }),
                   {"huge.pgm", "pixels"}));
  EXPECT_TRUE(says(message_of([&] {
                     read_grey_image(folder.write("dark.pgm", "P5 2 2 63\n\1\2\3\4"), {}, grey);
                   }),
                   {"dark.pgm", "255", "63"}));
}

TEST(ImageFile, SixteenBitsAreShownByTheLevelsOfTheSequence) {
  const TemporaryFolder folder;
  const cv::Mat eight = noise_picture();
  std::vector<std::filesystem::path> paths;
  for (const int bits : {10, 12, 16}) {
    cv::Mat wide;
    eight.convertTo(wide, CV_16U, 1 << (bits - 8));
    const auto path = folder.path() / (std::to_string(bits) + ".png");
    cv::imwrite(path.string(), wide);
    cv::Mat grey;
    EXPECT_TRUE(says(message_of([&] {
                       read_grey_image(path, {64, 48}, grey);
                     }),
                     {"expected 8 bits", "16"}));
    read_grey_image(path, {64, 48}, grey, find_grey_levels({path}));
    cv::Mat difference;
    cv::absdiff(grey, eight, difference);
    EXPECT_LE(cv::mean(difference)[0], 2.0) << bits;
  }
}

TEST(ImageFile, AFewHotPixelsDoNotSetTheLevels) {
  const TemporaryFolder folder;
  cv::Mat wide(200, 200, CV_16U);
  cv::randu(wide, 700, 900);  // a thermal camera: a narrow band
  wide.at<std::uint16_t>(7, 7) = 65535;
  const auto path = folder.path() / "thermal.png";
  cv::imwrite(path.string(), wide);
  const GreyLevels levels = find_grey_levels({path});
  EXPECT_NEAR(levels.black, 700, 2);
  EXPECT_NEAR(levels.white, 900, 2);
}

// --- names of pictures

std::filesystem::path folder_with(const TemporaryFolder& folder,
                                  const std::vector<std::string>& names) {
  const auto path = folder.path() / "pictures";
  std::filesystem::remove_all(path);
  for (const std::string& name : names) folder.write("pictures/" + name, "x");
  return path;
}

std::vector<std::string> order(const PictureFolder& pictures) {
  std::vector<std::string> names;
  for (const NumberedFile& file : pictures.files) names.push_back(file.path.filename().string());
  return names;
}

std::vector<int> numbers(const PictureFolder& pictures) {
  std::vector<int> all;
  for (const NumberedFile& file : pictures.files) all.push_back(file.number);
  return all;
}

using Names = std::vector<std::string>;
using Numbers = std::vector<int>;
using Times = std::vector<std::int64_t>;

TEST(PictureFolder, FrameNumbersAreSortedAsNumbers) {
  const TemporaryFolder folder;
  const auto list = [&](const Names& names) { return list_pictures(folder_with(folder, names)); };
  PictureFolder found = list({"10.png", "9.png", "100.png"});
  EXPECT_EQ(order(found), (Names{"9.png", "10.png", "100.png"}));
  EXPECT_EQ(numbers(found), (Numbers{9, 10, 100}));
  EXPECT_TRUE(found.t_us.empty());
  found = list({"DSC_0003.JPG", "DSC_0001.JPG", ".DS_Store", "._DSC_0001.JPG", "notes.txt"});
  EXPECT_EQ(numbers(found), (Numbers{1, 3}));
  found = list({"IMG (2).PNG", "IMG (11).PNG"});
  EXPECT_EQ(numbers(found), (Numbers{2, 11}));
  found = list({"cam0_20240131_235959_0007.png", "cam0_20240131_235959_0010.png"});
  EXPECT_EQ(numbers(found), (Numbers{7, 10}));
  found = list({"0000000001.png", "0000000000.png"});
  EXPECT_EQ(numbers(found), (Numbers{0, 1}));
  found = list({"12345678901234.png", "12345678901236.png"});
  EXPECT_EQ(numbers(found), (Numbers{0, 2}));
  EXPECT_NE(found.note.find("12345678901234"), std::string::npos);
}

TEST(PictureFolder, NamesThatAreTimesGiveTheTimes) {
  const TemporaryFolder folder;
  const auto list = [&](const Names& names) { return list_pictures(folder_with(folder, names)); };
  PictureFolder found =
      list({"1305031103.011234.png", "1305031102.975304.png", "1305031103.5.png"});
  EXPECT_EQ(found.t_us, (Times{1305031102975304, 1305031103011234, 1305031103500000}));
  EXPECT_EQ(numbers(found), (Numbers{0, 1, 2}));
  EXPECT_EQ(list({"0.066667.png", "0.000000.png", "0.033333.png"}).t_us, (Times{0, 33333, 66667}));
  EXPECT_EQ(list({"left-1305031102.9753046.png"}).t_us, (Times{1305031102975305}));
  EXPECT_EQ(list({"cam0_1305031103.5_l.png", "cam0_1305031102.75_l.png"}).t_us,
            (Times{1305031102750000, 1305031103500000}));
  EXPECT_EQ(list({"1403636579813555456.png", "1403636579763555584.png"}).t_us,
            (Times{1403636579763556, 1403636579813555}));
  EXPECT_EQ(list({"1403636579763555.png", "1403636579813555.png"}).t_us,
            (Times{1403636579763555, 1403636579813555}));
  EXPECT_EQ(list({"1403636579763.png", "1403636579813.png"}).t_us,
            (Times{1403636579763000, 1403636579813000}));
  EXPECT_EQ(list({"1403636579.png", "1403636580.png"}).t_us,
            (Times{1403636579000000, 1403636580000000}));
  // nanoseconds and microseconds since the device was started
  EXPECT_EQ(list({"8123400000000.png", "8123433333333.png", "8123466666666.png"}).t_us,
            (Times{8123400000, 8123433333, 8123466667}));
  EXPECT_EQ(list({"100.png", "33433.png", "66766.png"}).t_us, (Times{100, 33433, 66766}));
}

TEST(PictureFolder, NamesThatCannotBeOrderedAreRefused) {
  const TemporaryFolder folder;
  const auto problem = [&](const Names& names) {
    return message_of([&] { list_pictures(folder_with(folder, names)); });
  };
  EXPECT_TRUE(says(problem({"readme.txt"}), {"pictures", "images named NUMBER"}));
  EXPECT_TRUE(
      says(problem({"desk.mp4"}), {"pictures", "images named NUMBER", "its own name", "desk.mp4"}));
  EXPECT_TRUE(says(problem({"front.png"}), {"front.png", "number"}));
  EXPECT_TRUE(says(problem({"rgb_1.png", "depth_2.png"}), {"rgb_1.png", "depth_2.png"}));
  EXPECT_TRUE(
      says(problem({"1_1.png", "1_2.png", "2_1.png"}), {"1_1.png", "1_2.png", "one number"}));
  EXPECT_TRUE(
      says(problem({"img_12.1.png", "img_12.15.png"}), {"img_12.15.png", "behind the point"}));
  const auto of_step = [](const char* format, int step_ns) {
    Names names;
    for (int i = 0; i < 40; ++i) {
      const std::int64_t t = 1305031102763555584 + std::int64_t{i} * step_ns;
      names.push_back(fmt::format(fmt::runtime(format), t / 1000000000, t % 1000000000,
                                  t % 1000000000 / 1000, static_cast<double>(t) / 1e9));
    }
    return names;
  };
  EXPECT_TRUE(says(problem(of_step("{0}.{1}.png", 33333333)), {"nanoseconds", "leading zeros"}));
  EXPECT_TRUE(says(problem(of_step("{0}.{2}.png", 50000000)), {"microseconds", "leading zeros"}));
  EXPECT_EQ(problem(of_step("{0}.{1:09}.png", 33333333)), "no error");
  EXPECT_EQ(problem(of_step("{0}.{2:06}.png", 50000000)), "no error");
  EXPECT_EQ(problem(of_step("{3}.png", 33333333)), "no error");
  EXPECT_EQ(problem(of_step("{3:.2f}.png", 100000000)), "no error");
  EXPECT_EQ(problem({"7.5.png", "7.55.png", "7.6.png", "7.65.png", "7.7.png", "7.75.png"}),
            "no error");
  EXPECT_TRUE(says(problem({"1.png", "01.png"}), {"second one", "1.png"}));
  EXPECT_TRUE(says(problem({"1.png", "1.jpg"}), {"second one"}));
  EXPECT_TRUE(says(problem({"99999999999999999999.png"}), {"64 bits", "9223372036854775807"}));
  EXPECT_TRUE(says(problem({"1.png", "2.HEIC"}), {"2.HEIC", "convert"}));
  EXPECT_TRUE(says(problem({"1.png", "3000000000.png", "3000000001.png", "3000000002.png"}),
                   {"at most 2147483647"}));
  EXPECT_TRUE(says(problem({"1.png", "5000000001.png", "10000000001.png"}), {"step by"}));
  for (const Names& dates : {Names{"IMG_20240131_235958.png", "IMG_20240131_235959.png"},
                             Names{"IMG_20240131_235959.png", "IMG_20240201_000000.png"},
                             Names{"PXL_20240131_235959123.jpg"}, Names{"20240131235959.png"},
                             Names{"2024-01-31_23-59-58.png", "2024-01-31_23-59-59.png"},
                             Names{"2024-01-31T23-59-58.000Z.png", "2024-01-31T23-59-58.033Z.png"},
                             Names{"20240131_235959.1.png", "20240131_235959.2.png"}}) {
    EXPECT_TRUE(says(problem(dates), {"date", "rename"}));
  }
}

TEST(PictureFolder, DataSetsKeepTheirPrefix) {
  const TemporaryFolder folder;
  const auto path = folder_with(folder, {"frame-000010.color.png", "frame-000009.COLOR.PNG",
                                         "frame-000009.depth.png", "frame-x.color.png"});
  const std::vector<NumberedFile> files = list_numbered_files(path, "frame-", {".color.png"});
  ASSERT_EQ(files.size(), 2U);
  EXPECT_EQ(files[0].number, 9);
  EXPECT_EQ(files[1].number, 10);
  EXPECT_TRUE(
      says(message_of([&] { list_numbered_files(path, "left", {".png"}); }), {"leftNUMBER.png"}));
}

}  // namespace
}  // namespace cairn::host
