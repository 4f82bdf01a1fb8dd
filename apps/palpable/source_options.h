/// @file
/// Options that name a source of images, shared by several commands, and the request for it.
#pragma once

#include "palpable/live/sources/camera_source.h"
#include "palpable/live/sources/frame_source.h"

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace palpable::app {

class Command;

struct SourceOptions {
  std::string source;  ///< folder, images by name, video file or /dev/video*
  std::string right;
  std::string depth;    ///< a depth camera or its images; or one of kDepthSizes
  double farthest = 0;  ///< m; 0: the command's default
  std::filesystem::path calibration;
  std::string size;  ///< "2560x720"; empty: automatic choice
  double frames_per_second = 0;
  double exposure_ms = 0;  ///< 0: automatic
  double gain = -1;        ///< negative: automatic
  bool lock_exposure = false;
};

enum class SourceKind {
  kAny,
  kRawStereo,  ///< for calibration: without --depth and --calibration
};

/// The words of --depth that select the resolution of stereo matching; the first is the default.
inline constexpr std::array<std::string_view, 3> kDepthSizes = {"half", "full", "auto"};

/// The word of kDepthSizes in --depth; empty if it is none of them.
[[nodiscard]] std::string depth_size(const SourceOptions& options);

/// Applies --depth and --farthest.
/// @param depth  settings with defaults. A template, because programs include no header of depth
template <class DepthSettings>
void set_depth(const SourceOptions& options, DepthSettings& depth) {
  constexpr int kSmall = 640;  // px; "auto" matches pictures up to this width at full resolution
  const std::string size = depth_size(options);
  depth.full_resolution = size == "full";
  depth.full_up_to_px = size == "auto" ? kSmall : 0;
  if (options.farthest > 0) depth.farthest = options.farthest;
}

/// Adds all options except --source, which commands explain in their own words.
void add_source_options(Command command, SourceOptions& options,
                        SourceKind kind = SourceKind::kAny);

/// The request for open_source(). @throws Error when --size is invalid
[[nodiscard]] CameraRequest request_of(const SourceOptions& options);

/// The files and folders that the options name, which outputs must not replace. For images by
/// name, their folder.
[[nodiscard]] std::vector<std::filesystem::path> inputs_of(const SourceOptions& options);

}  // namespace palpable::app
