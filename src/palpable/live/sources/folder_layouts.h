/// @file
/// The content of an image folder: which files form a frame, their times, the meaning of their
/// pixels, and the camera's poses if the data set has them. How to add a layout: layouts.h.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/sources/source_calibration.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// Content of the two files of a frame.
enum class ImagePair {
  kLeftRight,   ///< left and right eye
  kSideBySide,  ///< only `first`, with the left eye in its left half
  kColorDepth   ///< `second` is a depth image: of 16 bits, or in metres (OpenEXR)
};

struct RecordedFrame {
  std::filesystem::path first;
  std::filesystem::path second;  ///< empty when side by side
  std::optional<double> time;    ///< s since the first frame; empty: number / frames_per_second
  /// Pose of the left or depth camera (before rectification) according to the data set. For scores
  /// only: the frame loop does not use it.
  std::optional<Rigid3> world_from_camera;
  /// kColorDepth: an 8-bit image of the depth's size; below kLeastPhoneConfidence a depth is
  /// unknown. Empty: all depths count.
  std::filesystem::path confidence = {};
  int in_film = 0;  ///< if Recording::is_film: number of the picture in the film `first`
};

/// ARKit's confidences are 0 low, 1 medium, 2 high. Low ones lie between surfaces and on mirrors.
inline constexpr std::uint8_t kLeastPhoneConfidence = 1;

struct Recording {
  std::string layout;  ///< name of the layout in messages, e.g. "EuRoC"
  ImagePair pair = ImagePair::kLeftRight;
  std::vector<RecordedFrame> frames;
  /// A single pair *_0 and *_1 whose pictures have the aspect of two eyes: two frames side by side,
  /// unless a calibration says that such a picture is one eye's.
  bool may_be_two_frames = false;
  /// The colour pictures of all frames lie in one film, the `first` of each; in_film increases.
  bool is_film = false;
  /// The layout's calibration has the numbers of the colour camera, also where the depth image has
  /// another size.
  bool calibrates_color = false;
  /// Number of images without a partner of the same time, or without a time stamp, in layouts that
  /// match images by time.
  int unmatched = 0;
  double starts_at = 0;  ///< s, the recording's own clock where `time` is 0; 0: no own clock
  /// m per step of a depth image, if the layout defines it; the user or a calibration may override
  /// it.
  std::optional<double> depth_unit;
  /// The calibration that is part of the layout; if empty, `calibration_files` are read.
  std::optional<SourceCalibration> calibration;
  /// Why the layout's calibration cannot be used; empty if it can. One of calibration_files, or a
  /// file that the user names, is then used instead.
  std::string calibration_trouble;
  std::vector<std::filesystem::path> calibration_files;  ///< existing ones
  std::vector<std::string> notes;  ///< what was chosen or left out, one line each
};

/// Adds the colour sensor of a layout whose files do not describe it, and says so in the guesses:
/// that of 7-Scenes, if the file has the published numbers, f = 585 px and c = (320, 240), and no
/// more. Other recordings with such file names were registered by their makers. A file that has a
/// size, or a line for the colour sensor, states what there is.
void add_color_sensor(const Recording& recording, SourceCalibration& calibration);

/// Recognises, in this order:
///
///   EuRoC     mav0/cam0 and mav0/cam1 with data/ and sensor.yaml; names are nanoseconds; poses
///             from state_groundtruth_estimate0
///   KITTI     image_0 image_1, image_2 image_3 or image_l image_r, with calib.txt; times.txt and
///             poses.txt if present; rows are aligned
///   TUM       rgb.txt and depth.txt (colour and depth within 20 ms belong together, each in one
///             pair only); depth in 1/5000 m; groundtruth.txt if present; intrinsics.txt or
///             camera-intrinsics.txt, or the published numbers when the path has freiburg1, 2 or 3
///             or rgbd_bonn, the last of which counts
///   OpenLORIS color.txt and aligned_depth.txt, as TUM's; depth in mm; sensors.yaml; poses from
///             groundtruth.txt, of the robot, and trans_matrix.yaml
///   Stray Scanner  rgb.mp4 with depth/N.png (mm), confidence/N.png, camera_matrix.csv and
///             odometry.csv
///   Record3D  metadata.json with rgb/N.* and depth/N.exr (m), also within EXR_RGBD/
///   7-Scenes  frame-N.color.*, frame-N.depth.png; frame-N.pose.txt if present; depth in mm;
///             camera-intrinsics.txt or intrinsics.txt, else the published f = 585 px, c = (320,
///             240); a colour sensor of its own (add_color_sensor)
///   Palpable  left/ and right/; color_* or rgb_* with depth_*; color/ or rgb/ with depth/ and the
///             same numbers; left* and right*
///   Middlebury  the pair im0 and im1, imL and imR or view1 and view5, also among other files;
///             calib.txt (2014 and later, ETH3D) if present
///   pairs     *_0 and *_1, *_left and *_right, *_L and *_R, where all images have partners
///   else      images side by side
///
/// A problem, one line with the folder, when none fits or partners are missing.
[[nodiscard]] Result<Recording> recognise_folder(const std::filesystem::path& folder);

/// Reads EuRoC's state_groundtruth_estimate0/data.csv: (s after `begin` ns -> world_from_body) with
/// the body of its sensor.yaml. Lines that are not poses are skipped; empty without a file.
[[nodiscard]] std::map<double, Rigid3> read_euroc_poses(const std::filesystem::path& csv,
                                                        long long begin);

/// The layouts that recognise_folder() reads, as one line for messages.
[[nodiscard]] std::string_view known_layouts();

/// Images by name: each pattern is a path whose last part may contain * and ?; the matching files
/// are sorted in natural order. With an empty `second` each image has both eyes side by side.
[[nodiscard]] Result<Recording> recognise_patterns(const std::filesystem::path& first,
                                                   const std::filesystem::path& second,
                                                   bool second_is_depth);

/// Whether the name ends like that of a readable image (.png, .jpg, ...). A single image
/// is a pattern, too.
[[nodiscard]] bool is_image_name(const std::filesystem::path& path);

/// Whether the last part of the path contains * or ?.
[[nodiscard]] bool is_pattern(const std::filesystem::path& path);

}  // namespace palpable
