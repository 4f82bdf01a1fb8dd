/// @file
/// Writes images with OpenCV. Only .cpp files of this module include this header.
#pragma once

#include <opencv2/core.hpp>

#include <filesystem>
#include <vector>

namespace palpable {

/// Settings of the images that a run writes: PNG, level 1 (OpenCV's default), with run-length
/// encoding of the differences between neighbouring pixels instead of zlib's search for
/// repetitions. For masks and smooth depth the files are about as small, in less than half the
/// time. The level is not named, because with a named one OpenCV lets libpng try all its filters on
/// each row: the four images of a 720p frame then took 16.6 ms; now they take 7.3 ms and are 4 %
/// larger.
[[nodiscard]] std::vector<int> png_of_runs();
/// Settings of the images of a truth: PNG, level 1, with zlib's search for repetitions.
[[nodiscard]] std::vector<int> png_of_repetitions();

/// @param path      its ending determines the format
/// @param settings  parameters of cv::imencode
/// @throws Error naming the file and the reason when it cannot be written; no partial file remains
void write_image(const std::filesystem::path& path, const cv::Mat& image,
                 const std::vector<int>& settings);

}  // namespace palpable
