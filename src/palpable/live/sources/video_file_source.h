/// @file
/// A recorded video as a source of frames: both eyes side by side, or a file for each eye.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/sources/frame_source.h"

#include <array>
#include <filesystem>
#include <memory>
#include <string_view>

namespace palpable {

struct VideoSettings {
  /// Empty: a file beside the video with its name and .yml (clip.mp4, clip.yml), or
  /// calibration.yml, rectified.yml or the one SN*.conf in its folder.
  std::filesystem::path calibration{};
  bool without_calibration = false;  ///< see FolderSettings
};

/// The endings of video files' names.
inline constexpr std::array<std::string_view, 7> kVideoEndings = {".avi",  ".mp4", ".mkv", ".mov",
                                                                  ".webm", ".m4v", ".mpg"};

/// Whether the name ends with one of kVideoEndings, in small letters or large ones.
[[nodiscard]] bool is_video_name(const std::filesystem::path& path);

/// Opens the left eye's (or both eyes') file and, if named, the right eye's; frames of the same
/// number are a pair. Frames are decoded one ahead; times are the file's own. A file that is cut
/// off or damaged ends there, after one unreadable frame that says so; frames of another size are
/// unreadable.
///
/// A problem, one line that names the file: not there, no video that can be decoded, no or a wrong
/// calibration, files of different sizes.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_video(const std::filesystem::path& left,
                                                              const std::filesystem::path& right,
                                                              const VideoSettings& settings = {});

}  // namespace palpable
