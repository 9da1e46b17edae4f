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
  bool in_colour = false;  ///< gives Frame::colour too, where the pictures have 8 bits
};

/// A frame whose picture is still on disk.
struct SequenceFrame {
  std::filesystem::path image;
  Frame known;  ///< everything but the picture
};

/// Leaves the frames of the range. Throws InputError naming `where` when there are none.
void keep_range(const FrameRange& range, const std::filesystem::path& where,
                std::vector<SequenceFrame>& frames);

/// Frames from picture files, one or more, all of `frames`; pictures of 16 bits are shown by the
/// levels that they use. `info.frame_count` and `info.inputs` are completed
/// from `frames`.
std::unique_ptr<FrameSource> make_image_sequence(SourceInfo info, std::vector<SequenceFrame> frames,
                                                 bool in_colour);

/// The same for a range of them; errors as keep_range().
std::unique_ptr<FrameSource> make_image_sequence(SourceInfo info, std::vector<SequenceFrame> frames,
                                                 const FrameRange& range,
                                                 const std::filesystem::path& where);

}  // namespace cairn::host
