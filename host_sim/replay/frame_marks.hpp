#pragma once

extern "C" {
/// Bounds of a frame and of its stages in cairn_count_frames, where callgrind finds them by name.
void cairn_mark_frame_begin();
void cairn_mark_stage();
void cairn_mark_frame_end();
}

namespace cairn::host {

inline constexpr const char* kFrameBeginMark = "cairn_mark_frame_begin";
inline constexpr const char* kStageMark = "cairn_mark_stage";
inline constexpr const char* kFrameEndMark = "cairn_mark_frame_end";

}  // namespace cairn::host
