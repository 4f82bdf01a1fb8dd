/// @file
/// A film in memory that plays as a side-by-side camera would: raw pictures in, whose conversion is
/// the loop's work.
#pragma once

#include "palpable/common/geometry/frame.h"
#include "palpable/live/sources/frame_source.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace palpable::app {

/// Raw pictures of both eyes side by side, YUYV: 2 bytes a pixel, rows without gaps.
struct MemoryFilm {
  FrameFormat format;  ///< of one eye
  std::vector<std::vector<std::uint8_t>> pictures;
};

/// Which frames of a recorded film, and how large.
struct FilmSize {
  int frames = 0;  ///< at most
  int width = 0;   ///< px of one eye, even; 0: as recorded
  int height = 0;  ///< px
};

/// Decodes a folder of raw stereo pairs. Of another size pictures are resampled, and the
/// calibration with them. @throws Error when it cannot be read or is no raw stereo
[[nodiscard]] MemoryFilm read_film(const std::filesystem::path& folder, const FilmSize& size);

/// Plays it without an end, forwards and backwards in turn, so that nothing jumps: 30 frames a
/// second by their times, as fast as they are taken.
/// @param film       must outlive the source
/// @param converted  to colours on arrival, as pictures of cameras are that send another format
[[nodiscard]] std::unique_ptr<FrameSource> play(const MemoryFilm& film, bool converted);

}  // namespace palpable::app
