#include "host_sim/io/csv_file.hpp"

#include <gtest/gtest.h>

#include "host_sim/io/csv_units.hpp"
#include "input_messages.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

/// All rows of a file, as numbers.
std::vector<std::vector<double>> rows_of(const std::filesystem::path& path) {
  CsvReader csv(path);
  std::vector<std::vector<double>> rows;
  while (csv.next()) {
    rows.emplace_back();
    for (std::size_t i = 0; i < csv.header().size(); ++i) rows.back().push_back(csv.number(i));
  }
  return rows;
}

TEST(CsvReader, ReadsWhatSpreadsheetsWrite) {
  const TemporaryFolder folder;
  const std::vector<std::string> header = {"t_s", "speed_mps"};
  const std::vector<std::vector<double>> expected = {{0.5, 0.1}, {1.0, 2.0}};
  for (const char* text :
       {"# note\nt_s, speed_mps\n0.5,1e-1\r\n\n1,+2\n",
        "\xEF\xBB\xBFt_s,speed_mps\r\n0.5,0.1\r\n1,2",
        "\"t_s\",\"speed_mps\"\n\"0.5\",0.1\n1,\"2\"\n", "T_S;Speed_MPS\n0,5;0,1\n1;2,0\n",
        "t s\tspeed mps\n0,5\t0.1\n1\t2\n", "t_s speed_mps\n0.5   0.1\n 1 2 \n",
        "#t_s,speed_mps\n0.5,0.1\n1,2\n", "sep=;\nt_s;speed_mps\n0,5;0.1\n1;2\n",
        "t_s,speed_mps\r0.5,0.1\r1,2\r", "t_s,speed_mps\n0.5,0.1,\n,\n1,2,,\n"}) {
    const auto path = folder.write("a.csv", text);
    EXPECT_EQ(CsvReader(path).header(), header) << text;
    EXPECT_EQ(rows_of(path), expected) << text;
  }
}

TEST(CsvReader, NamesLineColumnAndExpectation) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    return message_of([&] { rows_of(folder.write("a.csv", text)); });
  };
  EXPECT_TRUE(says(read("a,b\n1,2\n3,x4\n"), {"a.csv:3", "b", "expected a number", "'x4'"}));
  EXPECT_TRUE(says(read("a,b\n1,nan\n"), {"a.csv:2", "b", "expected a number", "'nan'"}));
  EXPECT_TRUE(says(read("a,b\n1,\n"), {"a.csv:2", "b", "expected a number"}));
  EXPECT_TRUE(says(read("a,b\n1\n"), {"a.csv:2", "expected 2 fields", "found 1"}));
  EXPECT_TRUE(says(read("a,b\n0,5,0,1\n"), {"a.csv:2", "found 4", "decimal commas"}));
  EXPECT_TRUE(says(read("a,b\n\"1,2\n3,4\n"), {"a.csv:2", "closing quote"}));
  EXPECT_TRUE(says(read("a,b\n\"1\"2,3\n"), {"a.csv:2", "behind a closing quote"}));
  EXPECT_TRUE(says(read("1,2\n3,4\n"), {"a.csv:1", "header", "found numbers"}));
  const std::vector<std::string> above = {"timestamp_[ns]", "filename"};
  EXPECT_EQ(CsvReader(folder.write("a.csv", "#timestamp [ns],filename\n5,5.png\n")).header(),
            above);
  EXPECT_EQ(read("# a \"note\na,b\n1,2\n"), "no error");
  EXPECT_TRUE(says(read(""), {"a.csv", "header", "empty file"}));
  EXPECT_TRUE(says(read(std::string("\xFF\xFEt\0_\0", 6)), {"a.csv", "UTF-16"}));
  EXPECT_TRUE(says(read(std::string("a,b\n1,\0", 7)), {"a.csv:2", "zero byte"}));
  EXPECT_TRUE(says(read("a\n" + std::string(100000, '1')), {"a.csv:2", "65536 characters"}));
  EXPECT_TRUE(says(message_of([&] { CsvReader(folder.path() / "none.csv"); }), {"no such file"}));
  const CsvReader twice(folder.write("twice.csv", "a,b,a\n"));
  EXPECT_TRUE(says(message_of([&] { (void)twice.column("a"); }), {"twice.csv:1", "'a'", "two"}));
  EXPECT_TRUE(
      says(message_of([&] { (void)twice.column("turn"); }), {"twice.csv:1", "'turn'", "a, b, a"}));
}

TEST(CsvReader, NumbersAreFiniteAndWhole) {
  for (const char* field : {"nan", "inf", "", "1 2", "0x10", "1,", "--1"}) {
    EXPECT_THROW(parse_number(field, "f", 1, "x"), InputError) << field;
  }
  const TemporaryFolder folder;
  CsvReader csv(folder.write("a.csv", "n\n1403636579763555584\n1.5\n"));
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.integer(0), 1403636579763555584);
  ASSERT_TRUE(csv.next());
  EXPECT_TRUE(says(message_of([&] { (void)csv.integer(0); }), {"a.csv:3", "integer", "'1.5'"}));
}

TEST(CsvUnits, TheHeaderNamesTheUnit) {
  const TemporaryFolder folder;
  struct Case {
    const char* header;
    const Quantity* quantity;
    double factor;
  };
  for (const Case& c :
       {Case{"speed_mps", &kSpeed, 1.0}, Case{"Speed (km/h)", &kSpeed, 1.0 / 3.6},
        Case{"velocity [m/s]", &kSpeed, 1.0}, Case{"v_mps", &kSpeed, 1.0},
        Case{"yaw_rate_degps", &kYawRate, kDegree}, Case{"omega [rad/s]", &kYawRate, 1.0},
        Case{"steering angle (deg)", &kSteering, kDegree}, Case{"wheelbase_mm", &kWheelbase, 1e-3},
        Case{"speed_mph", &kSpeed, 0.44704}, Case{"speed_m_s", &kSpeed, 1.0},
        Case{"yaw_rate_deg_s", &kYawRate, kDegree},
        Case{"field.twist.twist.linear.x", &kSpeed, 1.0}, Case{"linear.x", &kSpeed, 1.0},
        Case{"/odom/twist/twist/angular/z", &kYawRate, 1.0}}) {
    const CsvReader csv(folder.write("a.csv", std::string("x,") + c.header + "\n"));
    const QuantityColumn found = find_quantity(csv, *c.quantity);
    EXPECT_EQ(found.index, 1U) << c.header;
    EXPECT_DOUBLE_EQ(found.factor, c.factor) << c.header;
  }
  const auto problem = [&](const char* header) {
    return message_of([&] {
      static_cast<void>(find_quantity(CsvReader(folder.write("a.csv", header)), kSpeed));
    });
  };
  EXPECT_TRUE(says(problem("speed\n"), {"a.csv:1", "'speed'", "unit", "speed_mps"}));
  EXPECT_TRUE(says(problem("speed_rpm\n"), {"a.csv:1", "'speed_rpm'", "km/h", "found 'rpm'"}));
  EXPECT_TRUE(says(problem("v_mps,speed_kmh\n"), {"a.csv:1", "v_mps and speed_kmh"}));
  EXPECT_TRUE(says(problem("speed_mps2,collinear.x\n"), {"'speed_mps2'", "found 'mps2'"}));
  EXPECT_TRUE(says(problem("a.linear.x,b.linear.x\n"), {"a.linear.x and b.linear.x"}));
}

TEST(CsvUnits, TimesOfAnyUnitBecomeMicroseconds) {
  const TemporaryFolder folder;
  const auto time = [&](const std::string& text) {
    CsvReader csv(folder.write("a.csv", text));
    const TimeColumn column(csv);
    csv.next();
    return column.t_us(csv);
  };
  EXPECT_EQ(time("t_s\n1.5\n"), 1500000);
  EXPECT_EQ(time("t_ms\n1.5\n"), 1500);
  EXPECT_EQ(time("x,time [us]\n1,1.5\n"), 2);
  EXPECT_EQ(time("t_s,t_us\n1,7\n"), 7);
  EXPECT_EQ(time("#timestamp [ns],x\n1403636579763555584,1\n"), 1403636579763556);
  EXPECT_EQ(time("Timestamp[nanosecond],x\n1403636579763555584,1\n"), 1403636579763556);
  EXPECT_EQ(time("%time,x\n1403636579763555584,1\n"), 1403636579763556);
  EXPECT_EQ(time("__time,x\n1403636579.5,1\n"), 1403636579500000);
  EXPECT_EQ(time("time_usec,x\n1500,1\n"), 1500);
  for (const char* value :
       {"1403636579.5", "1403636579500", "1403636579500000", "1403636579500000000"}) {
    EXPECT_EQ(time(std::string("timestamp\n") + value + "\n"), 1403636579500000) << value;
  }
  EXPECT_TRUE(says(message_of([&] { time("time\n0.5\n"); }), {"a.csv:2", "t_s", "t_ms"}));
  EXPECT_TRUE(says(message_of([&] { time("when\n0.5\n"); }), {"a.csv:1", "t_s", "when"}));
  EXPECT_TRUE(says(message_of([&] { time("t_s\n1e300\n"); }), {"a.csv:2", "within"}));
}

TEST(CsvReader, GivesEveryRowOfALongFile) {
  const TemporaryFolder folder;
  std::string text = "t_s,speed_mps\n";
  for (int i = 0; i < 200000; ++i) text += std::to_string(i) + ",1\n";
  CsvReader csv(folder.write("long.csv", text));
  int rows = 0;
  while (csv.next()) ++rows;
  EXPECT_EQ(rows, 200000);
  EXPECT_EQ(csv.line(), 200001);
}

}  // namespace
}  // namespace cairn::host
