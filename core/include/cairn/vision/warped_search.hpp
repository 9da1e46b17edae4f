#pragma once

#include "cairn/vision/patch.hpp"
#include "cairn/vision/template_search.hpp"

namespace cairn {

/// find_template() for a template that another camera saw: the image about (x_q8, y_q8), 1/256
/// pixel, is resampled, bilinear, as that camera would see it, and the template is sought there
/// within `radius`. `warp`: from offsets in the template to offsets in the image. `match` is in the
/// image. Integers only. kNotFound also where the best place is outside the image, and where an
/// entry of the warp is beyond +-4. Domain: valid image, 1 <= radius <= kMaxWarpedRadius. Cost:
/// that of find_template(), and (2 radius + 11)^2 pixels resampled.
inline constexpr int kMaxWarpedRadius = 5;
Status find_warped_template(const ImageView& image, const SmallTemplate& reference,
                            const PatchWarp& warp, int x_q8, int y_q8, int radius, int least_q15,
                            TemplateMatch& match);

/// The same by every second place and every second pixel, then the places within 2 of the best:
/// where many templates are sought and some may be missed. Domain: 2 <= radius <= kMaxSearchRadius;
/// an odd one counts as the next even one. Cost: (radius + 2)^2 products of 36 pixels, (radius +
/// 7)^2 pixels resampled, and find_warped_template() with a radius of 2.
Status find_warped_template_widely(const ImageView& image, const SmallTemplate& reference,
                                   const PatchWarp& warp, int x_q8, int y_q8, int radius,
                                   int least_q15, TemplateMatch& match);

}  // namespace cairn
