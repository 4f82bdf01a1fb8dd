/// @file
/// Shows what a camera delivers, to set it up: its picture, the depth and what moves, side by side.
/// There is no body and no contact.
#pragma once

#include "palpable/live/depth/depth_settings.h"
#include "palpable/live/depth/depth_survey.h"
#include "palpable/live/play/live_play.h"
#include "palpable/live/sources/camera_source.h"

#include <filesystem>
#include <string>

namespace palpable {

struct PreviewSettings {
  CameraRequest images;
  DepthSettings depth;
  bool track = true;          ///< follow the camera; else it stands still
  bool window = false;        ///< Escape or Q ends the preview
  std::filesystem::path out;  ///< folder of the film preview.mp4; empty: none
  bool overwrite = false;     ///< replace an earlier film
  /// What `images` reads (refuse_among_inputs() of base/output_file.h).
  std::vector<std::filesystem::path> inputs = {};
  int frames = -1;  ///< largest number; negative: up to the end
};

struct PreviewResult {
  int frames = 0;
  int unreadable = 0;
  double known = 0;  ///< mean share of pixels with a depth
  double frames_per_second = 0;
  DepthFigures depth;
  std::filesystem::path film;  ///< empty: none
};

/// Plays the source until it or the user ends.
/// @throws Error when the source cannot be opened or gives no frame, when a stereo pair does not
/// fit its calibration, and when the window or the film cannot be made
[[nodiscard]] PreviewResult preview(const PreviewSettings& settings, const PlayUser& user);

/// A summary in readable lines.
[[nodiscard]] std::string text_of(const PreviewResult& result);
/// {"frames", "unreadable", "known_share", "median_m", "frames_per_s", "film"}; film null without
/// one, median_m null without a depth.
[[nodiscard]] Json json_of(const PreviewResult& result);

}  // namespace palpable
