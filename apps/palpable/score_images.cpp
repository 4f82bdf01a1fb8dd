#include "apps/palpable/score_images.h"

#include "apps/common/json.h"
#include "palpable/base/error.h"
#include "palpable/score/mask_score.h"
#include "palpable/score/occlusion.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

namespace palpable::app {
namespace {

constexpr float kBodyDepthUnit = 1e-4f;  // m per count of body_depth/
constexpr double kPictureScale = 2;      // full-size px per px of the truth
constexpr double kPartlyHidden = 0.02;   // of the body, from which it counts as such

DepthImage metres(const DepthCounts& counts, float unit) {
  DepthImage depth(counts.width(), counts.height());
  std::transform(counts.begin(), counts.end(), depth.begin(), [&](std::uint16_t count) {
    return count == kNoDepth ? std::numeric_limits<float>::quiet_NaN()
                             : static_cast<float>(count) * unit;
  });
  return depth;
}

// The images of one frame must be of one size, masks may be twice as large.
template <class A, class B>
void expect_size(const A& image, const B& truth, bool or_twice, const TruthFolder& of,
                 const std::filesystem::path& folder, const char* kind, int frame,
                 const char* true_kind = "depth") {
  const bool same = image.width() == truth.width() && image.height() == truth.height();
  const bool twice = image.width() == 2 * truth.width() && image.height() == 2 * truth.height();
  if (same || (or_twice && twice)) return;
  throw Error(fmt::format("{}: {} x {}, but {} is {} x {}",
                          (folder / kind / fmt::format("{:06d}.png", frame)).string(),
                          image.width(), image.height(),
                          (of.folder / true_kind / fmt::format("{:06d}.png", frame)).string(),
                          truth.width(), truth.height()));
}

MaskImage to_half(const MaskImage& mask, int width) {
  if (mask.width() == width) return mask;
  MaskImage half(mask.width() / 2, mask.height() / 2);
  for (int y = 0; y < half.height(); ++y) {
    for (int x = 0; x < half.width(); ++x) {
      const int set = (mask(2 * x, 2 * y) != 0) + (mask(2 * x + 1, 2 * y) != 0) +
                      (mask(2 * x, 2 * y + 1) != 0) + (mask(2 * x + 1, 2 * y + 1) != 0);
      half(x, y) = set >= 2 ? 255 : 0;
    }
  }
  return half;
}

// Masks are 255 or 0; what lossy tools made of them is set from the middle on.
MaskImage as_mask(GrayImage gray) {
  for (std::uint8_t& value : gray) value = value > 127 ? 255 : 0;
  return gray;
}

class OcclusionSum {
 public:
  void add(int frame, const MaskImage& visible, const DepthImage& body, const DepthImage& real) {
    SightImage truth = true_sight(body, real);
    SightImage drawn = drawn_sight(visible, body);
    const MaskOverlap overlap = overlap_of(truth, drawn);
    ++frames_;
    sum_ += overlap.iou();
    worst_ = std::min(worst_, overlap.iou());
    if (overlap.body > 0 &&
        static_cast<double>(overlap.hidden) >= kPartlyHidden * static_cast<double>(overlap.body)) {
      ++hidden_frames_;
      hidden_sum_ += overlap.iou();
    }
    const BorderError border = border_error(truth, drawn);
    border_.sum_px += border.sum_px;
    border_.pixels += border.pixels;
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

  // A frame without the body's depth: nothing was drawn, and what hides it nobody can tell.
  void add_missing() {
    ++frames_;
    worst_ = 0;
  }

  void write(Json& scores) const {
    const auto mean = [](double sum, int n) {
      return n == 0 ? std::nullopt : std::optional(sum / n);
    };
    scores["occlusion_frames"] = frames_;
    scores["occlusion_iou"] = mean(sum_, frames_);
    scores["occlusion_iou_where_hidden"] = mean(hidden_sum_, hidden_frames_);
    scores["occlusion_iou_worst_frame"] = frames_ > 0 ? Json(worst_) : nullptr;
    const std::optional<double> border = border_.mean_px();
    scores["edge_error_px"] = border ? Json(kPictureScale * *border) : nullptr;
    scores["flicker"] = flicker_.share();
  }

 private:
  int frames_ = 0;
  double sum_ = 0;
  double worst_ = 1;
  int hidden_frames_ = 0;
  double hidden_sum_ = 0;
  BorderError border_;
  Flicker flicker_;
  int last_frame_ = -2;
  SightImage truth_;
  SightImage drawn_;
};

void write_depth(const DepthScore& score, int frames, Json& scores) {
  const bool any = frames > 0;
  scores["depth_frames"] = frames;
  for (const char* key : {"depth_median", "depth_within_1pct", "depth_density"})
    scores[key] = nullptr;
  if (any) {
    for (std::size_t k = 0; k < kDepthDistances.size(); ++k) {
      const std::string distance = fmt::format("{}", kDepthDistances[k]);
      scores["depth_median"][distance] = score.at[k].median_error;
      scores["depth_within_1pct"][distance] = score.at[k].within_1pct;
      scores["depth_density"][distance] = score.at[k].density;
    }
  }
  scores["hand_within_1pct"] = score.hand_within_1pct;
  scores["hand_near_frames"] = any ? Json(score.near_frames) : nullptr;
  scores["too_close_called_far"] = score.too_close_called_far;
}

}  // namespace

void score_images(const TruthFolder& truth, const ResultFolder& result, const Progress& progress,
                  Json& scores) {
  DepthScorer depth(truth.depth_unit);
  int depth_frames = 0;
  MaskScore moving;
  OcclusionSum occlusion;
  const auto holds = [&](const char* kind) {
    return std::filesystem::is_directory(result.folder / kind);
  };
  // A folder that is there stands for all its frames: one that holds only the good ones gains
  // nothing by it.
  const bool any_depth = holds("depth");
  const bool any_moving = holds("moving");
  const bool any_visible = holds("visible") && holds("body_depth");
  for (int frame = 0; frame < truth.frames; ++frame) {
    report(progress, {"comparing images", frame + 1.0, static_cast<double>(truth.frames), ""});
    if (result.processed[static_cast<std::size_t>(frame)] == 0) continue;
    const auto true_depth = read_counts(truth.folder, "depth", frame);
    const auto labels = read_gray(truth.folder, "labels", frame);
    if (labels && any_moving) {
      const auto found = read_gray(result.folder, "moving", frame);
      if (found) {
        expect_size(*found, *labels, true, truth, result.folder, "moving", frame, "labels");
        moving += compare_masks(*labels, kMovingLabel, to_half(as_mask(*found), labels->width()));
      } else {
        moving += missing_mask(*labels, kMovingLabel);
      }
    }
    if (!true_depth) continue;
    if (labels) expect_size(*labels, *true_depth, false, truth, truth.folder, "labels", frame);

    if (any_depth) {
      auto found = read_counts(result.folder, "depth", frame);
      if (!found) found.emplace(true_depth->width(), true_depth->height(), kNoDepth);
      expect_size(*found, *true_depth, false, truth, result.folder, "depth", frame);
      depth.add(*true_depth, labels.value_or(GrayImage{}), *found);
      ++depth_frames;
    }
    if (!any_visible) continue;
    const auto body = read_counts(result.folder, "body_depth", frame);
    if (!body) {
      occlusion.add_missing();
    } else {
      auto visible = read_gray(result.folder, "visible", frame);
      if (!visible) visible.emplace(true_depth->width(), true_depth->height(), std::uint8_t{0});
      expect_size(*visible, *true_depth, true, truth, result.folder, "visible", frame);
      expect_size(*body, *true_depth, false, truth, result.folder, "body_depth", frame);
      occlusion.add(frame, as_mask(*visible), metres(*body, kBodyDepthUnit),
                    metres(*true_depth, static_cast<float>(truth.depth_unit)));
    }
  }
  write_depth(depth.score(), depth_frames, scores);
  scores["moving_iou"] = moving.iou();
  scores["moving_recall"] = moving.recall();
  scores["moving_false"] = moving.false_alarms();
  occlusion.write(scores);
}

}  // namespace palpable::app
