/// @file
/// Conversion of a fragmented MP4 to an ordinary one.
#pragma once

#include <filesystem>

namespace palpable {

/// Replaces a finished fragmented MP4 by an ordinary MP4 of the same packets. The new file is
/// written beside it with the suffix ".part" and renamed when it is complete, so that the disk must
/// have room for both.
/// @return false where that fails, e.g. for lack of room; the film is then unchanged
bool make_ordinary_mp4(const std::filesystem::path& film);

}  // namespace palpable
