/// @file
/// A recorded video as a source of frames: both eyes side by side, or one file per eye.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/sources/frame_source.h"
#include "palpable/live/sources/source_calibration.h"

#include <array>
#include <filesystem>
#include <memory>
#include <string_view>

namespace palpable {

struct VideoSettings {
  /// Empty: a file beside the video with its name and .yml (clip.mp4, clip.yml), or the only one of
  /// calibration.yml, rectified.yml and SN*.conf in its folder.
  std::filesystem::path calibration{};
  bool without_calibration = false;  ///< see FolderSettings
  BaselineRule baselines = BaselineRule::kUsual;
};

/// The extensions of video files.
inline constexpr std::array<std::string_view, 7> kVideoEndings = {".avi",  ".mp4", ".mkv", ".mov",
                                                                  ".webm", ".m4v", ".mpg"};

/// Whether the name ends with one of kVideoEndings, in lower or upper case.
[[nodiscard]] bool is_video_name(const std::filesystem::path& path);

/// Opens the file of the left eye (or both eyes) and, if named, of the right eye; frames of the
/// same number are a pair. Frames are decoded one ahead; times are those of the file. A
/// truncated or damaged file ends there, after one unreadable frame that reports it; frames of
/// another size are unreadable. One file has both eyes side by side if its calibration is for half
/// its width; without a calibration its aspect decides.
///
/// A problem, one line that names the file: it does not exist, is not a decodable video, has no
/// calibration or a wrong one, or the two files have different sizes.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_video(const std::filesystem::path& left,
                                                              const std::filesystem::path& right,
                                                              const VideoSettings& settings = {});

}  // namespace palpable
