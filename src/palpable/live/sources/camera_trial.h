/// @file
/// A short look at what a camera really sends.
#pragma once

#include "palpable/live/sources/camera_list.h"
#include "palpable/live/sources/video_system.h"

#include <string>
#include <vector>

namespace palpable {

struct CameraTrial {
  std::string
      trouble;     ///< why the camera does not start, or sends nothing; empty: it sends pictures
  int width = 0;   ///< px, of the whole picture
  int height = 0;  ///< px
  std::string format;         ///< four letters
  int pictures = 0;           ///< that could be used
  int unusable = 0;           ///< damaged, too short, or of an impossible time
  std::string last_unusable;  ///< why the last of them was unusable
  std::vector<std::string>
      notes;  ///< V4l2Camera::take_notes(): a rate far below the one that was set
};

/// Opens a camera in the mode that open_camera() would take for it alone, and reads its pictures.
/// @param camera   of list_cameras(), without trouble and not kUnreadable
/// @param seconds  how long
[[nodiscard]] CameraTrial try_camera(VideoSystem& system, const ListedCamera& camera,
                                     double seconds);

/// What is wrong with a trial, and what to do; empty if nothing is.
[[nodiscard]] std::string what_is_wrong_with(const CameraTrial& trial);

}  // namespace palpable
