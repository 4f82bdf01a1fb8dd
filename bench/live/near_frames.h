/// @file
/// The near frames of the sequence `press`, as the player of a written sequence gets them: benches
/// of depth are measured on these (docs/benchmark.md).
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

/// A score counts what is nearer than this as "too close", m.
inline constexpr float kTooCloseDepth = 0.11F;

/// Frames of `press` in which the hand's median depth is 0.12-0.5 m and it covers 5 % of the image
/// or more. Needs OpenGL.
class NearFrames {
 public:
  /// Plans the sequence for the body in the file and looks at every second frame's truth.
  /// @throws Error when the body cannot be read or hides the hand, or without OpenGL
  NearFrames(const std::filesystem::path& body, std::uint64_t seed, const Progress& progress);

  [[nodiscard]] const std::string& body_name() const { return body_name_; }
  [[nodiscard]] const StereoRig& rig() const { return film_.rig; }
  [[nodiscard]] const RectifiedStereo& stereo() const { return film_.geometry.stereo; }
  /// Their numbers in the sequence, in order; of two neighbours only one was looked at.
  [[nodiscard]] const std::vector<int>& numbers() const { return near_; }
  /// How many the sequence has, the frames that were not looked at included.
  [[nodiscard]] std::size_t estimate() const { return kStep * near_.size(); }
  /// So many of them, evenly spread; all if there are no more.
  [[nodiscard]] std::vector<int> spread(std::size_t most) const;

  /// Of the frames that have pixels nearer than kTooCloseDepth on 1 % of the image or more.
  [[nodiscard]] std::vector<int> spread_too_close(std::size_t most) const;

  /// Raw pair through JPEG, and truth in the rectified left camera scaled down by `shrink`.
  void draw(int number, int shrink, RawPair& pair, DeskTruth& truth);
  /// Truth alone.
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
