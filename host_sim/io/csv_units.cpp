#include "host_sim/io/csv_units.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr double kYear2001_s = 1e9;
constexpr double kYear2100_s = 4.1e9;

const Quantity kTime{"t_s",
                     {"t", "time", "timestamp", "stamp", "%time", "__time"},
                     {{"s", 1e6},
                      {"sec", 1e6},
                      {"seconds", 1e6},
                      {"ms", 1e3},
                      {"msec", 1e3},
                      {"us", 1.0},
                      {"usec", 1.0},
                      {"\xC2\xB5s", 1.0},
                      {"ns", 1e-3},
                      {"nsec", 1e-3},
                      {"nanosecond", 1e-3},
                      {"nanoseconds", 1e-3}}};

struct NameAndUnit {
  std::string name;
  std::string unit;  ///< empty: none
};

/// field.twist.twist.linear.x, /odom/twist/twist/linear/x and linear.x alike.
bool is_ros_field(std::string header, const std::string& field) {
  std::replace(header.begin(), header.end(), '/', '.');
  if (field.empty() || header.size() < field.size()) return false;
  const std::size_t at = header.size() - field.size();
  return header.compare(at, field.size(), field) == 0 && (at == 0 || header[at - 1] == '.');
}

/// speed_mps, speed_(m/s), speed_[m/s] and speed[m/s] alike.
NameAndUnit take_apart(const std::string& header, const Quantity& quantity) {
  if (is_ros_field(header, quantity.ros_field)) {
    return {quantity.names.front(), quantity.units.front().name};
  }
  const std::size_t bracket = header.find_first_of("([");
  if (bracket != std::string::npos) {
    const std::size_t end = std::min(header.find_first_of(")]", bracket), header.size());
    std::string name = header.substr(0, bracket);
    while (!name.empty() && name.back() == '_') name.pop_back();
    return {name, header.substr(bracket + 1, end - bracket - 1)};
  }
  for (const std::string& name : quantity.names) {
    if (header.rfind(name + "_", 0) == 0) return {name, header.substr(name.size() + 1)};
  }
  return {header, {}};
}

std::optional<double> factor_of(const std::string& unit, const Quantity& quantity) {
  for (const ColumnUnit& known : quantity.units) {
    if (unit == known.name) return known.factor;
  }
  return std::nullopt;
}

std::string units_of(const Quantity& quantity) {
  std::vector<std::string> names;
  for (const ColumnUnit& unit : quantity.units) names.emplace_back(unit.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

bool is_named(const NameAndUnit& parts, const Quantity& quantity) {
  return std::find(quantity.names.begin(), quantity.names.end(), parts.name) !=
         quantity.names.end();
}

/// The first column that is named so and whose unit is not known; -1: none.
int column_of_unknown_unit(const CsvReader& csv, const Quantity& quantity) {
  for (std::size_t i = 0; i < csv.header().size(); ++i) {
    const NameAndUnit parts = take_apart(csv.header()[i], quantity);
    if (is_named(parts, quantity) && !parts.unit.empty() && !factor_of(parts.unit, quantity)) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

/// Columns whose name is one of the quantity's and whose unit is known, or missing.
std::vector<std::size_t> columns_of(const CsvReader& csv, const Quantity& quantity) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < csv.header().size(); ++i) {
    if (csv.header()[i] == quantity.column) return {csv.column(quantity.column)};
    const NameAndUnit parts = take_apart(csv.header()[i], quantity);
    const bool known = parts.unit.empty() || factor_of(parts.unit, quantity);
    if (is_named(parts, quantity) && known) found.push_back(i);
  }
  return found;
}

std::size_t only_column(const CsvReader& csv, const Quantity& quantity) {
  const std::vector<std::size_t> found = columns_of(csv, quantity);
  if (found.size() == 1) return found.front();
  const int strange = found.empty() ? column_of_unknown_unit(csv, quantity) : -1;
  if (strange >= 0) {
    const std::string& header = csv.header()[static_cast<std::size_t>(strange)];
    throw InputError(
        csv.path(), 1,
        fmt::format("column '{}': expected one of the units {}, as in {}; found '{}'", header,
                    units_of(quantity), quantity.column, take_apart(header, quantity).unit));
  }
  if (found.empty()) {
    throw InputError(
        csv.path(), 1,
        fmt::format("expected a column '{}' (units: {}) in the header, found {}", quantity.column,
                    units_of(quantity), fmt::join(csv.header(), ", ")));
  }
  throw InputError(csv.path(), 1,
                   fmt::format("expected one column for '{}', found {} and {}", quantity.column,
                               csv.header()[found[0]], csv.header()[found[1]]));
}

}  // namespace

const Quantity kSpeed{"speed_mps",
                      {"speed", "velocity", "linear_velocity", "v"},
                      {{"mps", 1.0},
                       {"m/s", 1.0},
                       {"kmh", 1.0 / 3.6},
                       {"kph", 1.0 / 3.6},
                       {"km/h", 1.0 / 3.6},
                       {"cm/s", 1e-2},
                       {"mm/s", 1e-3},
                       {"m_s", 1.0},
                       {"km_h", 1.0 / 3.6},
                       {"mph", 0.44704},
                       {"knots", 1852.0 / 3600.0}},
                      "linear.x"};
const Quantity kYawRate{"yaw_rate_radps",
                        {"yaw_rate", "yawrate", "turn_rate", "angular_velocity", "omega"},
                        {{"radps", 1.0},
                         {"rad/s", 1.0},
                         {"degps", kDegree},
                         {"dps", kDegree},
                         {"deg/s", kDegree},
                         {"rad_s", 1.0},
                         {"deg_s", kDegree},
                         {"\xC2\xB0/s", kDegree}},
                        "angular.z"};
const Quantity kSteering{"steering_rad",
                         {"steering", "steering_angle"},
                         {{"rad", 1.0}, {"deg", kDegree}, {"\xC2\xB0", kDegree}}};
const Quantity kWheelbase{"wheelbase_m", {"wheelbase"}, {{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}}};

bool has_quantity(const CsvReader& csv, const Quantity& quantity) {
  return !columns_of(csv, quantity).empty();
}

bool names_quantity(const CsvReader& csv, const Quantity& quantity) {
  return has_quantity(csv, quantity) || column_of_unknown_unit(csv, quantity) >= 0;
}

QuantityColumn find_quantity(const CsvReader& csv, const Quantity& quantity) {
  const std::size_t index = only_column(csv, quantity);
  const std::string& header = csv.header()[index];
  const std::optional<double> factor = factor_of(take_apart(header, quantity).unit, quantity);
  if (!factor.has_value()) {
    throw InputError(csv.path(), 1,
                     fmt::format("column '{}': expected its unit in the name, as in {} (units: {})",
                                 header, quantity.column, units_of(quantity)));
  }
  return {index, *factor};
}

TimeColumn::TimeColumn(const CsvReader& csv)
    : index_(csv.has("t_us") ? csv.column("t_us") : only_column(csv, kTime)),
      unit_us_(factor_of(take_apart(csv.header()[index_], kTime).unit, kTime).value_or(0.0)) {}

std::int64_t TimeColumn::t_us(const CsvReader& csv) const {
  const double value = csv.number(index_);
  if (unit_us_ > 0.0) return parse_time_us(value, unit_us_, csv.path(), csv.line());
  for (const double unit_us : {1e6, 1e3, 1.0, 1e-3}) {
    const double t_s = 1e-6 * unit_us * value;
    if (t_s >= kYear2001_s && t_s < kYear2100_s) {
      return parse_time_us(value, unit_us, csv.path(), csv.line());
    }
  }
  csv.fail(index_, fmt::format("expected a time since 1970, or a unit in the column's name as in "
                               "t_s, t_ms, t_us or t_ns; found {}",
                               value));
}

}  // namespace cairn::host
