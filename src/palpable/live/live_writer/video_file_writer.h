/// @file
/// A film that can be watched however the program ends.
///
/// While it grows it is a fragmented MP4: a head, then pieces that each hold all that is needed to
/// play them. Who kills the program keeps everything up to the last flush(), less the pictures that
/// the encoder still looks at (docs/decisions/films.md). Once it is closed in order it
/// is an ordinary MP4 with one index, which more programs play and wind.
#pragma once

#include "palpable/common/geometry/image.h"

#include <filesystem>
#include <memory>
#include <string>

namespace palpable {

/// H.264 where Debian's ffmpeg is built with an encoder of it, else MPEG-4.
class VideoFileWriter {
 public:
  /// @param width, height  of the pictures; an odd last column or row is left out of the film
  /// @param frames_per_second  > 0
  /// @throws Error naming the file when it cannot be begun
  VideoFileWriter(const std::filesystem::path& path, int width, int height,
                  double frames_per_second);
  VideoFileWriter(const VideoFileWriter&) = delete;
  VideoFileWriter& operator=(const VideoFileWriter&) = delete;
  /// Without close(): the pictures that were appended are in the file, if they can be, and it stays
  /// in fragments.
  ~VideoFileWriter();

  /// @param after  pictures' times after the one before it, at least 1; more where some were left
  ///               out, so that the film keeps its pace
  /// @throws Error when the picture cannot be encoded
  void append(const ColorImage& picture, int after = 1);
  /// Writes what the encoder has finished. @throws Error naming the file when the disk does not
  /// take it; then the film ends where it ended before
  void flush();
  /// Ends the film. @throws Error as flush()
  void close();

  /// "avc1" or "mp4v".
  [[nodiscard]] const std::string& codec() const;

 private:
  struct Film;
  std::unique_ptr<Film> film_;
};

}  // namespace palpable
