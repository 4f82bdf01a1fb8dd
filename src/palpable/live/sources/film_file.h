/// @file
/// A film on the disk, decoded picture by picture.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/sources/film_turn.h"

#include <opencv2/videoio.hpp>

#include <filesystem>
#include <string>

namespace palpable {

/// Whether the pictures are turned as the film says (film_turn.h). The pictures of a recording with
/// depth images are not: its depth lies as the sensor does.
enum class FilmPose { kUpright, kAsFilmed };

/// Does not throw; a film that is damaged ends where it is.
struct FilmFile {
  std::filesystem::path path;
  int width = 0;                    ///< px, of the pictures as next() gives them
  int height = 0;                   ///< px
  double rate = 0;                  ///< pictures per second; 0: unknown
  int frames = -1;                  ///< as the file states; -1: unknown
  FilmTurn turn = FilmTurn::kNone;  ///< that next() applies

  /// Opens `path` and fills the numbers. Returns an empty string, or why that failed, without the
  /// file's name.
  [[nodiscard]] std::string open(FilmPose pose = FilmPose::kUpright);

  /// The next picture; false at the end, or where the film is damaged.
  bool next(ColorImage& image);

  /// Skips the next picture; false at the end.
  bool skip();

  /// s, of the last picture; 0 in files without times.
  [[nodiscard]] double time() const;

 private:
  cv::VideoCapture capture_;
  cv::Mat decoded_, turned_;
};

}  // namespace palpable
