/// @file
/// The layouts of folders that recognise_folder() knows, a file for each: layout_NAME.cpp; and what
/// they have in common. Only those files and folder_layouts.cpp include this header.
///
/// To add the layout of a data set:
///
///   1. Write layout_NAME.cpp with one function, as below. It returns nothing unless the folder is
///      of this layout, which it decides by files or folders that no other layout has. Otherwise it
///      fills a Recording: the files of each frame (pair_up() joins two sides that are sorted
///      alike), if the data set has them also times and poses, and the calibration. A folder of
///      this layout in which something is wrong gives a Problem that names the file and the remedy.
///      layout_seven_scenes.cpp is a short example, layout_euroc.cpp has everything.
///   2. Declare the function here, and put it into kLayouts in folder_layouts.cpp: the first layout
///      that recognises a folder reads it.
///      A calibration in a format of its own is read there, too; one that users also name with
///      --calibration belongs in source_calibration.h. Published poses that `palpable score
///      --poses` shall read belong in desk/clip_files/camera_paths.h. CMake finds the file by
///      itself.
///   3. List it in the comment of recognise_folder(), in known_layouts(), and in
///      docs/recordings.md; test it in folder_layouts_test.cpp.
#pragma once

#include "palpable/live/sources/folder_layouts.h"

#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable::layouts {

/// Nothing if the folder is not of the layout; else its recording, or what is wrong with it.
using Recognised = std::optional<Result<Recording>>;

Recognised euroc(const std::filesystem::path& folder);
Recognised kitti(const std::filesystem::path& folder);
Recognised tum(const std::filesystem::path& folder);
Recognised openloris(const std::filesystem::path& folder);
Recognised stray(const std::filesystem::path& folder);
Recognised record3d(const std::filesystem::path& folder);
/// What a message says about a .r3d file, packed or unpacked.
inline constexpr std::string_view kPackedRecord3d =
    "is a recording of Record3D whose depth is packed by Apple's LZFSE, which is not read; export "
    "the recording in the app as EXR + RGB";
Recognised seven_scenes(const std::filesystem::path& folder);
/// Palpable's own: left/ and right/; color_* or rgb_* with depth_*, also as folders; left* and
/// right*.
Recognised palpable_pairs(const std::filesystem::path& folder);
Recognised middlebury(const std::filesystem::path& folder);
/// *_0 and *_1, *_left and *_right, *_L and *_R.
Recognised ended_pairs(const std::filesystem::path& folder);

/// The images directly in `folder` that match the pattern, in natural order. Depth in OpenEXR files
/// is meant by a pattern that ends with .exr only.
[[nodiscard]] std::vector<std::filesystem::path> images_in(const std::filesystem::path& folder,
                                                           std::string_view pattern = "*");

[[nodiscard]] bool is_there(const std::filesystem::path& path);
[[nodiscard]] bool is_folder(const std::filesystem::path& path);

/// read_lines(); empty if the file cannot be read.
[[nodiscard]] std::vector<std::string> lines_in(const std::filesystem::path& path);

/// The images of the left or the right eye, or of colour or depth.
struct Side {
  std::vector<std::filesystem::path> images;
  std::string_view name;  ///< for messages, e.g. "left"
};

/// Pairs the images of two sides by their index. A problem when one has no partner.
/// @param folder  for messages
[[nodiscard]] Result<Recording> pair_up(const std::filesystem::path& folder, std::string layout,
                                        ImagePair pair, const Side& first, const Side& second);

/// Colour and depth of two lists in TUM's format, `stamp file` in each line, s: pairs of images
/// less than kSameMoment apart, each of them in one pair; with the poses of groundtruth.txt. A
/// problem when stamps are no seconds.
/// @param color_list, depth_list  names in `folder`
[[nodiscard]] Result<Recording> stamped_pairs(const std::filesystem::path& folder,
                                              std::string layout, const char* color_list,
                                              const char* depth_list);

/// The files directly in `folder` whose name is a whole number and `ending` (".exr"), by number.
[[nodiscard]] std::map<long long, std::filesystem::path> numbered_files(
    const std::filesystem::path& folder, std::string_view ending);

/// The pinhole camera of one frame.
struct FrameLens {
  double fx, fy, cx, cy;  ///< px
};
/// The medians of fx, fy, cx and cy of all frames, for lenses that focus while they film. A note
/// says by how much f changes where that is more than 0.2 %.
/// @param lenses  at least one
[[nodiscard]] FrameLens median_lens(const std::vector<FrameLens>& lenses, std::string_view file,
                                    std::vector<std::string>& notes);

/// A calibration of colour and depth with these numbers of the colour camera and no size.
[[nodiscard]] SourceCalibration lens_calibration(const FrameLens& lens, std::string file);

/// A pose from its position (m) and quaternion, which need not be normalised.
[[nodiscard]] Rigid3 pose_of(const Eigen::Vector3d& position, double qw, double qx, double qy,
                             double qz);

/// A pose from 12 or 16 numbers in row order; nothing for another count.
[[nodiscard]] std::optional<Rigid3> pose_of(const std::vector<double>& n);

inline constexpr double kSameMoment = 0.02;  ///< s, the limit of TUM's own tool

/// The entry nearest to `time`, if it is within kSameMoment; else null.
template <class T>
[[nodiscard]] const T* nearest(const std::map<double, T>& entries, double time) {
  const auto after = entries.lower_bound(time);
  const T* best = nullptr;
  double distance = kSameMoment;
  for (auto it : {after, after == entries.begin() ? after : std::prev(after)}) {
    if (it == entries.end() || std::abs(it->first - time) > distance) continue;
    distance = std::abs(it->first - time);
    best = &it->second;
  }
  return best;
}

}  // namespace palpable::layouts
