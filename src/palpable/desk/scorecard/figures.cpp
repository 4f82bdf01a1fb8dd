#include "palpable/desk/scorecard/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace palpable {
namespace {

enum class Bound { kAtMost, kAtLeast };

// A target that the project states for a figure.
struct Target {
  std::string_view figure;  // key in JSON; of an object ".median", ".p90" or ".p99" behind it
  Bound bound;
  double value;           // in the figure's unit
  std::string_view film;  // the only film for which it is stated, or one of the following two
};
constexpr std::string_view kEveryFilm;
constexpr std::string_view kUsualFilms = "usual";  // all but these
constexpr std::array<std::string_view, 5> kUnusualFilms{"dark", "textureless", "pencil",
                                                        "pencil-turn", "beams"};

using enum Bound;
// All targets. A figure that is not listed has none.
constexpr Target kTargets[] = {
    // docs/lab/contact.md, "Held-out seeds"
    {"touch_recall_3mm", kAtLeast, 0.98, kEveryFilm},
    {"touch_false_discovery_5mm", kAtMost, 0.005, kEveryFilm},
    // docs/lab/contact.md, "The answer by camera"
    {"penetration_median_mm", kAtMost, 1, kUsualFilms},
    {"penetration_p99_mm", kAtMost, 3, kUsualFilms},
    {"largest_jump_mm", kAtMost, 4, kUsualFilms},
    {"displacement_error.median", kAtMost, 0.20, kUsualFilms},
    {"displacement_error.p90", kAtMost, 0.45, kUsualFilms},
    {"max_vertex_error_mm.median", kAtMost, 1.5, kUsualFilms},
    {"max_vertex_error_mm.p90", kAtMost, 3, kUsualFilms},
    {"force_error.median", kAtMost, 0.25, kUsualFilms},
    {"force_error.p90", kAtMost, 0.50, kUsualFilms},
    {"excess_indentation_mm.p99", kAtMost, 2.5, kUsualFilms},
    // docs/lab/scenes.md, "Two beams", by camera
    {"displacement_error.median", kAtMost, 0.06, "beams"},
    {"displacement_error.p90", kAtMost, 0.12, "beams"},
    // docs/depth.md, the figures of occlusion and the bars of `palpable bench depth`
    {"occlusion_iou", kAtLeast, 0.98, kEveryFilm},
    {"occlusion_iou_where_hidden", kAtLeast, 0.95, kEveryFilm},
    {"edge_error_crossing_px", kAtMost, 2.5, kEveryFilm},
    {"flicker", kAtMost, 0.005, kEveryFilm},
    {"hand_within_1pct", kAtLeast, 0.90, "press"},
    {"too_close_called_far", kAtMost, 0.001, "press"},
    // docs/tracking.md, "What it reaches"
    {"jitter_mm", kAtMost, 1, "still"},
    {"ate_mm", kAtMost, 2.5, "walk"},
    {"ate_mm", kAtMost, 3, "walk-hand"},
    {"ate_mm", kAtMost, 10, "blur"},
};

const Target* target_of(std::string_view figure, std::string_view film) {
  const bool usual =
      std::find(kUnusualFilms.begin(), kUnusualFilms.end(), film) == kUnusualFilms.end();
  for (const Target& target : kTargets) {
    const bool stated =
        target.film == kEveryFilm || target.film == film || (target.film == kUsualFilms && usual);
    if (target.figure == figure && stated) return &target;
  }
  return nullptr;
}

// How a number is shown: value * factor with `digits` behind the point, and the unit.
struct Format {
  int digits;
  const char* unit;
  double factor = 1;

  [[nodiscard]] std::string text(double value) const {
    return fmt::format("{:.{}f}{}", factor * value, digits, unit);
  }
  [[nodiscard]] std::string of_target(double value) const {
    return fmt::format("{:g}{}", factor * value, unit);
  }
};
constexpr Format kCount{0, ""}, kFrames{0, " frames"}, kShare{3, ""}, kPercent{1, " %", 100};
constexpr Format kFinePercent{3, " %", 100}, kMm{2, " mm"}, kPx{2, " px"}, kDegrees{3, " deg"};

// The targets that a run meets, of those stated for figures that are known.
struct Tally {
  int met = 0;
  int stated = 0;
};

// A line for people.
struct Row {
  std::string what;
  std::string typical = {};   // the mean or the median
  std::string at_worst = {};  // 90 or 99 of 100, or the worst frame
  std::vector<std::string> targets = {};
  bool met = true;     // all of them
  bool known = false;  // any of its numbers
};

std::string text_of(const Row& row) {
  std::string line = fmt::format("  {:<52}{:>12}{:>12}", row.what, row.typical, row.at_worst);
  if (!row.targets.empty()) {
    line +=
        fmt::format("   {} (target: {})", row.met ? "ok" : "missed", fmt::join(row.targets, ", "));
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

template <class T>
Json or_null(const std::optional<T>& value) {
  return value;
}
Json or_null(const std::optional<MedianAndP90>& value) {
  return value ? Json{{"median", value->median}, {"p90", value->p90}} : Json(nullptr);
}
Json or_null(const std::optional<P50AndP99>& value) {
  return value ? Json{{"median", value->p50}, {"p99", value->p99}} : Json(nullptr);
}

// The figures of a run under headings, as text and as JSON.
class Figures {
 public:
  // @param film  decides which targets are stated
  explicit Figures(std::string film) : film_(std::move(film)) {}

  void begin_section(const char* heading) { sections_.push_back({heading, {}, {}}); }

  // A figure with a line of its own.
  // @param name  key in JSON; "group.key": in the object "group"
  template <class T>
  void add(const std::string& name, const std::optional<T>& value, const char* what,
           const Format& format) {
    at(name) = or_null(value);
    Row& row = add_row(what);
    if constexpr (std::is_same_v<T, MedianAndP90>) {
      set(row, row.typical, name + ".median", part(value, &T::median), format);
      set(row, row.at_worst, name + ".p90", part(value, &T::p90), format);
    } else if constexpr (std::is_same_v<T, P50AndP99>) {
      set(row, row.typical, name + ".median", part(value, &T::p50), format);
      set(row, row.at_worst, name + ".p99", part(value, &T::p99), format);
    } else {
      set(row, row.typical, name, value ? std::optional<double>(*value) : std::nullopt, format);
    }
  }
  // A figure that stands in the line before, as its worst case.
  void add_at_worst(const std::string& name, const std::optional<double>& value,
                    const Format& format) {
    json_[name] = or_null(value);
    Row& row = sections_.back().rows.back();
    set(row, row.at_worst, name, value, format);
  }
  Row& add_row(const char* what) { return sections_.back().rows.emplace_back(Row{what}); }
  void add_json(const char* name, Json value) { at(name) = std::move(value); }
  // Lines at the end of the section.
  void add_text(const std::string& lines) { sections_.back().text += lines; }

  [[nodiscard]] const Json& json() const { return json_; }
  [[nodiscard]] const Tally& tally() const { return tally_; }
  [[nodiscard]] std::string text() const {
    std::string text;
    for (const Section& section : sections_) text += text_of_section(section);
    return text;
  }

 private:
  struct Section {
    const char* heading;
    std::vector<Row> rows;
    std::string text;
  };

  Json& at(const std::string& name) {
    const std::size_t dot = name.find('.');
    if (dot == std::string::npos) return json_[name];
    return json_[name.substr(0, dot)][name.substr(dot + 1)];
  }

  template <class T>
  static std::optional<double> part(const std::optional<T>& value, double T::*member) {
    return value ? std::optional((*value).*member) : std::nullopt;
  }

  void set(Row& row, std::string& cell, const std::string& name, const std::optional<double>& value,
           const Format& format) {
    cell = value ? format.text(*value) : "-";
    if (!value) return;
    row.known = row.known || *value != 0 || &format != &kCount;  // 0 frames say nothing
    const Target* target = target_of(name, film_);
    if (target == nullptr) return;
    const bool met = target->bound == kAtMost ? *value <= target->value : *value >= target->value;
    row.met = row.met && met;
    ++tally_.stated;
    tally_.met += met ? 1 : 0;
    row.targets.push_back(fmt::format("{} {}{}", target->bound == kAtMost ? "at most" : "at least",
                                      format.of_target(target->value),
                                      &cell == &row.at_worst ? " at worst" : ""));
  }

  static std::string text_of_section(const Section& section) {
    const bool known = std::any_of(section.rows.begin(), section.rows.end(),
                                   [](const Row& row) { return row.known; });
    if (!known && section.text.empty()) {
      return fmt::format("\n{}: -, truth or result lacks the files for it\n", section.heading);
    }
    const bool any_worst = std::any_of(section.rows.begin(), section.rows.end(),
                                       [](const Row& row) { return !row.at_worst.empty(); });
    std::string text = "\n" + text_of(Row{section.heading, any_worst ? "typical" : "",
                                          any_worst ? "at worst" : ""})
                                  .substr(2);
    for (const Row& row : section.rows) text += text_of(row);
    return text + section.text;
  }

  std::string film_;
  Json json_;
  std::vector<Section> sections_;
  Tally tally_;
};

void add_touch(const BodyScores& body, Figures& f) {
  f.begin_section("touch, by frames");
  f.add("frames_touching", body.frames_touching, "frames with a true touch", kCount);
  f.add("touch_recall", body.touch_recall, "recall: true touches that are felt", kShare);
  f.add("touch_recall_3mm", body.touch_recall_3mm, "recall of those above 3 mm deep and seen",
        kShare);
  f.add("touch_precision", body.touch_precision, "precision: felt touches that are true", kShare);
  f.add("touch_false_discovery_5mm", body.touch_false_discovery_5mm,
        "felt touches with nothing within 5 mm", kShare);
  f.add("touch_site_accuracy", body.touch_site_accuracy, "share of them felt at the right site",
        kShare);
  f.add("first_touch_delay_frames", body.first_touch_delay_frames,
        "delay of the first touch (negative: too early)", kFrames);
  f.add("frames_too_deep", body.frames_too_deep, "frames too deep to be scored below", kCount);
  f.add("frames_touch_unseen", body.frames_touch_unseen,
        "frames whose touch no camera sees, not scored below", kCount);
}

void add_surface(const BodyScores& body, Figures& f) {
  f.begin_section("drawn surface");
  f.add("penetration_median_mm", body.penetration_median_mm,
        "penetration of the hand (median; 99 of 100)", kMm);
  f.add_at_worst("penetration_p99_mm", body.penetration_p99_mm, kMm);
  f.add("penetration_median_mm_unseen", body.penetration_median_mm_unseen,
        "penetration where no camera sees the touch (median)", kMm);
  f.add_row("largest jump from frame to frame, unexplained");
  f.add_at_worst("largest_jump_mm", body.largest_jump_mm, kMm);
  f.add_json("largest_jump_frame", body.largest_jump_frame);
  f.add("jumps_above_4mm", body.jumps_above_4mm, "jumps above 4 mm", kFrames);
}

Json json_of(const std::vector<ReferenceFrame>& by_frame) {
  Json frames = Json::array();
  for (const ReferenceFrame& frame : by_frame) {
    frames.push_back({{"frame", frame.frame},
                      {"displacement_error", frame.displacement_error},
                      {"max_vertex_error_mm", frame.max_vertex_error_mm},
                      {"von_mises_error", frame.von_mises_error},
                      {"force_error", frame.force_error}});
  }
  return frames;
}

// The same figures of deep touches that no camera sees.
void add_unseen(const std::optional<UnseenScores>& unseen, Figures& f) {
  if (!unseen) return f.add_json("unseen", nullptr);
  f.add("unseen.frames", std::optional(unseen->frames), "of these at least 4 mm deep", kCount);
  f.add("unseen.displacement_error", unseen->displacement_error,
        "their displacement, relative error", kPercent);
  f.add("unseen.max_vertex_error_mm", unseen->max_vertex_error_mm, "their worst vertex, error",
        kMm);
  f.add("unseen.von_mises_error", unseen->von_mises_error,
        "their von Mises stress, error of the worst vertex", kPercent);
  f.add("unseen.force_error", unseen->force_error, "their force, relative error", kPercent);
  f.add_json("unseen.errors_by_frame", json_of(unseen->by_frame));
}

void add_reference(const BodyScores& body, Figures& f) {
  f.begin_section("errors against finite elements (median; 90 of 100)");
  f.add("reference_frames", body.reference_frames, "frames, at least 4 mm deep and seen", kCount);
  f.add("displacement_error", body.displacement_error, "displacement, relative error", kPercent);
  f.add("max_vertex_error_mm", body.max_vertex_error_mm, "displacement of the worst vertex, error",
        kMm);
  f.add("von_mises_error", body.von_mises_error, "von Mises stress, error of the worst vertex",
        kPercent);
  f.add("force_error", body.force_error, "force, relative error", kPercent);
  f.add("excess_indentation_mm", body.excess_indentation_mm,
        "pressed in too far (median; 99 of 100)", kMm);
  f.add("reference_frames_shallow", body.reference_frames_shallow, "frames less than 4 mm deep",
        kCount);
  f.add("max_vertex_error_mm_shallow", body.max_vertex_error_mm_shallow,
        "their worst vertex, error", kMm);
  f.add("reference_frames_unseen", body.reference_frames_unseen,
        "frames whose touch no camera sees", kCount);
  f.add("max_vertex_error_mm_unseen", body.max_vertex_error_mm_unseen, "their worst vertex, error",
        kMm);
  f.add_json("errors_by_frame", body.reference_frames ? json_of(body.by_frame) : Json(nullptr));
  add_unseen(body.unseen, f);
}

void add_place(const BodyScores& body, Figures& f) {
  f.begin_section("place of the body");
  f.add("placement_error_mm", body.placement_error_mm, "off its true place (median; 90 of 100)",
        kMm);
}

void add_body(const BodyScores& body, Figures& f) {
  add_touch(body, f);
  add_surface(body, f);
  add_reference(body, f);
  add_place(body, f);
}

std::string depth_table(const ImageScores& images) {
  if (images.depth_frames == 0) return {};
  std::string text = "    at a distance of      median error   within 1 %\n";
  for (std::size_t k = 0; k < kDepthDistances.size(); ++k) {
    const DepthAtDistance& at = images.depth.at[k];
    if (!at.median_error || !at.within_1pct) continue;
    text += fmt::format("{:>18g} m{:>16.2f} %{:>11.1f} %\n", kDepthDistances[k],
                        100 * *at.median_error, 100 * *at.within_1pct);
  }
  return text;
}

void add_depth(const ImageScores& images, Figures& f) {
  const bool any = images.depth_frames > 0;
  const DepthScore& depth = images.depth;
  f.begin_section("depth");
  f.add("depth_frames", std::optional(images.depth_frames), "frames", kCount);
  const auto add_by_distance = [&](const char* name, std::optional<double> DepthAtDistance::*what) {
    Json by_distance;
    for (std::size_t k = 0; any && k < kDepthDistances.size(); ++k) {
      by_distance[fmt::format("{}", kDepthDistances[k])] = depth.at[k].*what;
    }
    f.add_json(name, by_distance);
  };
  add_by_distance("depth_error_median", &DepthAtDistance::median_error);
  add_by_distance("depth_within_1pct", &DepthAtDistance::within_1pct);
  add_by_distance("depth_density", &DepthAtDistance::density);
  f.add("hand_within_1pct", depth.hand_within_1pct, "pixels of a near hand within 1 %", kPercent);
  f.add_json("hand_near_frames", any ? Json(depth.near_frames) : Json(nullptr));
  f.add("too_close_called_far", depth.too_close_called_far,
        "pixels nearer than 0.11 m measured too far", kFinePercent);
  f.add_text(depth_table(images));
}

void add_occlusion(const ImageScores& images, Figures& f) {
  f.begin_section("occlusion of the body by real things");
  f.add("occlusion_frames", std::optional(images.occlusion_frames), "frames", kCount);
  f.add("occlusion_iou", images.occlusion_iou,
        "visible body, intersection over union (mean; worst)", kShare);
  f.add_at_worst("occlusion_iou_worst_frame", images.occlusion_iou_worst_frame, kShare);
  f.add("occlusion_iou_where_hidden", images.occlusion_iou_where_hidden,
        "the same where a part is hidden", kShare);
  f.add("edge_error_px", images.edge_error_px, "distance of drawn and true border", kPx);
  f.add("crossing_frames", std::optional(images.crossing_frames),
        "frames in which a hand crosses the outline", kCount);
  f.add("edge_error_crossing_px", images.edge_error_crossing_px, "distance of the borders in those",
        kPx);
  f.add("flicker", images.flicker, "flicker, of the pixels of two frames", kFinePercent);
}

void add_moving(const ImageScores& images, Figures& f) {
  f.begin_section("what moves");
  f.add("moving_iou", images.moving_iou, "intersection over union", kShare);
  f.add("moving_recall", images.moving_recall, "recall of its pixels", kShare);
  f.add("moving_false_positives", images.moving_false_positives, "false positives, of all pixels",
        kFinePercent);
}

void add_camera(const PathScores& path, const std::optional<double>& row_error_px, Figures& f) {
  f.begin_section("camera");
  f.add("trajectory_coverage", path.trajectory_coverage, "share of the path that was found",
        kShare);
  f.add("ate_mm", path.ate_mm, "absolute trajectory error, rms", kMm);
  f.add("rpe_mm", path.rpe_mm, "relative pose error over 1 s, rms", kMm);
  f.add("rpe_deg", path.rpe_deg, "the same, rotation", kDegrees);
  f.add_row("rows of the two views out of line");
  f.add_at_worst("row_error_px", row_error_px, kPx);
}

void add_speed(const RunSpeed& speed, Figures& f) {
  f.add_json("frames_per_s", speed.frames_per_second);
  f.add_json("cpu_ms_per_frame", speed.cpu_ms_per_frame);
  f.add_json("age_p50_ms", speed.age_p50_ms);
  f.add_json("age_p99_ms", speed.age_p99_ms);
}

Figures figures_of(const BodyScores& body, const std::string& film) {
  Figures f(film);
  add_body(body, f);
  return f;
}

Figures figures_of(const Scorecard& scores) {
  Figures f(scores.film);
  f.add_json("film", scores.film.empty() ? Json(nullptr) : Json(scores.film));
  f.add_json("frames", scores.frames);
  f.add_json("frames_processed", scores.frames_processed);
  add_speed(scores.speed, f);
  // Of several bodies each has its own figures: here are none.
  if (scores.bodies.empty()) {
    add_body(scores.body, f);
  } else {
    f.add_json("bodies", Json::object());
    f.begin_section("place of the first body");
  }
  f.add("jitter_mm", scores.jitter_mm, "jitter of the body in the world, rms", kMm);
  add_occlusion(scores.images, f);
  add_depth(scores.images, f);
  add_moving(scores.images, f);
  add_camera(scores.path, scores.row_error_px, f);
  if (scores.reduction_error) {
    f.begin_section("reduced model");
    f.add("reduction_error", scores.reduction_error,
          "displacement, relative error (pooled; worst snapshot)", kFinePercent);
    f.add_at_worst("reduction_error_worst", scores.reduction_error_worst, kFinePercent);
  }
  return f;
}

// The first three lines of a score.
std::string summary(const std::string& compared, const std::string& accuracy,
                    const RunSpeed& speed) {
  std::string fast = "not stated by the result";
  if (speed.frames_per_second) {
    fast = fmt::format("{:.1f} frames/s", *speed.frames_per_second);
    if (speed.cpu_ms_per_frame) {
      fast += fmt::format(", {:.1f} ms of CPU per frame", *speed.cpu_ms_per_frame);
    }
    if (speed.age_p50_ms && speed.age_p99_ms) {
      fast += fmt::format(", picture shown after {:.0f} ms in the median ({:.0f} ms in 99 of 100)",
                          *speed.age_p50_ms, *speed.age_p99_ms);
    }
    if (speed.dropped) fast += fmt::format(", {} frames dropped", *speed.dropped);
  }
  std::string text =
      fmt::format("compared: {}\naccuracy: {}\nspeed:    {}\n", compared, accuracy, fast);
  if (speed.ringing) {
    text += "note:     bodies had inertia, and the truth is static: play it with --dynamics off\n";
  }
  return text;
}

// What a person wants to know of a body: the errors of shape and force, and whether touches are
// felt.
void append_accuracy(const BodyScores& body, std::vector<std::string>& parts) {
  const std::string name = body.name.empty() ? "" : body.name + ": ";
  const auto& shape = body.displacement_error;
  const auto& force = body.force_error;
  if (body.reference_frames && shape) {
    std::string text = fmt::format("{}shape off by {:.0f} % in the median ({:.0f} % in 9 of 10)",
                                   name, 100 * shape->median, 100 * shape->p90);
    if (force) {
      text += fmt::format(", force by {:.0f} % ({:.0f} %)", 100 * force->median, 100 * force->p90);
    }
    parts.push_back(
        text + fmt::format(", against full finite elements ({} frames)", *body.reference_frames));
  }
  if (body.touch_recall && body.touch_precision) {
    parts.push_back(fmt::format("{}touch recall {:.2f}, precision {:.2f}", name, *body.touch_recall,
                                *body.touch_precision));
  }
}

std::string accuracy_of(const Scorecard& scores, const Tally& tally) {
  std::vector<std::string> parts;
  append_accuracy(scores.body, parts);
  for (const BodyScores& body : scores.bodies) append_accuracy(body, parts);
  if (parts.empty() && scores.images.occlusion_iou) {
    parts.push_back(
        fmt::format("visible body, intersection over union {:.3f}", *scores.images.occlusion_iou));
  }
  if (parts.empty() && scores.images.depth.hand_within_1pct) {
    parts.push_back(fmt::format("{:.1f} % of a near hand's pixels within 1 % of their depth",
                                100 * *scores.images.depth.hand_within_1pct));
  }
  if (parts.empty() && scores.path.ate_mm) {
    parts.push_back(fmt::format("camera's path off by {:.1f} mm rms", *scores.path.ate_mm));
  }
  if (parts.empty()) parts.emplace_back("no touch, picture or path to judge");
  if (tally.stated > 0) {
    parts.push_back(fmt::format("{} of {} targets met", tally.met, tally.stated));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

Figures figures_of(const PoseScores& scores) {
  Figures f({});
  f.add_json("format", scores.format);
  f.add_json("poses_of", scores.of);
  f.add_json("poses_published", scores.published);
  f.add_json("poses_found", scores.found);
  f.add_json("poses_matched", scores.matched);
  f.add_json("seconds", scores.seconds);
  f.begin_section("camera");
  f.add("path_m", std::optional(scores.path_m), "length of the published path", {2, " m"});
  f.add("ate_mm", std::optional(scores.ate_mm), "absolute trajectory error, rms", {1, " mm"});
  f.add("rpe_mm", scores.rpe_mm, "relative pose error over 1 s, rms", {1, " mm"});
  f.add("rpe_deg", scores.rpe_deg, "the same, rotation", kDegrees);
  f.add("end_error_percent", scores.end_error_percent, "drift at the end, of the path's length",
        {2, " %"});
  add_speed(scores.speed, f);
  return f;
}

}  // namespace

Json json_of(const Scorecard& scores) {
  Json json = figures_of(scores).json();
  for (const BodyScores& body : scores.bodies) {
    json["bodies"][body.name] = figures_of(body, scores.film).json();
  }
  return json;
}

Json json_of(const PoseScores& scores) { return figures_of(scores).json(); }

std::string text_of(const Scorecard& scores) {
  const Figures figures = figures_of(scores);
  Tally tally = figures.tally();
  std::string text;
  for (const BodyScores& body : scores.bodies) {
    const Figures of_body = figures_of(body, scores.film);
    tally.met += of_body.tally().met;
    tally.stated += of_body.tally().stated;
    text += "\n== " + body.name + "\n" + of_body.text();
  }
  if (!scores.bodies.empty()) text += "\n== all bodies\n";
  const std::string compared =
      fmt::format("{} with the truth in {}{}, {} of {} frames processed", scores.result,
                  scores.truth, scores.film.empty() ? "" : " (film " + scores.film + ")",
                  scores.frames_processed, scores.frames);
  return summary(compared, accuracy_of(scores, tally), scores.speed) + text + figures.text();
}

std::string text_of(const PoseScores& scores) {
  const std::string compared = fmt::format(
      "{} of {} found poses with {} published ones ({}, of the {}) over {:.2f} s", scores.matched,
      scores.found, scores.published, scores.format, scores.of, scores.seconds);
  std::string accuracy =
      fmt::format("position off by {:.1f} mm rms after alignment", scores.ate_mm);
  if (scores.end_error_percent) {
    accuracy +=
        fmt::format(", end of the path by {:.2f} % of its length", *scores.end_error_percent);
  }
  return summary(compared, accuracy, scores.speed) + figures_of(scores).text();
}

}  // namespace palpable
