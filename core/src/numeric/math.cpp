#include "cairn/numeric/math.hpp"

#include <cstdint>
#include <cstring>

namespace cairn {
namespace {

constexpr float kTwoOverPiF = 0.636619772367581343F;
constexpr double kTwoOverPiD = 0.63661977236758134308;
// Beyond this the reduction below has no correct bits left; the result stays finite.
constexpr double kLargestAngle = 1e6;

void place(int quadrant, double s, double c, double& sine, double& cosine) {
  switch (quadrant & 3) {
    case 0:
      sine = s;
      cosine = c;
      return;
    case 1:
      sine = c;
      cosine = -s;
      return;
    case 2:
      sine = -s;
      cosine = -c;
      return;
    default:
      sine = -c;
      cosine = s;
      return;
  }
}
void place(int quadrant, float s, float c, float& sine, float& cosine) {
  switch (quadrant & 3) {
    case 0:
      sine = s;
      cosine = c;
      return;
    case 1:
      sine = c;
      cosine = -s;
      return;
    case 2:
      sine = -s;
      cosine = -c;
      return;
    default:
      sine = -c;
      cosine = s;
      return;
  }
}

/// atan of t in [0, tan(pi/8)] by the fdlibm polynomial.
double atan_small(double t) {
  const double z = t * t;
  const double w = z * z;
  const double odd =
      z * (3.33333333333329318027e-01 +
           w * (1.42857142725034663711e-01 +
                w * (9.09088713343650656196e-02 +
                     w * (6.66107313738753120669e-02 +
                          w * (4.97687799461593236017e-02 + w * 1.62858201153657823623e-02)))));
  const double even =
      w * (-1.99999999998764832476e-01 +
           w * (-1.11111104054623557880e-01 +
                w * (-7.69187620504482999495e-02 +
                     w * (-5.83357013379057348645e-02 + w * -3.65315727442169155270e-02))));
  return t - t * (odd + even);
}

}  // namespace

void sin_cos(float angle, float& sine, float& cosine) {
  const float limit = static_cast<float>(kLargestAngle);
  if (!(angle >= -limit && angle <= limit)) {
    sine = 0.0F;
    cosine = 1.0F;
    return;
  }
  const float q = angle * kTwoOverPiF;
  const int n = static_cast<int>(q + (q < 0.0F ? -0.5F : 0.5F));
  const float k = static_cast<float>(n);
  const float r =
      ((angle - k * 1.5703125F) - k * 4.837512969970703125e-4F) - k * 7.549789948768648e-8F;
  const float z = r * r;
  const float s = r + r * z * (-1.6666654611e-1F + z * (8.3321608736e-3F + z * -1.9515295891e-4F));
  const float c =
      1.0F - 0.5F * z +
      z * z * (4.166664568298827e-2F + z * (-1.388731625493765e-3F + z * 2.443315711809948e-5F));
  place(n, s, c, sine, cosine);
}

void sin_cos(double angle, double& sine, double& cosine) {
  if (!(angle >= -kLargestAngle && angle <= kLargestAngle)) {
    sine = 0.0;
    cosine = 1.0;
    return;
  }
  const double q = angle * kTwoOverPiD;
  const int n = static_cast<int>(q + (q < 0.0 ? -0.5 : 0.5));
  const double k = static_cast<double>(n);
  const double r = ((angle - k * 1.57079632673412561417e+00) - k * 6.07710050630396597660e-11) -
                   k * 2.02226624879595063154e-21;
  const double z = r * r;
  const double s =
      r + r * z *
              (-1.66666666666666324348e-01 +
               z * (8.33333333332248946124e-03 +
                    z * (-1.98412698298579493134e-04 +
                         z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 +
                                                                z * 1.58969099521155010221e-10)))));
  const double c =
      1.0 - 0.5 * z +
      z * z *
          (4.16666666666666019037e-02 +
           z * (-1.38888888888741095749e-03 +
                z * (2.48015872894767294178e-05 +
                     z * (-2.75573143513906633035e-07 +
                          z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
  place(n, s, c, sine, cosine);
}

float atan2(float y, float x) {
  const float ax = abs(x);
  const float ay = abs(y);
  const float largest = ax > ay ? ax : ay;
  const float smallest = ax > ay ? ay : ax;
  if (largest == 0.0F) return 0.0F;
  float t = smallest / largest;
  float offset = 0.0F;
  if (t > 0.41421356237F) {
    t = (t - 1.0F) / (t + 1.0F);
    offset = 0.785398163397448F;
  }
  const float z = t * t;
  float a = offset +
            (t + t * z *
                     (-3.33329491539e-1F +
                      z * (1.99777106478e-1F + z * (-1.38776856032e-1F + z * 8.05374449538e-2F))));
  if (ay > ax) a = kHalfPi<float> - a;
  if (x < 0.0F) a = kPi<float> - a;
  return y < 0.0F ? -a : a;
}

double atan2(double y, double x) {
  const double ax = abs(x);
  const double ay = abs(y);
  const double largest = ax > ay ? ax : ay;
  const double smallest = ax > ay ? ay : ax;
  if (largest == 0.0) return 0.0;
  double t = smallest / largest;
  double offset = 0.0;
  if (t > 0.41421356237309503) {
    t = (t - 1.0) / (t + 1.0);
    offset = 0.78539816339744830962;
  }
  double a = offset + (t < 0.0 ? -atan_small(-t) : atan_small(t));
  if (ay > ax) a = kHalfPi<double> - a;
  if (x < 0.0) a = kPi<double> - a;
  return y < 0.0 ? -a : a;
}

float exp(float x) {
  if (!(x >= -87.0F)) return 0.0F;
  if (x > 88.0F) x = 88.0F;
  const float k = floor(x * 1.44269504088896341F + 0.5F);
  const float r = (x - k * 0.693359375F) - k * -2.12194440e-4F;
  float p = 1.9875691500e-4F;
  p = p * r + 1.3981999507e-3F;
  p = p * r + 8.3334519073e-3F;
  p = p * r + 4.1665795894e-2F;
  p = p * r + 1.6666665459e-1F;
  p = p * r + 5.0000001201e-1F;
  const float mantissa = p * r * r + r + 1.0F;
  const std::uint32_t bits = static_cast<std::uint32_t>(static_cast<int>(k) + 127) << 23U;
  float scale = 0.0F;
  std::memcpy(&scale, &bits, sizeof scale);
  return mantissa * scale;
}

double exp(double x) {
  if (!(x >= -708.0)) return 0.0;
  if (x > 709.0) x = 709.0;
  const double k = floor(x * 1.44269504088896338700 + 0.5);
  const double high = x - k * 6.93147180369123816490e-01;
  const double low = k * 1.90821492927058770002e-10;
  const double r = high - low;
  const double z = r * r;
  const double c =
      r - z * (1.66666666666666019037e-01 +
               z * (-2.77777777770155933842e-03 +
                    z * (6.61375632143793436117e-05 +
                         z * (-1.65339022054652515390e-06 + z * 4.13813679705723846039e-08))));
  const double mantissa = 1.0 - ((low - (r * c) / (2.0 - c)) - high);
  const std::uint64_t bits = static_cast<std::uint64_t>(static_cast<int>(k) + 1023) << 52U;
  double scale = 0.0;
  std::memcpy(&scale, &bits, sizeof scale);
  return mantissa * scale;
}

float log(float x) {
  if (!(x > 1.17549435e-38F)) x = 1.17549435e-38F;
  std::uint32_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  int exponent = static_cast<int>(bits >> 23U) - 126;
  bits = (bits & 0x007FFFFFU) | 0x3F000000U;
  float m = 0.0F;
  std::memcpy(&m, &bits, sizeof m);
  if (m < 0.707106781186547524F) {
    --exponent;
    m = m + m;
  }
  m -= 1.0F;
  const float z = m * m;
  float p = 7.0376836292e-2F;
  p = p * m - 1.1514610310e-1F;
  p = p * m + 1.1676998740e-1F;
  p = p * m - 1.2420140846e-1F;
  p = p * m + 1.4249322787e-1F;
  p = p * m - 1.6668057665e-1F;
  p = p * m + 2.0000714765e-1F;
  p = p * m - 2.4999993993e-1F;
  p = p * m + 3.3333331174e-1F;
  const float e = static_cast<float>(exponent);
  float y = m * z * p + e * -2.12194440e-4F;
  y -= 0.5F * z;
  return (m + y) + e * 0.693359375F;
}

double log(double x) {
  if (!(x > 2.2250738585072014e-308)) x = 2.2250738585072014e-308;
  std::uint64_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  int exponent = static_cast<int>(bits >> 52U) - 1022;
  bits = (bits & 0x000FFFFFFFFFFFFFULL) | 0x3FE0000000000000ULL;
  double m = 0.0;
  std::memcpy(&m, &bits, sizeof m);
  if (m < 0.70710678118654752440) {
    --exponent;
    m = m + m;
  }
  const double f = m - 1.0;
  const double s = f / (2.0 + f);
  const double z = s * s;
  const double w = z * z;
  const double even = w * (3.999999999940941908e-01 +
                           w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
  const double odd = z * (6.666666666666735130e-01 +
                          w * (2.857142874366239149e-01 +
                               w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
  const double half_square = 0.5 * f * f;
  const double e = static_cast<double>(exponent);
  return e * 6.93147180369123816490e-01 -
         ((half_square - (s * (half_square + even + odd) + e * 1.90821492927058770002e-10)) - f);
}

}  // namespace cairn
