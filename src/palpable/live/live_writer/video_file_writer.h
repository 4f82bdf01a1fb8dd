/// @file
/// A film that can be played even if the program is killed.
///
/// While it grows it is a fragmented MP4: a header, then fragments that each contain everything
/// needed to play them. A killed program leaves everything up to the last flush(), except the
/// pictures that the encoder still holds (docs/decisions/films.md). close() converts it to an
/// ordinary MP4 with one index, which more programs can play and seek in.
#pragma once

#include "palpable/common/geometry/image.h"

#include <filesystem>
#include <memory>
#include <string>

namespace palpable {

/// Encodes H.264 if FFmpeg has an encoder for it (Debian's has), else MPEG-4.
class VideoFileWriter {
 public:
  /// @param width, height  px, of the pictures; an odd last column or row is left out of the film
  /// @param frames_per_second  > 0
  /// @throws Error naming the file when it cannot be made
  VideoFileWriter(const std::filesystem::path& path, int width, int height,
                  double frames_per_second);
  VideoFileWriter(const VideoFileWriter&) = delete;
  VideoFileWriter& operator=(const VideoFileWriter&) = delete;
  /// Without close(): writes the appended pictures if possible; the file stays fragmented.
  ~VideoFileWriter();

  /// @param after  time since the previous picture, in units of the picture period, at least 1;
  ///               larger where pictures were left out, so that the film keeps its pace
  /// @throws Error when the picture cannot be encoded
  void append(const ColorImage& picture, int after = 1);
  /// Writes what the encoder has finished. @throws Error naming the file when the disk is full; the
  /// film then ends where it ended before
  void flush();
  /// Completes the film. @throws Error as flush()
  void close();

  /// "avc1" or "mp4v".
  [[nodiscard]] const std::string& codec() const;

 private:
  struct Film;
  std::unique_ptr<Film> film_;
};

}  // namespace palpable
