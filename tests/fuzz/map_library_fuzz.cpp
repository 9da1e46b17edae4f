// The library of landmarks and its builder: messages, look-ups and descriptors in any order.
#include "cairn/map/library_matcher.hpp"
#include "cairn/map/map_builder.hpp"

#include "tracker_scene.hpp"

namespace cairn::fuzz {
namespace {

using Map = SharedMap<SmallConfig>;
using Library = Map::Library;
using Landmark = Library::Landmark;
using Matcher = LibraryMatcher<SmallConfig, 8>;

class Run {
 public:
  explicit Run(Input&) {}

  void step(Input& input) {
    const NoAllocation none;
    switch (input.below(8)) {
      case 0:
      case 1:
      case 2:
        send(input);
        break;
      case 3:
        build(input);
        break;
      case 4:
        change(input);
        break;
      case 5:
        save_and_load(input);
        break;
      case 6:
        match(input);
        break;
      case 7:
        look(input);
        break;
    }
    check(map_.exchange.front());
  }

 private:
  static LandmarkId id(Input& input) {
    return static_cast<LandmarkId>(input.below(2 * SmallConfig::kLibraryLandmarks));
  }

  static Landmark landmark(Input& input) {
    Landmark made;
    made.id = id(input);
    for (int i = 0; i < 3; ++i) made.p_map(i) = input.number(-3.0F, 3.0F);
    for (int i = 0; i < 3; ++i) made.covariance(i, i) = input.number(0.0F, 0.1F);
    made.searches = static_cast<std::uint16_t>(input.byte() > 240 ? 0xFFFFU : input.byte());
    made.sightings =
        static_cast<std::uint16_t>(input.byte() > 10 ? made.searches / 2U : input.byte());
    made.view_count = input.byte() > 10 ? std::uint8_t{1} : input.byte();
    LandmarkView<float>& view = made.views[0];
    view.descriptor.bytes[input.below(Descriptor::kBytes)] = input.byte();
    view.focal_px = input.number(50.0F, 500.0F);
    view.T_map_reference.translation.z() = input.number(-8.0F, -4.0F);
    if (input.byte() > 250) view.T_map_reference.rotation.y() = input.wild();
    view.pose.scale_index = input.byte() % 27;
    return made;
  }

  void send(Input& input) {
    Map::Message message;
    message.kind = static_cast<Map::Message::Kind>(input.below(3));
    message.id = id(input);
    if (message.kind == Map::Message::Kind::kStore) message.landmark = landmark(input);
    static_cast<void>(map_.messages.push(message));
  }

  void build(Input& input) {
    const int most = input.below(20);
    const bool reads = input.flag() && map_.exchange.acquire() != nullptr;
    const int done = builder_.run(map_, most);
    PROMISE(6, done >= 0 && done <= most);
    if (reads) map_.exchange.release();
  }

  void change(Input& input) {
    Library* const library = map_.exchange.begin_edit();
    if (library == nullptr) return;
    Health counts;
    const std::uint32_t before = library->revision();
    const Landmark changed = landmark(input);
    const Status status = input.flag()   ? library->insert(changed, counts)
                          : input.flag() ? library->update(changed)
                                         : library->record(changed.id, input.flag());
    PROMISE(3, ok(status) || library->revision() == before);
    check(*library);
    input.flag() ? map_.exchange.publish() : map_.exchange.discard();
  }

  /// Promise 8: what is saved can be loaded.
  void save_and_load(Input& input) {
    static MapBytes saved;
    saved.size = 0;
    constexpr LandmarkId kAbove = 2 * SmallConfig::kLibraryLandmarks;
    PROMISE(8, ok(builder_.save(map_, kAbove, saved.sink())));
    if (input.flag()) saved.bytes[input.word() % static_cast<unsigned>(saved.size)] ^= 1U;
    MapFileInfo info;
    static_cast<void>(builder_.load(map_, saved.source(), info));
  }

  void match(Input& input) {
    matcher_.clear();
    const int features = input.below(Matcher::kMaxFeatures + 2);
    for (int i = 0; i < features; ++i) {
      Descriptor descriptor;
      descriptor.bytes[input.below(Descriptor::kBytes)] = input.byte();
      static_cast<void>(matcher_.add_feature({input.number(0.0F, 112.0F), 1.0F}, descriptor));
    }
    LibraryMatcherOptions options;
    options.max_distance = input.byte();
    const Library& library = map_.exchange.front();
    int steps = 0;
    while (!matcher_.step(library, 1 + input.below(40), options)) ++steps;
    PROMISE(6, steps <= library.size());
    LibraryMatch matches[Matcher::kMaxFeatures];
    const int capacity = input.below(Matcher::kMaxFeatures + 1);
    const int count = matcher_.matches(options, matches, capacity);
    PROMISE(6, count >= 0 && count <= capacity);
    for (int i = 0; i < count; ++i) {
      PROMISE(6, matches[i].feature >= 0 && matches[i].feature < matcher_.feature_count());
    }
  }

  void look(Input& input) const {
    const Library& library = map_.exchange.front();
    if (library.empty()) return;
    const Landmark& seen = library[input.below(library.size())];
    Rigid<float> T_map_camera;
    for (int i = 0; i < 3; ++i) T_map_camera.translation(i) = input.number(-5.0F, 5.0F);
    if (!T_map_camera.translation.allFinite()) return;
    T_map_camera.rotation =
        rotation_exp(Vector3<float>(0.02F * input.byte(), 0.02F * input.byte(), 0.0F));
    ViewPrediction<float> prediction;
    const Status status = predict_view(test::to_float(scene_camera()), T_map_camera, seen.p_map,
                                       seen.views[0], prediction);
    if (!ok(status)) return;
    PROMISE(4, prediction.pixel.allFinite() && is_finite(prediction.scale_ratio));
    PROMISE(4, is_finite(prediction.cosine));
    PROMISE(6, prediction.pose.scale_index <= kMaxFreakScaleIndex);
  }

  static void check(const Library& library) {
    PROMISE(6, library.size() <= SmallConfig::kLibraryLandmarks);
    for (int slot = 0; slot < library.size(); ++slot) {
      PROMISE(4, library[slot].p_map.allFinite());
      PROMISE(6, library.neighbours(slot) >= 0 && library.neighbours(slot) < library.size());
      PROMISE(6, library.find(library[slot].id) == slot);
    }
  }

  Map map_;
  MapBuilder<SmallConfig> builder_;
  Matcher matcher_;
};

}  // namespace
}  // namespace cairn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn::fuzz;
  count_allocations();
  Input input(bytes, size);
  run_steps<Run>(input, 64);
  return 0;
}
