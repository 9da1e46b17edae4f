#include "host_sim/io/number_text.hpp"

#include <gtest/gtest.h>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/csv_file.hpp"
#include "input_messages.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

TEST(NumberText, IsReadWhole) {
  double value = 0.0;
  EXPECT_EQ(number_problem("+1.5e3", value), "");
  EXPECT_EQ(value, 1500.0);
  for (const char* text : {"", "+", "1.5 ", "1,5", "nan", "inf", "-inf", "0x10", "++1"}) {
    EXPECT_EQ(number_problem(text, value), "a number") << text;
  }
}

TEST(NumberText, BeyondADoubleIsSaidToBeSo) {
  double value = 0.0;
  EXPECT_EQ(number_problem("1" + std::string(308, '0'), value), "");
  EXPECT_EQ(value, 1e308);
  for (const std::string& text : {std::string(309, '9'), std::string("1e400"),
                                  std::string("-1e400"), std::string("1e-400")}) {
    EXPECT_TRUE(says(number_problem(text, value), {"2.3e-308 to 1.7e308"})) << text;
  }
}

TEST(NumberText, LongRunsOfDigitsAreCut) {
  EXPECT_EQ(with_short_numbers("a.csv:3: found '" + std::string(309, '7') + "' of 12"),
            "a.csv:3: found '77777777... (309 digits)' of 12");
  const std::string stamp = "found 1403715273262142976.png";
  EXPECT_EQ(with_short_numbers(stamp), stamp);
  EXPECT_EQ(with_short_numbers(std::string(40, '1')), std::string(40, '1'));
  EXPECT_EQ(with_short_numbers(std::string(41, '1')), "11111111... (41 digits)");
  EXPECT_EQ(with_short_numbers(""), "");
}

TEST(NumberText, FilesNameWhatIsTooLarge) {
  const TemporaryFolder folder;
  const std::string large(309, '9');
  EXPECT_TRUE(says(message_of([&] {
                     CsvReader reader(folder.write("a.csv", "t_s,x\n0," + large + "\n"));
                     reader.next();
                     static_cast<void>(reader.number(1));
                   }),
                   {"a.csv:2", "x: expected a number of 2.3e-308 to 1.7e308"}));
  EXPECT_TRUE(
      says(message_of([&] {
             read_camera_file(folder.write(
                 "c.yaml", "fx: " + large + "\nfy: 1\ncx: 1\ncy: 1\nwidth: 32\nheight: 24\n"));
           }),
           {"c.yaml", "'fx'", "focal length", "2.3e-308 to 1.7e308"}));
}

}  // namespace
}  // namespace cairn::host
