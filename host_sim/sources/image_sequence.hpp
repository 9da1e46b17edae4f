#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

/// Which part of a source to use, by the source's own frame numbers.
struct FrameRange {
  std::optional<int> first;
  std::optional<int> count;
};

/// A frame whose picture is still on disk.
struct SequenceFrame {
  std::filesystem::path image;
  Frame known;  ///< everything but the picture
};

/// Frames from picture files. `info.frame_count` and `info.inputs` are completed from `frames`.
/// Throws InputError naming `where` when the range leaves nothing.
std::unique_ptr<FrameSource> make_image_sequence(SourceInfo info, std::vector<SequenceFrame> frames,
                                                 const FrameRange& range,
                                                 const std::filesystem::path& where);

}  // namespace cairn::host
