/// @file
/// The near frames of the sequence `press`, with raw pairs as in a written sequence: benchmarks of
/// depth use them (docs/benchmark.md).
#pragma once

#include "palpable/common/base/progress.h"
#include "palpable/desk/clip_writer/desk_film.h"
#include "palpable/desk/film/desk_renderer.h"
#include "palpable/desk/script/plan_sequence.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpable::app {

/// m; scores count pixels nearer than this as "too close".
inline constexpr float kTooCloseDepth = 0.11F;

/// The frames of `press` in which the hand's median depth is 0.12-0.5 m and the hand covers 5 % of
/// the image or more. Needs OpenGL.
class NearFrames {
 public:
  /// Plans the sequence for the body in the file and checks the truth of every second frame.
  /// @throws Error when the body cannot be read or hides the hand, or without OpenGL
  NearFrames(const std::filesystem::path& body, std::uint64_t seed, const Progress& progress);

  [[nodiscard]] const std::string& body_name() const { return body_name_; }
  [[nodiscard]] const StereoRig& rig() const { return film_.rig; }
  [[nodiscard]] const RectifiedStereo& stereo() const { return film_.geometry.stereo; }
  /// Their numbers in the sequence, in order; only every second frame was checked.
  [[nodiscard]] const std::vector<int>& numbers() const { return near_; }
  /// Estimated number of near frames in the sequence, including those that were not checked.
  [[nodiscard]] std::size_t estimate() const { return kStep * near_.size(); }
  /// At most `most` of them, evenly spread.
  [[nodiscard]] std::vector<int> spread(std::size_t most) const;

  /// The same for the frames that have pixels nearer than kTooCloseDepth on 1 % of
  /// the image or more.
  [[nodiscard]] std::vector<int> spread_too_close(std::size_t most) const;

  /// Renders the raw pair through JPEG, and the truth in the rectified left camera scaled
  /// down by `shrink`.
  void draw(int number, int shrink, RawPair& pair, DeskTruth& truth);
  /// Renders the truth only.
  void draw_truth(int number, int shrink, DeskTruth& truth);

 private:
  static constexpr int kStep = 2;
  NearFrames(const ReducedBody& body, std::uint64_t seed, const Progress& progress);
  std::string body_name_;
  Sequence sequence_;
  Film film_;
  std::vector<int> near_;
  std::vector<int> too_close_;
};

}  // namespace palpable::app
