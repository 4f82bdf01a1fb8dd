#include "palpable/desk/scorecard/image_scores.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/desk/score/picture_scores.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr double kPictureScale = 2;     // full-size px per px of the truth's images
constexpr double kPartlyHidden = 0.02;  // smallest hidden share of a body that counts as hidden

fs::path image_of(const fs::path& folder, const char* kind, int frame) {
  return folder / kind / frame_name(frame, ".png");
}

// @throws Error unless the images have the same size or, with `or_twice`, `image` twice that size
template <class A, class B>
void expect_size(const A& image, const fs::path& path, const B& truth, const fs::path& truth_path,
                 bool or_twice) {
  const bool same = image.width() == truth.width() && image.height() == truth.height();
  const bool twice = image.width() == 2 * truth.width() && image.height() == 2 * truth.height();
  if (same || (or_twice && twice)) return;
  throw Error(fmt::format("{}: {} x {}, but {} is {} x {}", path.string(), image.width(),
                          image.height(), truth_path.string(), truth.width(), truth.height()));
}

MaskImage moving_in(const GrayImage& labels) {
  MaskImage moving(labels.width(), labels.height());
  for (std::size_t i = 0; i < labels.size(); ++i) moving.data()[i] = labels.data()[i] & kMovesLabel;
  return moving;
}

std::optional<double> mean_of(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

class OcclusionSum {
 public:
  // @param moving  mask of the moving things in the real scene; empty: not known
  void add(int frame, const MaskImage& visible, const DepthImage& body, const DepthImage& real,
           const MaskImage& moving) {
    SightImage truth = true_sight(body, real);
    SightImage drawn = drawn_sight(visible, body);
    const MaskOverlap overlap = overlap_of(truth, drawn);
    ious_.push_back(overlap.iou());
    if (overlap.body > 0 &&
        static_cast<double>(overlap.hidden) >= kPartlyHidden * static_cast<double>(overlap.body)) {
      hidden_ious_.push_back(overlap.iou());
    }
    const BorderError border = border_error(truth, drawn);
    border_.sum_px += border.sum_px;
    border_.pixels += border.pixels;
    if (crosses_outline(truth, moving)) {
      ++crossing_frames_;
      crossing_.sum_px += border.sum_px;
      crossing_.pixels += border.pixels;
    }
    if (last_frame_ == frame - 1 && truth_.width() == truth.width() &&
        truth_.height() == truth.height()) {
      const Flicker flicker = flicker_between(truth_, drawn_, truth, drawn);
      flicker_.pixels += flicker.pixels;
      flicker_.changed += flicker.changed;
    }
    last_frame_ = frame;
    truth_ = std::move(truth);
    drawn_ = std::move(drawn);
  }

  // Adds a frame without a depth of the body: nothing was drawn, and the true mask is unknown.
  void add_missing() { ious_.push_back(0); }

  void write(ImageScores& scores) const {
    scores.occlusion_frames = static_cast<int>(ious_.size());
    scores.occlusion_iou = mean_of(ious_);
    scores.occlusion_iou_where_hidden = mean_of(hidden_ious_);
    if (!ious_.empty())
      scores.occlusion_iou_worst_frame = *std::min_element(ious_.begin(), ious_.end());
    if (const auto border = border_.mean_px()) scores.edge_error_px = kPictureScale * *border;
    scores.crossing_frames = crossing_frames_;
    if (const auto border = crossing_.mean_px()) {
      scores.edge_error_crossing_px = kPictureScale * *border;
    }
    scores.flicker = flicker_.share();
  }

 private:
  std::vector<double> ious_, hidden_ious_;  ///< by frame; those in which part of the body is hidden
  BorderError border_;
  int crossing_frames_ = 0;
  BorderError crossing_;
  Flicker flicker_;
  int last_frame_ = -2;
  SightImage truth_;
  SightImage drawn_;
};

// Accumulates the scores over the frames of one result.
class ImageScorer {
 public:
  ImageScorer(const TruthFolder& truth, const ResultFolder& result)
      : truth_(truth),
        result_(result),
        any_depth_(holds("depth")),
        any_moving_(holds("moving")),
        any_visible_(holds("visible") && holds("body_depth")),
        depth_(truth.depth_unit) {}

  void add(int frame) {
    const auto true_depth = read_depth_counts(image_of(truth_.folder, "depth", frame));
    const auto labels = read_labels(image_of(truth_.folder, "labels", frame));
    if (labels && any_moving_) add_moving(frame, *labels);
    if (!true_depth) return;
    const fs::path truth_path = image_of(truth_.folder, "depth", frame);
    if (labels) {
      expect_size(*labels, image_of(truth_.folder, "labels", frame), *true_depth, truth_path,
                  false);
    }
    if (any_depth_) add_depth(frame, *true_depth, labels.value_or(GrayImage{}));
    if (any_visible_) add_occlusion(frame, *true_depth, labels.value_or(GrayImage{}));
  }

  [[nodiscard]] ImageScores scores() const {
    ImageScores scores;
    scores.depth_frames = depth_frames_;
    scores.depth = depth_.score();
    scores.moving_iou = moving_.iou();
    scores.moving_recall = moving_.recall();
    scores.moving_false_positives = moving_.false_alarms();
    occlusion_.write(scores);
    return scores;
  }

 private:
  // If a folder exists, all its frames are scored and missing files count against the result, so
  // that a folder with only the good frames gains nothing.
  [[nodiscard]] bool holds(const char* kind) const {
    return fs::is_directory(result_.folder / kind);
  }

  void add_moving(int frame, const GrayImage& labels) {
    const fs::path path = image_of(result_.folder, "moving", frame);
    const auto found = read_mask(path);
    if (!found) {
      moving_ += missing_mask(labels, kMovesLabel);
      return;
    }
    expect_size(*found, path, labels, image_of(truth_.folder, "labels", frame), true);
    const bool is_half = found->width() == labels.width();
    moving_ += compare_masks(labels, kMovesLabel, is_half ? *found : half_of(*found));
  }

  void add_depth(int frame, const DepthCounts& true_depth, const GrayImage& labels) {
    const fs::path path = image_of(result_.folder, "depth", frame);
    auto found = read_depth_counts(path);
    if (!found) found.emplace(true_depth.width(), true_depth.height(), kNoDepth);
    expect_size(*found, path, true_depth, image_of(truth_.folder, "depth", frame), false);
    depth_.add(true_depth, labels, *found);
    ++depth_frames_;
  }

  void add_occlusion(int frame, const DepthCounts& true_depth, const GrayImage& labels) {
    const fs::path body_path = image_of(result_.folder, "body_depth", frame);
    const auto body = read_depth_counts(body_path);
    if (!body) {
      occlusion_.add_missing();
      return;
    }
    const fs::path truth_path = image_of(truth_.folder, "depth", frame);
    const fs::path path = image_of(result_.folder, "visible", frame);
    auto visible = read_mask(path);
    if (!visible) visible.emplace(true_depth.width(), true_depth.height(), std::uint8_t{0});
    expect_size(*visible, path, true_depth, truth_path, true);
    expect_size(*body, body_path, true_depth, truth_path, false);
    occlusion_.add(frame, *visible, depth_of(*body, kBodyDepthUnit),
                   depth_of(true_depth, truth_.depth_unit), moving_in(labels));
  }

  const TruthFolder& truth_;
  const ResultFolder& result_;
  bool any_depth_;
  bool any_moving_;
  bool any_visible_;
  DepthScorer depth_;
  int depth_frames_ = 0;
  MaskScore moving_;
  OcclusionSum occlusion_;
};

}  // namespace

ImageScores score_images(const TruthFolder& truth, const ResultFolder& result,
                         const Progress& progress) {
  ImageScorer scorer(truth, result);
  for (int frame = 0; frame < truth.frames; ++frame) {
    report(progress, {"comparing images", frame + 1.0, static_cast<double>(truth.frames), ""});
    if (result.processed[frame] != 0) scorer.add(frame);
  }
  return scorer.scores();
}

}  // namespace palpable
