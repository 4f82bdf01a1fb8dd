/// @file
/// What lies in a folder of images: which files belong together, when they were taken, what their
/// pixels mean, and, where a data set says so, where the camera was.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/sources/source_calibration.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// What the two files of a frame hold.
enum class ImagePair {
  kLeftRight,   ///< the eyes
  kSideBySide,  ///< `first` alone, the left eye in its left half
  kColorDepth   ///< `second` has 16 bits
};

struct RecordedFrame {
  std::filesystem::path first;
  std::filesystem::path second;  ///< empty when side by side
  std::optional<double> time;    ///< s since the first frame; nothing: number / frames_per_second
  /// Pose of the left or depth camera (before rectification) by the data set. For scores only: the
  /// frame loop does not see it.
  std::optional<Rigid3> world_from_camera;
};

struct Recording {
  std::string layout;  ///< for people, e.g. "EuRoC"
  ImagePair pair = ImagePair::kLeftRight;
  std::vector<RecordedFrame> frames;
  /// In layouts that match images by time: how many have no partner of the same moment, or no time
  /// stamp of their own.
  int unmatched = 0;
  double starts_at = 0;       ///< s: the recording's own clock when `time` is 0; 0 without one
  double depth_unit = 0.001;  ///< m per step of a depth image, unless a calibration says otherwise
  /// The calibration that belongs to the layout; without one `calibration_files` are read.
  std::optional<SourceCalibration> calibration;
  /// Why the calibration that the layout brings cannot be used; empty where it can. A file among
  /// calibration_files, or one that the user names, takes its place.
  std::string calibration_trouble;
  std::vector<std::filesystem::path> calibration_files;  ///< those that exist
};

/// The colour sensor of a layout whose files do not say it: 7-Scenes, if the depth has the
/// published f = 585 px (other recordings with such file names were registered by their makers).
/// Nothing for all others: their calibration says it, or colour and depth share one view.
[[nodiscard]] std::optional<ColorSensor> color_sensor_of(const Recording& recording,
                                                         const PinholeCamera& depth_camera);

/// Recognises, in this order:
///
///   EuRoC     mav0/cam0 and mav0/cam1 with data/ and sensor.yaml; names are nanoseconds; poses
///             from state_groundtruth_estimate0
///   KITTI     image_0 image_1, image_2 image_3 or image_l image_r, with calib.txt; times.txt and
///             poses.txt if there; rows are aligned
///   TUM       rgb.txt and depth.txt (colour and depth within 20 ms belong together); depth in
///             1/5000 m; groundtruth.txt if there; intrinsics.txt, or the published numbers when
///             the folder's name has freiburg1, 2 or 3
///   7-Scenes  frame-N.color.*, frame-N.depth.png; frame-N.pose.txt if there; depth in mm;
///             camera-intrinsics.txt or intrinsics.txt, else the published f = 585 px, c = (320,
///             240); a colour sensor of its own (color_sensor_of)
///   ours      left/ and right/; color_* or rgb_* with depth_*; left* and right*
///   Middlebury  the pair im0 and im1, imL and imR or view1 and view5, whatever else lies there;
///             calib.txt (2014 and later, ETH3D) if there
///   pairs     *_0 and *_1, *_left and *_right, *_L and *_R, where all images have partners
///   else      images side by side
///
/// A problem, one line with the folder, when none fits or partners are missing.
[[nodiscard]] Result<Recording> recognise_folder(const std::filesystem::path& folder);

/// EuRoC's state_groundtruth_estimate0/data.csv: (s after `begin` ns -> world_from_body), the body
/// of its sensor.yaml. Lines that are no poses are left out; empty where no file is.
[[nodiscard]] std::map<double, Rigid3> read_euroc_poses(const std::filesystem::path& csv,
                                                        long long begin);

/// What recognise_folder() reads, for messages: one line.
[[nodiscard]] std::string_view known_layouts();

/// Images by name: each pattern is a path whose last part may contain * and ?; the matching files
/// are sorted in natural order. With `second` empty they are pairs side by side.
[[nodiscard]] Result<Recording> recognise_patterns(const std::filesystem::path& first,
                                                   const std::filesystem::path& second,
                                                   bool second_is_depth);

/// Whether a name ends like an image's that is read (.png, .jpg, ...); one image is such a pattern.
[[nodiscard]] bool is_image_name(const std::filesystem::path& path);

/// Whether a name has * or ? in its last part.
[[nodiscard]] bool is_pattern(const std::filesystem::path& path);

}  // namespace palpable
