/// @file
/// How a film is to be turned before it is shown. A phone that is held upright films on its side
/// and notes that in the file; FFmpeg's and OpenCV's versions disagree about the direction, so that
/// the note is read here.
#pragma once

#include <filesystem>
#include <string_view>

namespace palpable {

enum class FilmTurn { kNone, kClockwise, kHalf, kCounterclockwise };

/// The turn that an MP4 or MOV file states for its first video track, in the matrix of its track
/// header (tkhd, ISO/IEC 14496-12). kNone for other files, for damaged ones, and for a matrix that
/// is no turn by a multiple of 90 degrees (mirrors, stretches). Reads the headers of boxes only.
[[nodiscard]] FilmTurn turn_of_film(const std::filesystem::path& path);

/// "90 degrees clockwise", for messages.
[[nodiscard]] std::string_view turn_text(FilmTurn turn);

}  // namespace palpable
