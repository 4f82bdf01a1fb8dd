/// @file
/// A film in fragments, made an ordinary MP4.
#pragma once

#include <filesystem>

namespace palpable {

/// Replaces a finished film in fragments by an ordinary MP4 of the same packets: a copy is made
/// beside it, ending in ".part", and takes its name when it is whole. Costs the film's size on the
/// disk for that time.
/// @return false where that cannot be done, for lack of room for instance; the film is as it was
bool make_ordinary_mp4(const std::filesystem::path& film);

}  // namespace palpable
