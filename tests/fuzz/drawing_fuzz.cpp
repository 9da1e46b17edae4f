// Virtual objects: their shapes, the places that are found for them, and drawings in floats and in
// integers, from any side and with any camera.
#include <vector>

#include "cairn/ar/augmenter.hpp"
#include "cairn/runtime/handheld_placement.hpp"

#include "fuzz_input.hpp"

namespace cairn::fuzz {
namespace {

constexpr int kMostWidth = 96;
constexpr int kMostHeight = 72;
constexpr int kMostPoints = 24;

Rigid<float> pose(Input& input, float far) {
  Rigid<float> at;
  const auto turn = [&] { return 0.05F * static_cast<float>(input.byte()) - 6.4F; };
  const float x = turn();
  const float y = turn();
  at.rotation = rotation_exp(Vector3<float>(x, y, turn()));
  for (int i = 0; i < 3; ++i) at.translation(i) = input.number(-far, far);
  if (input.byte() > 250) at.rotation.w() = input.wild();
  return at;
}

PinholeCamera<float> camera(Input& input) {
  PinholeCamera<float> c;
  c.width = 8 + input.below(kMostWidth - 7);
  c.height = 8 + input.below(kMostHeight - 7);
  c.fx = input.number(30.0F, 200.0F);
  c.fy = input.number(30.0F, 200.0F);
  c.cx = 0.5F * static_cast<float>(c.width);
  c.cy = 0.5F * static_cast<float>(c.height);
  if (input.flag()) c.k1 = input.number(-0.3F, 0.3F);
  const std::uint8_t lens = input.byte();
  if (lens > 200) c.p2 = input.number(-0.02F, 0.02F);
  if (lens > 240) c.lens = Lens::kFisheye;
  return c;
}

/// A picture with bytes beside its rows that nothing may touch.
class Canvas {
 public:
  Canvas(int width, int height, int beside)
      : width_(width),
        height_(height),
        stride_(width + beside),
        bytes_(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(height), kGround) {}

  MutableImageView view() { return {bytes_.data(), width_, height_, stride_}; }
  bool untouched_beside() const {
    for (int y = 0; y < height_; ++y) {
      for (int x = width_; x < stride_; ++x) {
        if (bytes_[static_cast<std::size_t>(y * stride_ + x)] != kGround) return false;
      }
    }
    return true;
  }
  bool untouched() const {
    for (const std::uint8_t byte : bytes_) {
      if (byte != kGround) return false;
    }
    return true;
  }

 private:
  static constexpr std::uint8_t kGround = 0x5A;

  int width_;
  int height_;
  int stride_;
  std::vector<std::uint8_t> bytes_;
};

DrawStyle style(Input& input) {
  DrawStyle drawn;
  drawn.line_grey = input.byte();
  if (input.byte() > 200) drawn.line_width_q8 = static_cast<int>(input.word());
  if (input.byte() > 200) drawn.halo_width_q8 = static_cast<int>(input.word());
  if (input.byte() > 240) drawn.near_m = input.wild();
  drawn.max_pixels = input.flag() ? input.between(0, 4000) : 4000;
  return drawn;
}

/// A prism or stone of a few corners, changed until it is none.
Status make_part(Input& input, ConvexPart& part) {
  constexpr int kCorners = 7;
  constexpr int kRings = 4;
  Vector2<float> corners[kCorners];
  const int count = input.below(kCorners + 1);
  for (int i = 0; i < count; ++i) {
    const float angle = kTwoPi<float> * static_cast<float>(i) / static_cast<float>(count);
    corners[i] = Vector2<float>(cos(angle), sin(angle));
    if (input.byte() > 200) corners[i].x() += input.number(-1.0F, 1.0F);
  }
  PartRing rings[kRings];
  const int levels = input.below(kRings + 1);
  for (int i = 0; i < levels; ++i) {
    rings[i].scale = input.number(0.3F, 1.0F);
    rings[i].height_m = input.byte() > 30 ? static_cast<float>(i) : input.number(0.0F, 2.0F);
    if (input.flag()) rings[i].shift_m.x() = input.number(-0.2F, 0.2F);
  }
  return make_ring_part(corners, count, rings, levels, part);
}

void make_shape(Input& input, VirtualObject& shape) {
  if (input.flag()) {
    static_cast<void>(make_cairn(input.number(0.05F, 3.0F), shape));
    return;
  }
  shape.parts.clear();
  for (int parts = 1 + input.below(3); parts > 0; --parts) {
    ConvexPart part;
    if (ok(make_part(input, part))) shape.parts.push_back(part);
  }
}

void try_objects(Input& input) {
  static Augmenter augmenter;
  const PinholeCamera<float> c = camera(input);
  if (!ok(c.validate())) return;
  Canvas canvas(c.width, c.height, input.below(5));
  const NoAllocation none;
  make_shape(input, augmenter.shape());
  Augmenter::Parameters parameters;
  parameters.style = style(input);
  augmenter.initialise(parameters);
  for (int objects = 1 + input.below(3); objects > 0; --objects) {
    PROMISE(1, ok(augmenter.place(pose(input, 1.0F))));
  }
  const Rigid<float> T_map_camera = pose(input, 4.0F);
  const int drawn = input.flag() ? augmenter.draw(c, T_map_camera, canvas.view())
                                 : augmenter.draw_in_integers(c, T_map_camera, canvas.view());
  PROMISE(6, drawn >= 0 && drawn <= augmenter.size());
  PROMISE(11, canvas.untouched_beside());
}

/// One object alone: what the report counts, and that a refusal leaves the picture.
void try_report(Input& input) {
  static VirtualObject shape;
  const PinholeCamera<float> c = camera(input);
  FixedCamera fixed;
  if (!ok(c.validate()) || !ok(fixed_of(c, fixed))) return;
  Canvas canvas(c.width, c.height, input.below(5));
  MutableImageView view = canvas.view();
  if (input.byte() > 240) view.width -= 1;
  if (input.byte() > 240) view.data = nullptr;
  const NoAllocation none;
  make_shape(input, shape);
  const DrawStyle drawn = style(input);
  const Rigid<float> object = pose(input, 2.0F);
  const Rigid<float> seen_from = pose(input, 4.0F);
  DrawReport report;
  const Status status =
      input.flag() ? draw_object(shape, object, c, seen_from, drawn, view, report)
                   : draw_object_in_integers(shape, object, fixed, seen_from, drawn, view, report);
  if (!ok(status)) PROMISE(3, canvas.untouched());
  PROMISE(6, report.edges <= VirtualObject::kMaxParts * ConvexPart::kMaxEdges);
  PROMISE(6, report.segments <= 2 * kMaxVisiblePieces * kLensPieces);
  // Halos and lines apart; the last piece of each is drawn whole.
  PROMISE(6, report.pixels <= 2 * (drawn.max_pixels + kLensPieces * c.width * c.height));
  PROMISE(11, canvas.untouched_beside());
}

void try_places(Input& input) {
  ScenePoints<kMostPoints> scene;
  const int count = input.below(kMostPoints + 1);
  const bool flat = input.flag();
  for (int i = 0; i < count; ++i) {
    const auto offset = [&] { return 0.01F * static_cast<float>(input.byte()) - 1.28F; };
    const float x = offset();
    const float y = offset();
    const float z = flat ? 3.0F + 0.2F * x : 3.0F + offset();
    scene.add({x, y, z}, z);
  }
  Rigid<float> T_map_camera;
  T_map_camera.translation.x() = 0.01F * static_cast<float>(input.byte());
  Random random(input.byte());
  Rigid<float> T_map_object;
  const NoAllocation none;
  const Vector3<float> ray(input.number(-1.0F, 1.0F), input.number(-1.0F, 1.0F), 1.0F);
  const bool found = input.flag() || !ray.allFinite()
                         ? place_on_plane(scene, T_map_camera, random, T_map_object)
                         : place_on_ray(scene, T_map_camera, ray, random, T_map_object);
  if (!found) return;
  PROMISE(4, T_map_object.rotation.coeffs().allFinite());
  PROMISE(4, abs(T_map_object.rotation.norm() - 1.0F) < 1e-2F);
}

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn::fuzz;
  count_allocations();
  Input input(bytes, size);
  switch (input.below(3)) {
    case 0:
      try_objects(input);
      break;
    case 1:
      try_report(input);
      break;
    default:
      try_places(input);
      break;
  }
  return 0;
}
