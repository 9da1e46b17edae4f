#include "host_sim/world/drive.hpp"

#include <cmath>

#include "cairn/numeric/math.hpp"

namespace cairn::host {
namespace {

constexpr double kStep = 1e-3;

Vector2<double> rotated(const Vector2<double>& p, int quarters) {
  switch (quarters & 3) {
    case 0:
      return p;
    case 1:
      return {-p.y(), p.x()};
    case 2:
      return -p;
    default:
      return {p.y(), -p.x()};
  }
}

}  // namespace

Rigid<double> to_rigid(const PlanarPose& pose) {
  return {rotation_exp(Vector3<double>(0.0, 0.0, wrap_angle(pose.theta_rad))),
          Vector3<double>(pose.x_m, pose.y_m, 0.0)};
}

LapDrive::LapDrive(const Shape& shape)
    : shape_(shape), quarter_length_m_(0.25 * shape.lap_length_m) {
  const double corner_m = kHalfPi<double> * shape.corner_radius_m + shape.ramp_length_m;
  straight_half_m_ = 0.5 * (quarter_length_m_ - corner_m);
  const int count = static_cast<int>(std::ceil(quarter_length_m_ / kStep)) + 2;
  knots_.reserve(count);
  knots_.push_back(Vector2<double>::Zero());
  for (int i = 1; i < count; ++i) {
    double sine = 0.0;
    double cosine = 0.0;
    sin_cos(heading_in_quarter((i - 0.5) * kStep), sine, cosine);
    knots_.push_back(knots_.back() + kStep * Vector2<double>(cosine, sine));
  }
  // The quarters are the same curve turned by 90 degrees, so they close about a centre c with
  // end - c = R (start - c).
  const double fraction = quarter_length_m_ / kStep;
  const int whole = static_cast<int>(fraction);
  const Vector2<double> end =
      knots_[whole] + (fraction - whole) * (knots_[whole + 1] - knots_[whole]);
  centre_ = 0.5 * Vector2<double>(end.x() - end.y(), end.x() + end.y());
}

double LapDrive::heading_in_quarter(double s_m) const {
  const double ramp = shape_.ramp_length_m;
  const double curvature = 1.0 / shape_.corner_radius_m;
  const double plateau = kHalfPi<double> * shape_.corner_radius_m - ramp;
  double s = s_m - straight_half_m_;
  if (s <= 0.0) return 0.0;
  if (s <= ramp) return 0.5 * curvature * s * s / ramp;
  s -= ramp;
  if (s <= plateau) return curvature * (0.5 * ramp + s);
  s -= plateau;
  if (s <= ramp) return curvature * (0.5 * ramp + plateau + s - 0.5 * s * s / ramp);
  return kHalfPi<double>;
}

PlanarPose LapDrive::pose_at_distance(double s_m) const {
  const double quarters = std::floor(s_m / quarter_length_m_);
  const double s = s_m - quarters * quarter_length_m_;
  const double fraction = s / kStep;
  const int whole = static_cast<int>(fraction);
  const Vector2<double> local =
      knots_[whole] + (fraction - whole) * (knots_[whole + 1] - knots_[whole]) - centre_;
  const Vector2<double> p = rotated(local, static_cast<int>(std::fmod(quarters, 4.0)));
  return {p.x(), p.y(), heading_in_quarter(s) + quarters * kHalfPi<double>};
}

}  // namespace cairn::host
