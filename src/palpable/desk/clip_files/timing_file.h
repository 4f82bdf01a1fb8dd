/// @file
/// timing.csv of a run: the time of each stage in each frame, ms, with "total_ms" last:
///
///     frame,read_ms,rectify_ms,...,total_ms
///     0,1.250,0.310,...,14.022
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// The first line, including its line end. @param stages  without "_ms"
[[nodiscard]] std::string timing_header(std::span<const std::string> stages);
/// The line of a frame. @param ms  in the header's order
[[nodiscard]] std::string timing_line(int frame, std::span<const double> ms);

/// F frames, S stages.
struct TimingTable {
  std::vector<std::string> stages;      ///< (S) without "_ms"
  std::vector<int> frames;              ///< (F)
  std::vector<std::vector<double>> ms;  ///< (F) of (S)
};

/// @throws Error naming file and line when the header differs, or when a line has another length or
/// holds something other than numbers
[[nodiscard]] TimingTable read_timing(const std::filesystem::path& path);

}  // namespace palpable
