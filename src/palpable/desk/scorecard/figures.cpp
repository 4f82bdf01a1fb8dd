#include "palpable/desk/scorecard/figures.h"

#include "palpable/common/base/json.h"

#include <fmt/core.h>

#include <algorithm>
#include <concepts>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {
namespace {

// The sections of the text, in its order. Figures are listed in the order of the JSON object, which
// is another one.
enum class Section {
  kDepth,
  kPath,
  kPathMotion,
  kMoving,
  kTouchTimes,
  kTouch,
  kDeformed,
  kBodies,
  kReduction,
  kOcclusion,
  kPlace
};
using enum Section;

std::string shown(int value, const char* format) {
  return fmt::format(fmt::runtime(format), value);
}
std::string shown(double value, const char* format) {
  return fmt::format(fmt::runtime(format), value);
}
std::string shown(const MedianAndP90& value, const char* format) {
  return fmt::format("{} ({} in 9 of 10)", shown(value.median, format), shown(value.p90, format));
}

template <class T>
std::string line(const std::string& what, const std::optional<T>& value, const char* format) {
  return fmt::format("{:<44}{}\n", what, value ? shown(*value, format) : "-");
}
std::string line(const std::string& what, const std::optional<P50AndP99>& value,
                 const char* format) {
  const auto of = [&](double P50AndP99::*part) {
    return value ? std::optional((*value).*part) : std::nullopt;
  };
  return line(what + ", median", of(&P50AndP99::p50), format) +
         line(what + ", 99 of 100", of(&P50AndP99::p99), format);
}

template <class T>
Json or_null(const std::optional<T>& value) {
  return value;
}
Json or_null(const std::optional<MedianAndP90>& value) {
  return value ? Json{{"median", value->median}, {"p90", value->p90}} : Json(nullptr);
}
Json or_null(const std::optional<P50AndP99>& value) {
  return value ? Json{{"p50", value->p50}, {"p99", value->p99}} : Json(nullptr);
}

struct Figure {
  Section section;
  const char* name;  // key in JSON
  Json value;
  std::string lines = {};  // for people, each with its end; empty: only in JSON
};

class Figures {
 public:
  // @param what    the figure in words, for its line; null: it stands only in JSON
  // @param format  of its number, with the unit; null: 2 digits of a name in mm, else 3
  template <class T>
  void add(Section section, const char* name, const std::optional<T>& value,
           const char* what = nullptr, const char* format = nullptr) {
    const bool in_mm = std::string_view(name).find("_mm") != std::string_view::npos;
    if (format == nullptr) format = std::same_as<T, int> ? "{}" : in_mm ? "{:.2f} mm" : "{:.3f}";
    add({section, name, or_null(value), what == nullptr ? "" : line(what, value, format)});
  }
  void add(Figure figure) { figures_.push_back(std::move(figure)); }
  void append(const Figures& others) {
    figures_.insert(figures_.end(), others.figures_.begin(), others.figures_.end());
  }
  // Leaves figures out of the text.
  void hide_lines_if(bool (*hidden)(Section)) {
    for (Figure& figure : figures_) {
      if (hidden(figure.section)) figure.lines.clear();
    }
  }

  [[nodiscard]] Json json() const {
    Json json;
    for (const Figure& figure : figures_) json[figure.name] = figure.value;
    return json;
  }
  [[nodiscard]] std::string text() const {
    std::vector<Figure> sorted = figures_;
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Figure& a, const Figure& b) { return a.section < b.section; });
    std::string text;
    for (const Figure& figure : sorted) text += figure.lines;
    return text;
  }

 private:
  std::vector<Figure> figures_;
};

std::string depth_table(const ImageScores& images) {
  if (images.depth_frames == 0) return {};
  std::string text = "depth at (m)    median error   within 1 %   (the paper's camera: 1 to 9 %)\n";
  for (std::size_t k = 0; k < kDepthDistances.size(); ++k) {
    const DepthAtDistance& at = images.depth.at[k];
    if (!at.median_error || !at.within_1pct) continue;
    text += fmt::format("{:>12}{:>15.2f} %{:>11.1f} %\n", fmt::format("{}", kDepthDistances[k]),
                        100 * *at.median_error, 100 * *at.within_1pct);
  }
  return text;
}

void add_depth(const ImageScores& images, Figures& figures) {
  const bool any = images.depth_frames > 0;
  const DepthScore& depth = images.depth;
  figures.add({kDepth, "depth_frames", images.depth_frames,
               line("frames whose depth is scored", std::optional(images.depth_frames), "{}") +
                   depth_table(images)});
  const auto add_by_distance = [&](const char* name, std::optional<double> DepthAtDistance::*what) {
    Json by_distance;
    for (std::size_t k = 0; any && k < kDepthDistances.size(); ++k) {
      by_distance[fmt::format("{}", kDepthDistances[k])] = depth.at[k].*what;
    }
    figures.add({kDepth, name, by_distance});
  };
  add_by_distance("depth_median", &DepthAtDistance::median_error);
  add_by_distance("depth_within_1pct", &DepthAtDistance::within_1pct);
  add_by_distance("depth_density", &DepthAtDistance::density);
  figures.add(kDepth, "hand_within_1pct", depth.hand_within_1pct, "near hand within 1 %");
  figures.add({kDepth, "hand_near_frames", any ? Json(depth.near_frames) : Json(nullptr)});
  figures.add(kDepth, "too_close_called_far", depth.too_close_called_far,
              "too close, but called far", "{:.4f}");
}

Json deformed_by_frame(const BodyScores& body) {
  if (!body.deformed_frames) return nullptr;
  Json frames = Json::array();
  for (const DeformedFrame& frame : body.by_frame) {
    frames.push_back({{"frame", frame.frame},
                      {"displacement_error", frame.displacement_error},
                      {"displacement_error_mm", frame.displacement_error_mm},
                      {"von_mises_error", frame.von_mises_error},
                      {"force_error", frame.force_error}});
  }
  return frames;
}

// All but the placement, which has its own position in JSON.
Figures figures_of(const BodyScores& body) {
  Figures f;
  f.add(kTouchTimes, "frames_touching", body.frames_touching, "frames with a true touch");
  f.add(kTouch, "touch_precision", body.touch_precision, "felt touches that are true");
  f.add(kTouch, "touch_recall", body.touch_recall, "true touches that are felt");
  f.add(kTouch, "touch_site", body.touch_site, "  at the right site");
  f.add(kTouchTimes, "first_touch_delay_frames", body.first_touch_delay_frames,
        "first touch felt after the true one by", "{} frames");
  f.add(kTouch, "touch_recall_3mm", body.touch_recall_3mm,
        "true touches of 3 mm and seen that are felt");
  f.add(kTouch, "touch_false_5mm", body.touch_false_5mm, "felt touches with nothing within 5 mm");
  f.add(kTouch, "frames_too_deep", body.frames_too_deep, "frames too deep to be scored");
  f.add(kTouch, "frames_unseen", body.frames_unseen, "frames whose touch no camera sees");
  f.add(kTouch, "penetration_median_mm", body.penetration_median_mm, "penetration left, median");
  f.add(kTouch, "penetration_p99_mm", body.penetration_p99_mm, "penetration left, 99 of 100");
  f.add(kTouch, "penetration_median_mm_unseen", body.penetration_median_mm_unseen,
        "  median where no camera sees the touch");
  f.add(kTouch, "largest_pop_mm", body.largest_pop_mm, "largest unexplained jump of the surface");
  f.add(kTouch, "largest_pop_frame", body.largest_pop_frame);
  f.add(kTouch, "pops_4mm", body.pops_4mm, "  jumps of more than 4 mm");
  f.add(kDeformed, "deformed_frames", body.deformed_frames,
        "frames with a full-order solution, deep");
  f.add(kDeformed, "deformed_frames_shallow", body.deformed_frames_shallow, "  and shallow");
  f.add(kDeformed, "deformed_frames_unseen", body.deformed_frames_unseen,
        "  whose touch no camera sees: not judged");
  f.add(kDeformed, "displacement_error", body.displacement_error, "displacement, relative error");
  f.add(kDeformed, "displacement_error_mm", body.displacement_error_mm, "  at the worst vertex");
  f.add(kDeformed, "displacement_error_mm_shallow", body.displacement_error_mm_shallow,
        "  in shallow touches");
  f.add(kDeformed, "displacement_error_mm_unseen", body.displacement_error_mm_unseen,
        "  where no camera sees the touch");
  f.add(kDeformed, "von_mises_error", body.von_mises_error, "stress, error of the maximum");
  f.add(kDeformed, "force_error", body.force_error, "force, relative error");
  f.add(kDeformed, "overpress_mm", body.overpress_mm, "pressed too far");
  f.add({kDeformed, "deformed_by_frame", deformed_by_frame(body)});
  if (!body.deformed_frames) f.hide_lines_if([](Section section) { return section == kDeformed; });
  return f;
}

void add_placement(const BodyScores& body, Figures& figures) {
  figures.add(kPlace, "placement_error_mm", body.placement_error_mm, "body drawn off its place by");
}

// The figures of each of several bodies.
Figure figure_of(const std::vector<BodyScores>& bodies) {
  Figure all{kBodies, "bodies", {}};
  for (const BodyScores& body : bodies) {
    Figures figures = figures_of(body);
    add_placement(body, figures);
    all.value[body.name] = figures.json();
    all.lines += body.name + "\n" + figures.text();
  }
  return all;
}

Figures figures_of(const Scorecard& scores) {
  const ImageScores& images = scores.images;
  const PathScores& path = scores.path;
  Figures f;
  f.add(kDepth, "frames", std::optional(scores.frames), "frames");
  f.add(kDepth, "frames_processed", std::optional(scores.frames_processed),
        "  that the result processed");
  add_depth(images, f);
  f.add(kMoving, "moving_iou", images.moving_iou, "what moves, intersection over union");
  f.add(kMoving, "moving_recall", images.moving_recall, "what moves, found");
  f.add(kMoving, "moving_false", images.moving_false, "called moving and is not, of all pixels",
        "{:.5f}");
  f.add(kOcclusion, "occlusion_frames", std::optional(images.occlusion_frames),
        "frames whose occlusion is scored");
  f.add(kOcclusion, "occlusion_iou", images.occlusion_iou, "visible body, intersection over union");
  f.add(kOcclusion, "occlusion_iou_where_hidden", images.occlusion_iou_where_hidden,
        "  where a hand hides part of it");
  f.add(kOcclusion, "occlusion_iou_worst_frame", images.occlusion_iou_worst_frame,
        "  in the worst frame");
  f.add(kOcclusion, "edge_error_px", images.edge_error_px, "border between body and hand is off by",
        "{:.1f} px");
  f.add(kOcclusion, "crossing_frames", std::optional(images.crossing_frames));
  f.add(kOcclusion, "edge_error_crossing_px", images.edge_error_crossing_px,
        "  where a hand crosses the outline", "{:.1f} px");
  f.add(kOcclusion, "flicker", images.flicker, "flicker", "{:.4f}");
  f.add(kPath, "ate_mm", path.ate_mm, "camera path, absolute error");
  f.add(kPathMotion, "rpe_mm", path.rpe_mm, "camera path, error over 1 s");
  f.add(kPathMotion, "rpe_deg", path.rpe_deg);
  f.add(kPath, "trajectory_share", path.trajectory_share, "  share of the path that was found");
  Figures of_body = figures_of(scores.body);
  if (!scores.bodies.empty()) of_body.hide_lines_if([](Section) { return true; });
  f.append(of_body);
  if (!scores.bodies.empty()) f.add(figure_of(scores.bodies));
  add_placement(scores.body, f);
  f.add(kPlace, "jitter_mm", scores.jitter_mm, "jitter of the body in the world");
  f.add(kPlace, "row_error_px", scores.row_error_px, "rows out of line, at worst", "{:.2f} px");
  if (scores.reduction_error) {
    f.add(kReduction, "reduction_error", scores.reduction_error,
          "error of the reduced model, pooled", "{:.2e}");
    f.add(kReduction, "reduction_error_worst", scores.reduction_error_worst);
  }
  return f;
}

// A summary for people: the errors of shape and force, over the frames that are scored.
std::string in_short(const BodyScores& body) {
  const auto& shape = body.displacement_error;
  const auto& force = body.force_error;
  if (!body.deformed_frames || !shape) return {};
  std::string text = fmt::format(
      "in short: {}response computed from the camera's pictures, against full finite elements "
      "under "
      "the true hand ({} frames): shape off by {:.0f} % in the median ({:.0f} % in 9 of 10)",
      body.name.empty() ? "" : body.name + ": ", *body.deformed_frames, 100 * shape->median,
      100 * shape->p90);
  if (force) {
    text += fmt::format(", force by {:.0f} % ({:.0f} %)", 100 * force->median, 100 * force->p90);
  }
  return text + "\n";
}

Figures figures_of(const PoseScores& scores) {
  Figures f;
  f.add({kPath, "format", scores.format});
  f.add({kPath, "poses_of", scores.of});
  f.add({kPath, "poses_published", scores.published,
         fmt::format("{:<44}{} ({}, of the {})\n", "published poses", scores.published,
                     scores.format, scores.of)});
  f.add(kPath, "poses_found", std::optional(scores.found), "found poses");
  f.add(kPath, "poses_matched", std::optional(scores.matched),
        "  at the moment of a published one");
  f.add(kPath, "seconds", std::optional(scores.seconds), "time from the first of these to the last",
        "{:.2f} s");
  f.add(kPath, "path_m", std::optional(scores.path_m), "path in that time", "{:.2f} m");
  f.add(kPath, "ate_mm", std::optional(scores.ate_mm), "position, rms after alignment",
        "{:.1f} mm");
  f.add(kPath, "rpe_mm", scores.rpe_mm, "motion over 1 s, rms", "{:.1f} mm");
  f.add(kPath, "rpe_deg", scores.rpe_deg, "rotation over 1 s, rms", "{:.3f} degrees");
  f.add(kPath, "end_error_percent", scores.end_error_percent, "end of the path, of its length",
        "{:.2f} %");
  return f;
}

}  // namespace

std::string json_of(const Scorecard& scores) { return figures_of(scores).json().dump(2); }
std::string json_of(const PoseScores& scores) { return figures_of(scores).json().dump(2); }

std::string text_of(const Scorecard& scores) {
  std::string text = figures_of(scores).text();
  if (scores.bodies.empty()) text += in_short(scores.body);
  for (const BodyScores& body : scores.bodies) text += in_short(body);
  return text;
}
std::string text_of(const PoseScores& scores) { return figures_of(scores).text(); }

}  // namespace palpable
