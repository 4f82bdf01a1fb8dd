/// @file
/// What commands that look at images share: the options that name a source, and the source itself.
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
  std::string depth;    ///< a depth camera or its images; or a word of kDepthSizes
  double farthest = 0;  ///< m; 0: what the command takes without it
  std::filesystem::path calibration;
  std::string size;  ///< "2560x720"; empty: chosen
  double frames_per_second = 0;
  double exposure_ms = 0;  ///< 0: automatic
  double gain = -1;        ///< negative: automatic
  bool lock_exposure = false;
};

enum class SourceKind {
  kAny,
  kRawStereo,  ///< to be calibrated: neither --depth nor --calibration
};

/// The words of --depth that say at which size stereo is matched, the usual one first.
inline constexpr std::array<std::string_view, 3> kDepthSizes = {"half", "full", "auto"};

/// --depth as such a word; empty where it is none.
[[nodiscard]] std::string depth_size(const SourceOptions& options);

/// What --depth and --farthest say of how depth is measured.
/// @param depth  as it is without them. A template: programs include no header of depth
template <class DepthSettings>
void set_depth(const SourceOptions& options, DepthSettings& depth) {
  constexpr int kSmall = 640;  // px; of pictures that small auto matches all of it
  const std::string size = depth_size(options);
  depth.full_resolution = size == "full";
  depth.full_up_to_px = size == "auto" ? kSmall : 0;
  if (options.farthest > 0) depth.farthest = options.farthest;
}

/// Adds all but --source, which commands explain in their own words.
void add_source_options(Command command, SourceOptions& options,
                        SourceKind kind = SourceKind::kAny);

/// The options as the library reads them. @throws Error when --size is no size
[[nodiscard]] CameraRequest request_of(const SourceOptions& options);

/// The files and folders that the options name, for guards of outputs; images by name as the folder
/// that holds them.
[[nodiscard]] std::vector<std::filesystem::path> inputs_of(const SourceOptions& options);

}  // namespace palpable::app
