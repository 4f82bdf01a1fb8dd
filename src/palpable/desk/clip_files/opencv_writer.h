/// @file
/// Writes images through OpenCV. Included by .cpp files of this module only.
#pragma once

#include <opencv2/core.hpp>

#include <filesystem>
#include <vector>

namespace palpable {

/// PNG, level 1, with run lengths in place of zlib's search for repetitions, of differences between
/// neighbours: for masks and smooth depth as small, and in less than half the time. (With a level
/// named, OpenCV lets libpng try all its filters on each row: the four images of a 720p frame took
/// 16.6 ms then, 7.3 ms now, and are 4 % larger.) What a run writes.
[[nodiscard]] std::vector<int> png_of_runs();
/// PNG, level 1, zlib's own search. What a truth is written with.
[[nodiscard]] std::vector<int> png_of_repetitions();

/// @param path      its ending says the format
/// @param settings  as cv::imencode wants them
/// @throws Error naming the file when it cannot be written, with the reason; half of an image does
/// not stay
void write_image(const std::filesystem::path& path, const cv::Mat& image,
                 const std::vector<int>& settings);

}  // namespace palpable
