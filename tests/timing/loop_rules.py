"""What bounds each loop of the core: the capacity or count behind the limit in its head.

RULES: (file, head, bound), the first that fits holds; file and head are regular expressions, the
bound an expression over CONSTANTS and DefaultConfig's capacities. It limits how often the body runs
for each time that the loop is reached.
"""
import re

# Constants of the core that bounds refer to, and their values for DefaultConfig.
CONSTANTS = {
    "kMonoStates": "14 + 3 * (kMaxFeatures + kMaxAnchors)",  # MonoEkf::kMaxStates
    "kMaxAnchors": "kMaxFeatures // 5",
    "kVehicleStates": "3 + 3 * kMaxLandmarks",               # GroupIekfSlam, LandmarkDim 3
    "kSeedStates": "2 + 2 * kMaxKeyframes + kMaxSeeds",
    "kCellWidth": "kMaxImageWidth // 8 + 1",                 # FeatureSupply
    "kCellHeight": "kMaxImageHeight // 6 + 1",
    "kWindow": "2 * 24 + 1",                                 # SearchParameters::kMaxHalfWindow
    "kMaxPixels": "kMaxLandmarks",                           # matches of one frame
    "kMaxParts": "8", "kMaxVertices": "18", "kMaxFaces": "14", "kMaxEdges": "30", "kLensPieces": "6",
    "kMaxObjects": "8", "kMaxSamples": "128", "kMaxPlanePoints": "64", "kMaxOccupied": "192",
    "kCells": "48", "kCornersPerCell": "6", "kMaxCorners": "8", "kPatchSide": "11", "kMaxHypotheses": "64",
    "kMatrixStates": "max(kMonoStates, kVehicleStates)",     # PackedSymmetric serves both
    "kMaxNear": "48", "kPlaceSamples": "24", "kMessages": "8", "kVisible": "48", "kPlaceCorners": "144",
    # HandheldTracker: steps of 4096 comparisons, then of 24 of its 300 samples.
    "kPlaceSteps": "kLibraryLandmarks * kPlaceCorners // 4096 + 300 // kPlaceSamples + 2",
}

RULES = [
    (r".*", r"\(int \w+ = \w+; \w+ <=? " + r"(Rows|Size|N|Rank|Dim|LandmarkDim)" + r"; .*\)", "32"),
    (r"numeric/packed_symmetric", r".*", "kMatrixStates"),
    (r"geometry/pose_ransac", r".*samples.*", "kPlaceSamples"),
    (r"geometry/", r".*count.*", "kPlaceCorners"),
    (r"geometry/", r".*", "16"),
    (r"map/", r".*view_count.*", "1"),
    (r"map/", r".*(slot|size\(\)).*", "kLibraryLandmarks"),
    (r"map/exchange", r".*", "3"),
    (r"map/map_builder", r".*", "kMessages"),
    (r"map/library_matcher", r".*", "kPlaceCorners"),
    (r"map/visibility", r".*exclude.*", "kMaxLandmarks"),
    (r"map/", r".*", "kVisible"),
    (r"estimation/one_point_ransac", r".*needed.*", "kMaxHypotheses"),
    (r"estimation/one_point_ransac", r".*", "kMaxPixels"),
    (r"base/fixed_vector", r".*", "kMaxOccupied"),
    (r"mono/detail/sparse_rows", r".*rows\.size.*|.*size\[run\].*", "kMonoStates"),
    (r"mono/detail/sparse_rows", r".*(run_count|runs|other).*", "4"),
    (r"mono/detail/sparse_rows", r".*", "kMonoStates"),
    (r"mono/detail/.*", r".*anchor.*|.*MaxAnchors.*", "kMaxAnchors"),
    (r"mono/detail/.*", r".*pairs.*", "kMaxFeatures"),
    (r"mono/detail/mono_ekf_predict", r".*", "kMonoStates"),
    (r"mono/(camera_block|camera_motion|covariance_guard|fading_memory|mono_state)", r".*", "kMonoStates"),
    (r"mono/detail/.*", r".*(state_\.size|layout|elements|< n).*", "kMonoStates * (kMonoStates + 1) // 2"),
    (r"mono/", r".*", "kMaxFeatures"),
    (r"numeric/math", r".*bit.*", "32"),
    (r"numeric/positive_definite", r".*", "16"),
    (r"planar/observation/", r".*", "16"),
    (r"planar/error_model/", r".*(slot|count).*", "kMaxLandmarks"),
    (r"planar/error_model/", r".*", "kVehicleStates"),
    (r"planar/detail/landmark_slots", r".*", "kMaxLandmarks"),
    (r"planar/detail/whitened_update", r".*< count.*", "2 * kMaxLandmarks"),
    (r"planar/detail/whitened_update", r".*rank.*", "16"),
    (r"planar/detail/(planar_slam|pixel_update)", r".*j < i.*", "16"),
    (r"planar/detail/(planar_slam|pixel_update)", r".*", "2 * kMaxLandmarks"),
    (r"planar/", r".*", "kVehicleStates"),
    (r"ar/augmenter", r".*", "kMaxObjects"),
    (r"tracking/reactivation_policy", r".*", "32"),
    (r"tracking/handheld_map_reuse", r".*engine_.*", "kPlaceSteps"),
    (r"tracking/vehicle_local_map", r".*max_new_landmarks.*", "4"),
    (r"tracking/(vehicle|handheld)_local_map", r".*found.*", "kCells"),
    (r"tracking/vehicle_local_map", r".*seeds_.*", "kMaxSeeds"),
    (r"tracking/vehicle_local_map", r".*keyframes_.*", "kMaxKeyframes"),
    (r"tracking/(vehicle_|handheld_|landmark_measurement|tracked_landmarks)", r".*", "kMaxLandmarks"),
    (r"runtime/", r".*", "kMaxLandmarks"),
    (r"tracking/depth_filter", r".*", "kSeedStates"),
    (r"tracking/seed_(pool|odometry)", r".*[Kk]eyframe.*", "kMaxKeyframes"),
    (r"tracking/seed_(pool|odometry)", r".*step : steps.*", "4"),
    (r"tracking/seed_(pool|odometry)", r".*", "kMaxSeeds"),
    (r"tracking/expected_search", r".*", "kMaxNear"),
    (r"tracking/feature_supply", r".*counts_.*|.*kCells.*", "kCells"),
    (r"tracking/feature_supply", r".*fast.*", "kCornersPerCell"),
    (r"tracking/feature_supply", r".*occupied_.*", "kMaxOccupied"),
    (r"tracking/landmark_search", r".*", "kMaxLandmarks"),
    (r"tracking/planar_pose_search", r".*", "kMaxNear"),
    (r"tracking/relocaliser", r".*fast.*|.*best\[k.*", "kCornersPerCell"),
    (r"tracking/relocaliser", r".*", "kCells"),
    (r"tracking/active_search", r".*", "kMaxCorners"),
    (r"ar/plane_fit", r".*samples.*", "kMaxSamples"),
    (r"ar/plane_fit", r".*", "kMaxPlanePoints"),
    (r"ar/line_drawing", r".*", "kMaxImageWidth"),
    (r"ar/object_drawing", r".*faces.*|.*planes.*", "kMaxFaces"),
    (r"ar/object_drawing", r".*vertices.*", "kMaxVertices"),
    (r"ar/object_drawing", r".*edges\.size|.*part\.edges.*", "kMaxEdges"),
    (r"ar/object_drawing", r".*parts.*", "kMaxParts"),
    (r"ar/object_drawing", r".*piece.*", "kLensPieces * kMaxParts"),
    (r"ar/object_drawing", r".*", "kMaxOccupied"),
    (r"ar/virtual_object", r".*", "kMaxVertices"),
    (r"vision/corner_sink", r".*child.*", "8"),
    (r"vision/corner_sink", r".*", "kCells"),
    (r"vision/fast_detector", r".*rect\.y0.*", "kCellHeight + 2"),
    (r"vision/fast_detector", r".*bits.*", "32"),
    (r"vision/fast_detector", r".*x < 32.*", "32"),
    (r"vision/fast_detector", r".*", "(kCellWidth + 31) // 32 + 1"),
    (r"vision/fast_kernel", r".*", "16"),
    (r"vision/freak", r".*Bytes.*", "16"),
    (r"vision/freak", r".*", "48"),
    (r"vision/hamming", r".*", "kMaxCorners"),
    (r"vision/(vector_)?lanes", r".*height.*", "kWindow"),
    (r"vision/(vector_)?lanes", r".*", "kWindow"),
    (r"vision/(detail/)?patch", r".*bits.*|.*bit.*|.*shift.*", "64"),
    (r"vision/(detail/)?patch", r".*", "kPatchSide + 4"),
]


def capacities(root):
    """DefaultConfig's."""
    text = (root / "core/include/cairn/base/config.hpp").read_text().split("struct DefaultConfig", 1)[1]
    body = text.split("};", 1)[0]
    return {name: int(value) for name, value in re.findall(r"constexpr int (k\w+) = (\d+);", body)}


def constants(root):
    values = capacities(root)
    waiting = dict(CONSTANTS)
    while waiting:
        for name, text in list(waiting.items()):
            needed = re.findall(r"k[A-Z]\w*", text)
            if all(other in values for other in needed):
                values[name] = eval(text, {"max": max}, values)
                del waiting[name]
    return values


FIXED = re.compile(r"\(int \w+ = (\d+); \w+ (<=?) (\d+); (?:\+\+\w+|\w+ \+= \d+)\)")


def bound_of(loop):
    """Expression, or None."""
    fixed = FIXED.fullmatch(loop.head)
    if fixed:
        return str(int(fixed[3]) - int(fixed[1]) + (fixed[2] == "<="))
    for file, head, bound in RULES:
        if re.search(file, loop.file) and re.fullmatch(head, loop.head):
            return bound
    return None
