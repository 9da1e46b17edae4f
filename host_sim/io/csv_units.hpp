#pragma once

#include <string>
#include <vector>

#include "host_sim/io/csv_file.hpp"

namespace cairn::host {

/// A unit as headers write it, and what a value in it is multiplied by.
struct ColumnUnit {
  const char* name;
  double factor;
};

/// A quantity that a column may hold. A header names it as NAME_UNIT, `NAME (UNIT)` or
/// `NAME [UNIT]`, or as a field of a ROS message, whose unit is the first one.
struct Quantity {
  const char* column;  ///< the documented name, such as speed_mps
  std::vector<std::string> names;
  std::vector<ColumnUnit> units;
  const char* ros_field = "";  ///< end of its path in a message, such as linear.x
};

extern const Quantity kSpeed;      ///< m/s
extern const Quantity kYawRate;    ///< rad/s
extern const Quantity kSteering;   ///< rad
extern const Quantity kWheelbase;  ///< m

/// A column of a CSV file and the factor that brings its numbers to the quantity's unit.
struct QuantityColumn {
  std::size_t index = 0;
  double factor = 1.0;

  double value(const CsvReader& csv) const { return factor * csv.number(index); }
};

bool has_quantity(const CsvReader& csv, const Quantity& quantity);

/// Whether a column is named so, whatever its unit.
bool names_quantity(const CsvReader& csv, const Quantity& quantity);

/// The column of `quantity`. Throws InputError where there is none, where two hold it, or where its
/// unit is missing or unknown.
QuantityColumn find_quantity(const CsvReader& csv, const Quantity& quantity);

/// Times of a CSV file: column `t_us`, `t_s`, `t_ms`, `t_ns`, or the same of `time`, `timestamp` or
/// `stamp`. A time without a unit is one since 1970, and its size tells the unit.
class TimeColumn {
 public:
  /// Throws InputError as find_quantity().
  explicit TimeColumn(const CsvReader& csv);
  /// Of the row that `csv` is at. Throws InputError where it is no time, or has no unit and is not
  /// one of the years 2001 to 2100.
  std::int64_t t_us(const CsvReader& csv) const;

 private:
  std::size_t index_ = 0;
  double unit_us_ = 0.0;  ///< 0: by the size of the number
};

}  // namespace cairn::host
