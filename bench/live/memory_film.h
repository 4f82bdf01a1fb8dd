/// @file
/// A clip in memory that is played like a side-by-side camera: it returns raw pictures, and the
/// loop converts them.
#pragma once

#include "palpable/common/geometry/frame.h"
#include "palpable/live/sources/frame_source.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace palpable::app {

/// Raw pictures of both eyes side by side in YUYV: 2 bytes per pixel, rows without gaps.
struct MemoryFilm {
  FrameFormat format;  ///< of one eye
  std::vector<std::vector<std::uint8_t>> pictures;
};

/// The number and size of frames to read from a recorded clip.
struct FilmSize {
  int frames = 0;  ///< largest number
  int width = 0;   ///< px, of one eye, even; 0: as recorded
  int height = 0;  ///< px
};

/// Decodes a folder of raw stereo pairs. For another size the pictures and the calibration are
/// resampled. @throws Error when the folder is unreadable or has no raw stereo pairs
[[nodiscard]] MemoryFilm read_film(const std::filesystem::path& folder, const FilmSize& size);

/// Plays it endlessly, alternately forwards and backwards, so that there are no jumps: with time
/// stamps of 30 frames a second, as fast as the frames are read.
/// @param film       must outlive the source
/// @param converted  to colours on arrival, as for cameras that send another format
[[nodiscard]] std::unique_ptr<FrameSource> play(const MemoryFilm& film, bool converted);

}  // namespace palpable::app
