/// @file
/// The images of a clip, of its truth and of a run's results, one file per frame in a folder:
/// FOLDER/000000.png, FOLDER/000001.png and so on.
///
///     frames/left, frames/right    pictures of a clip: JPEG of quality 96
///     depth/                       of a truth and of a result: depth as 16-bit PNG
///     body_depth/                  of a result: depth as 16-bit PNG
///     visible/, moving/            masks of a result: 8-bit PNG
///     labels/                      of a truth: 8-bit PNG
#pragma once

#include "palpable/common/geometry/image.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// The file name of a frame, such as "000007.png". @param ending  with its dot
[[nodiscard]] std::string frame_name(int frame, std::string_view ending);

/// The largest frame number among the folder's files plus one; 0 if there is no such folder.
[[nodiscard]] int frames_in(const std::filesystem::path& folder);

/// Checks that the files of a folder are named as frame_name() names them; otherwise all its frames
/// would silently count as missing. An empty folder passes: a run that found nothing writes one.
/// @throws Error naming the folder and one of its files when no file has such a name
void expect_frames_in(const std::filesystem::path& folder, std::string_view ending);

inline constexpr double kDepthUnit = 0.00025;   ///< m per count of depth/
inline constexpr double kBodyDepthUnit = 1e-4;  ///< m per count of body_depth/

/// Z / kDepthUnit, rounded in single precision; kNoDepth where the depth is unknown or does
/// not fit in a count, kTooClose where `too_close` is set.
/// @param too_close  of the same size, or empty
[[nodiscard]] DepthCounts measured_counts(const DepthImage& depth, const MaskImage& too_close);

/// Z / kDepthUnit, rounded in double precision; kNoDepth as above. It differs by 1 from
/// measured_counts() in the rare pixels where Z lies halfway between two counts.
[[nodiscard]] DepthCounts true_counts(const DepthImage& depth);

/// The depth of the drawn body at half size: the mean of the known pixels of each block of 2 x 2,
/// or kNoDepth where fewer than two of them are known.
[[nodiscard]] DepthCounts body_counts(const DepthImage& full_size);

/// Writes an image of depth/ of a result. @throws Error when the file cannot be written, as the
/// other writers do
/// @return the share of the pixels that have a depth in the file: one beyond 16.4 m has none
double write_measured_depth(const std::filesystem::path& path, const DepthImage& depth,
                            const MaskImage& too_close);
/// Writes an image of depth/ of a truth.
void write_true_depth(const std::filesystem::path& path, const DepthImage& depth);
/// Writes an image of body_depth/ of a result. @param full_size  twice as wide and high as the file
void write_body_depth(const std::filesystem::path& path, const DepthImage& full_size);

/// Nothing when there is no such file. @throws Error naming the file when it cannot be read
[[nodiscard]] std::optional<DepthCounts> read_depth_counts(const std::filesystem::path& path);

/// Depth in m; NaN for kNoDepth. @param unit  m per count
[[nodiscard]] DepthImage depth_of(const DepthCounts& counts, double unit);

/// Writes an image of visible/ or moving/. @throws Error when the file cannot be written
void write_mask(const std::filesystem::path& path, const MaskImage& mask);

/// Reads a mask: values above 127 become 255, others 0, since a lossy tool may have changed them.
/// Nothing when there is no such file. @throws Error naming the file when it cannot be read
[[nodiscard]] std::optional<MaskImage> read_mask(const std::filesystem::path& path);

/// Writes an image of labels/, whose values are bits and stay unchanged. @throws Error when the
/// file cannot be written
void write_labels(const std::filesystem::path& path, const GrayImage& labels);

/// Nothing when there is no such file. @throws Error naming the file when it cannot be read
[[nodiscard]] std::optional<GrayImage> read_labels(const std::filesystem::path& path);

/// The bytes of a JPEG file in colour. @param picture  not empty
/// @param quality  1 .. 100
/// @param bytes    overwritten; left empty when there is no memory
void encode_jpeg(const ColorImage& picture, int quality, std::vector<std::uint8_t>& bytes);

/// @throws Error when the file cannot be written
void write_jpeg(const std::filesystem::path& path, const ColorImage& picture);

/// The picture after encoding and decoding as write_jpeg() and a reader of its file would do it,
/// without a file.
[[nodiscard]] ColorImage through_jpeg(const ColorImage& picture);

/// The output of a perfect depth camera for one frame: the true depth, and which pixels show a
/// thing that may press.
struct TrueView {
  DepthImage depth;  ///< m
  MaskImage shows;   ///< kShowsPresser where labels/ have kMovesLabel, else kShowsRoom
};

/// Reads truth/depth and truth/labels; nothing if one of the two images is missing.
/// @param truth  folder of the truth
/// @param unit   m per count, TruthCamera::depth_unit
/// @throws Error naming the image that cannot be read
[[nodiscard]] std::optional<TrueView> read_true_view(const std::filesystem::path& truth, int frame,
                                                     double unit);

}  // namespace palpable
