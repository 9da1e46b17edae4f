#pragma once

#include <string>
#include <string_view>

namespace cairn::host {

/// What libjpeg finds damaged in the data of a JPEG, in its words; empty where nothing is. A
/// decoder goes on behind such damage and makes the rest of the picture up. Stray bytes between
/// segments, which some cameras write, are no damage. Decodes the picture once.
std::string find_jpeg_damage(std::string_view bytes);

}  // namespace cairn::host
