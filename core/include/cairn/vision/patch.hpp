#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

/// Grey values around a point at the time it was first seen: the reference that its later positions
/// are refined against.
struct Patch {
  static constexpr int kSize = 15;
  std::uint8_t pixels[kSize * kSize] = {};
};

/// 2x2 matrix that takes offsets in the patch to offsets in the image, Q16:
/// (dx, dy)_image = [xx xy; yx yy] (dx, dy)_patch. The default is the identity.
struct PatchWarp {
  std::int32_t xx = 1 << 16;
  std::int32_t xy = 0;
  std::int32_t yx = 0;
  std::int32_t yy = 1 << 16;
};

struct PatchAlignment {
  bool converged = false;        ///< the last step was below 1/32 px
  std::int16_t correlation = 0;  ///< zero-mean normalised, Q10: -1024..1024, at the position given
  std::int16_t shift_x_q8 = 0;   ///< from the start to where the iteration ended
  std::int16_t shift_y_q8 = 0;
  std::uint8_t iterations = 0;
};

/// A patch as it should look under one warp, ready to be aligned with any number of places or
/// images: 11x11 zero-mean values, and gradients with the part along the values and along a
/// constant taken out, so that gain and offset of the brightness do not disturb the translation.
/// Pixels that the patch does not cover are zero and not counted.
class PatchTemplate {
 public:
  /// kDegenerate when the warp turns the patch over, scales its area by less than 1/8 or more than
  /// 8, leaves less than a third of the pixels inside the patch, or when the texture is weaker than
  /// 2 grey values per pixel (rms, in its weakest direction). After it the template aligns with
  /// nothing. Cost: one pass over 169 pixels, three over 121.
  Status prepare(const Patch& patch, const PatchWarp& warp);

 private:
  friend Status align_patch(const ImageView& image, const PatchTemplate& reference, int& x_q8,
                            int& y_q8, PatchAlignment& report);

  static constexpr int kSide = 11;
  static constexpr int kPitch = 12;  // a row and a zero

  /// Sums that the passes over the pixels collect.
  struct Moments;
  /// Correlations of an image window with the template; `gain` is scaled by its energy.
  struct Response;

  bool build(const Patch& patch, const PatchWarp& warp);
  Moments differentiate(const std::int16_t* padded);
  void remove_mean(std::int32_t mean, Moments& moments);
  bool project_out_values(const Moments& moments);
  bool solve(std::int64_t xx, std::int64_t xy, std::int64_t yy);
  Response respond(const ImageView& image, int x_q8, int y_q8) const;
  bool step(const Response& response, int& dx_q8, int& dy_q8) const;
  int correlation_q10(const ImageView& image, int x_q8, int y_q8) const;

  std::int16_t value_[kSide * kPitch];
  std::int16_t gradient_x_[kSide * kPitch];
  std::int16_t gradient_y_[kSide * kPitch];
  std::uint16_t covered_[kSide];  // a bit per column
  std::int32_t count_ = 0;        // of covered pixels; 0: not usable
  std::int32_t value_sum_ = 0;    // what rounding left of the mean
  std::uint32_t energy_root_ = 0;
  std::int64_t energy_ = 0;  // sum of squared values, Q14
  // energy * inverse of the gradients' Gram matrix, Q12
  std::int64_t solve_xx_ = 0;
  std::int64_t solve_xy_ = 0;
  std::int64_t solve_yy_ = 0;
};

/// Copies the 15x15 pixels around (x_q8, y_q8), in 1/256 pixel, bilinear. kOutOfView (patch
/// unchanged) unless all of them are inside the image.
Status extract_patch(const ImageView& image, int x_q8, int y_q8, Patch& patch);

/// Moves (x_q8, y_q8), in 1/256 pixel, to where the image looks most like `reference`:
/// inverse-compositional Gauss-Newton (Baker and Matthews 2004) on the 11x11 pixels around the
/// point, for the translation, with gain and offset of the brightness projected out. Integers only:
/// same result everywhere.
///
/// The point is moved only when the iteration converged within 2 px of the start; otherwise kOk
/// with converged = false, and the correlation is that at the start. The iteration pulls in starts
/// up to about 1.5 px away.
///
/// Errors (point unchanged, report {}): kInvalidArgument for an invalid view; kDegenerate for a
/// template that could not be prepared; kOutOfView when the 11x11 pixels around the start, or
/// around a later position, leave the image. Cost: at most 8 steps over 121 pixels.
Status align_patch(const ImageView& image, const PatchTemplate& reference, int& x_q8, int& y_q8,
                   PatchAlignment& report);

/// Same, with the template prepared for this one call.
Status align_patch(const ImageView& image, const Patch& patch, const PatchWarp& warp, int& x_q8,
                   int& y_q8, PatchAlignment& report);

}  // namespace cairn
