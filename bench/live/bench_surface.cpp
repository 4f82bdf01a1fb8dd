// palpable bench surface: compares the measured surface of objects with the true objects of
// synthetic clips.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/installed.h"
#include "palpable/common/base/allocation_count.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/desk/clip_writer/desk_film.h"
#include "palpable/desk/clip_writer/sequence_folder.h"
#include "palpable/desk/script/desk_body.h"
#include "palpable/live/player/live_run.h"
#include "palpable/live/seen_object/object_surface.h"

#include <fmt/core.h>

#include "bench/live/bench.h"
#include "bench/live/seen_before.h"
#include "bench/live/surface_budget.h"
#include "bench/live/thing_points.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kNearBody = 0.015;      // m, the unseen side is judged up to this distance
constexpr double kPointSpacing = 0.002;  // m, between points of the unseen side and of the skin
constexpr double kGhostNear = 0.005;     // m: a ghost is measured nearer to the body than this
constexpr double kGhostFar = 0.010;      // m: while every true surface is farther than this
constexpr double kMissed = 0.002;        // m: a missed touch penetrates at least this deep
constexpr double kSeen = 0.5;     // share of a touch that must be visible for it to count as missed
constexpr int kRemembered = 90;   // frames, 3 s: what the camera saw no longer ago is told apart
constexpr int kRememberStep = 5;  // frames; a thing that turns once in 4 s turns by 15 degrees
constexpr int kDenseQueries = 22982;  // vertices of the paper's dragon
constexpr int kBunnyQueries = 7000;

// Things that are judged, and the sequence that shows them.
constexpr std::array<std::array<const char*, 2>, 6> kThings{{{"finger", "press"},
                                                             {"palm", "palm"},
                                                             {"pencil", "pencil"},
                                                             {"cup", "cup"},
                                                             {"turned_pencil", "pencil-turn"},
                                                             {"turned_cup", "cup-turn"}}};

struct SurfaceBenchOptions {
  fs::path body;
  fs::path films;
  std::vector<std::string> only{"press",     "pencil",      "palm",      "cup",
                                "two-hands", "textureless", "walk-hand", "rest"};
  std::uint64_t seed = 0;  // 0: a held-out one for each clip
  int frames = 0;          // 0: the sequence's own number
  int every = 5;
  bool budget = false;
  bool json = false;
};

// Half the width that holds 68 of 100 values: one standard deviation of a normal distribution.
double spread_of(const std::vector<double>& values) {
  return (percentile(values, 0.84) - percentile(values, 0.16)) / 2;
}

// Errors of a side of the seen surface.
struct SideErrors {
  std::vector<double> errors;  // m, of points for which a surface was assumed
  std::vector<double> signed_errors;
  std::size_t points = 0;

  void add(const ObjectSurface& surface, const Vector3d& in_body) {
    ++points;
    const auto found = surface.nearest(in_body.cast<float>());
    if (!found) return;
    signed_errors.push_back(static_cast<double>(found->distance));
    errors.push_back(std::abs(signed_errors.back()));
  }
  [[nodiscard]] Json quantile_mm(double share) const {
    return errors.empty() ? Json(nullptr) : Json(1e3 * percentile(errors, share));
  }
  [[nodiscard]] Json spread_mm() const {
    return errors.empty() ? Json(nullptr) : Json(1e3 * spread_of(signed_errors));
  }
  /// Positive: the seen thing is too thin, or too far.
  [[nodiscard]] Json bias_mm() const {
    return errors.empty() ? Json(nullptr) : Json(1e3 * percentile(signed_errors, 0.5));
  }
  [[nodiscard]] Json coverage() const {
    return points == 0 ? Json(nullptr)
                       : Json(static_cast<double>(errors.size()) / static_cast<double>(points));
  }
};

// Errors by the side of the thing. The unseen side is `back` and what is behind other things, of
// which a single view gives no information.
struct ErrorsByPlace {
  SideErrors front, ends, unseen, back;
  SideErrors seen_before, never_seen;  // parts of `unseen`, by the last 3 s of the film
  std::vector<double> outline_px;      // positive: the seen thing is too narrow

  // @param was_seen  by point: whether the camera saw it before
  void add(const ObjectSurface& surface, const ThingPoints& points,
           const std::vector<bool>& was_seen, const PinholeCamera& camera,
           const Rigid3& body_from_camera) {
    for (std::size_t p = 0; p < points.size(); ++p) {
      const ThingPoint& point = points[p];
      const Vector3d x = body_from_camera * point.x;
      if (point.side == Side::kFront) front.add(surface, x);
      if (point.side == Side::kFront && point.is_end) ends.add(surface, x);
      if (point.side != Side::kFront) unseen.add(surface, x);
      if (point.side == Side::kBack) back.add(surface, x);
      if (point.side != Side::kFront) (was_seen[p] ? seen_before : never_seen).add(surface, x);
      if (!point.is_outline) continue;
      const auto found = surface.nearest(x.cast<float>());
      if (!found) continue;
      outline_px.push_back(static_cast<double>(found->distance) * camera.fx_px / point.x.z());
    }
  }
  [[nodiscard]] Json behind_share() const {
    if (unseen.points == 0) return nullptr;
    return 1 - static_cast<double>(back.points) / static_cast<double>(unseen.points);
  }
};

Json seen_before_share(const ErrorsByPlace& errors) {
  if (errors.unseen.points == 0) return nullptr;
  return static_cast<double>(errors.seen_before.points) / static_cast<double>(errors.unseen.points);
}

struct Counts {
  int frames = 0, ghosts = 0, deep = 0, missed = 0;
  ErrorsByPlace measured, true_depth;
  Json budget;
  std::vector<double> plane;  // m, of a held touch: error of phi at the touched point
  double cpu_s = 0, dense_cpu_s = 0;
  int timed = 0, allocations = 0;
  double max_difference = 0;

  // Adds the counts of another clip, except those of the sides, which are
  // judged for each thing.
  void add(const Counts& other) {
    frames += other.frames, ghosts += other.ghosts;
    deep += other.deep, missed += other.missed;
    cpu_s += other.cpu_s, dense_cpu_s += other.dense_cpu_s, timed += other.timed;
    allocations = std::max(allocations, other.allocations);
    max_difference = std::max(max_difference, other.max_difference);
  }
};

// Data that are constant during a clip.
struct Judge {
  fs::path file;
  const ReducedBody& body;
  SurfaceDistance distance;
  Eigen::Matrix3Xf skin, some, many;  // body frame
  Eigen::AlignedBox3d region;
};

Eigen::Matrix3Xf spread(const Eigen::Matrix3Xd& points, int count) {
  Eigen::Matrix3Xf some(3, count);
  for (int k = 0; k < count; ++k) {
    some.col(k) = points.col((static_cast<Eigen::Index>(k) * 7919) % points.cols()).cast<float>();
  }
  return some;
}

double least_phi(const ObjectSurface& surface, const Eigen::Matrix3Xf& points) {
  double least = surface.settings().band;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const auto found = surface.nearest(points.col(k));
    if (found) least = std::min(least, static_cast<double>(found->distance));
  }
  return least;
}

// The truth of one clip.
struct SurfaceFilm {
  fs::path folder;
  TruthCamera camera;
  std::vector<HandLine> hands;
  std::vector<ContactLine> contacts;
  std::vector<StampedPose> path;  // world_from_camera

  explicit SurfaceFilm(const fs::path& of)
      : folder(of),
        camera(read_truth_camera(of / "truth/camera.toml")),
        hands(read_hands(of / "truth/hand.jsonl")),
        contacts(read_contacts(of / "truth/contact.jsonl")),
        path(read_trajectory(of / "truth/trajectory.txt")) {
    if (hands.size() != contacts.size() || hands.size() != path.size())
      throw Error(of.string() + ": its truth is not whole");
  }
};

bool is_near_body(const ContactLine& contact) {
  return contact.touching || (contact.gap && *contact.gap < kNearBody);
}

// For each point of the things in a frame whether the camera saw it in the last 3 s.
std::vector<bool> was_seen_in(const SurfaceFilm& film, int frame, const ThingPoints& points) {
  std::vector<std::span<const Capsule>> earlier;
  for (int n = frame - kRememberStep; n >= std::max(0, frame - kRemembered); n -= kRememberStep)
    if (!film.hands[n].capsules.empty()) earlier.emplace_back(film.hands[n].capsules);
  return seen_before(points, film.hands[frame].capsules, earlier, *film.camera.camera);
}

void look_at_sides(const Judge& judge, const SurfaceFilm& film, int frame,
                   const ObjectSurface& measured, const Rigid3& body_from_camera, Counts& counts) {
  const PinholeCamera& camera = *film.camera.camera;
  const ThingPoints points = points_of_things(film.hands[frame].capsules, camera, body_from_camera,
                                              judge.distance, kNearBody, kPointSpacing);
  const std::vector<bool> was_seen = was_seen_in(film, frame, points);
  counts.measured.add(measured, points, was_seen, camera, body_from_camera);
  const auto view = read_true_view(film.folder / "truth", frame, film.camera.depth_unit);
  if (!view) return;
  ObjectSurface surface;
  surface.build(view->depth, view->shows, camera, body_from_camera, judge.region);
  counts.true_depth.add(surface, points, was_seen, camera, body_from_camera);
}

// Adds a frame to the budget. The film's true path starts at its first frame, as the run's does.
void add_to_budget(SurfaceBudget& budget, const SurfaceFilm& film, const Scene& scene,
                   const Rigid3& body_from_first_camera) {
  const int n = scene.number;
  const auto view = read_true_view(film.folder / "truth", n, film.camera.depth_unit);
  if (!view) throw Error(film.folder.string() + ": its truth is not whole");
  const Rigid3 first_from_camera = film.path.front().world_from_camera.inverse() *
                                   film.path[static_cast<std::size_t>(n)].world_from_camera;
  budget.add(scene, film.hands[n], film.contacts[n], *view,
             body_from_first_camera * first_from_camera);
}

void time_surface(const Judge& judge, const Scene& scene, const Session& session,
                  ObjectSurface& surface, Counts& counts) {
  const auto once = [&](const Eigen::Matrix3Xf& points, double& sum) {
    const CpuTimer timer(sum);
    surface.build(scene.seen.depth, session.shows(), scene.seen.depth_camera,
                  scene.bodies.front().camera_from_body.inverse(), judge.region, scene.time,
                  session.coverage());
    (void)least_phi(surface, points);
  };
  once(judge.some, counts.cpu_s);
  // Allocations are counted in the second call, which needs no more memory than the first.
  counts.allocations = std::max(counts.allocations,
                                allocations_during([&] { once(judge.many, counts.dense_cpu_s); }));
  ++counts.timed;
  for (Eigen::Index k = 0; k < judge.some.cols(); k += 97) {
    const auto a = surface.nearest(judge.some.col(k));
    const auto b = surface.nearest_by_brute_force(judge.some.col(k));
    const double da = a ? static_cast<double>(a->distance) : surface.settings().band;
    const double db = b ? static_cast<double>(b->distance) : surface.settings().band;
    counts.max_difference = std::max(counts.max_difference, std::abs(da - db));
  }
}

// The point of a held touch does not move, so that phi there varies only with the measurement.
void look_at_held_touch(const SurfaceFilm& film, int frame, const ObjectSurface& surface,
                        const Rigid3& body_from_camera, std::optional<Vector3d>& held,
                        Counts& counts) {
  const ContactLine& contact = film.contacts[frame];
  if (!contact.touching || !contact.point) return;
  if (!held) held = contact.point;
  const auto found = surface.nearest(held->cast<float>());
  if (!found) return;
  const double truth =
      signed_distance(film.hands[frame].capsules, body_from_camera.inverse() * *held);
  counts.plane.push_back(static_cast<double>(found->distance) - truth);
}

Counts play_film(const SurfaceBenchOptions& options, const std::string& name,
                 const SurfaceFilm& film, const Judge& judge, ProgressBar& bar) {
  Counts counts;
  LiveSettings settings;
  settings.images.device = (film.folder / "frames").string();
  // Tables are read for the budget alone: without them the body is pressed at its sites, which does
  // not change what is seen.
  LiveRun run = options.budget
                    ? open_live(value_or_throw(read_touchable_body(judge.file)), settings)
                    : open_live(judge.body, settings);
  const ObjectSurface& surface = run.loop.session.body().response.surface();
  ObjectSurface timed(surface.settings());
  Frame frame;
  std::optional<Vector3d> held;
  std::optional<SurfaceBudget> budget;
  std::optional<Rigid3> first;  // body_from_camera of the first frame
  if (options.budget) budget.emplace(run.loop.session);
  for (FrameStatus status = run.source->next(frame); status != FrameStatus::kEnd;
       status = run.source->next(frame)) {
    if (status != FrameStatus::kFrame) continue;
    const int n = frame.number;
    const Scene& scene = run.loop.process(frame);
    const Rigid3 body_from_camera = scene.bodies.front().camera_from_body.inverse();
    const ContactLine& contact = film.contacts[n];
    if (!first) first = body_from_camera;
    if (budget) add_to_budget(*budget, film, scene, *first);
    ++counts.frames;
    const double least = least_phi(surface, judge.skin);
    const bool nothing = !contact.touching && (!contact.gap || *contact.gap > kGhostFar);
    counts.ghosts += nothing && least < kGhostNear;
    if (contact.touching && contact.depth >= kMissed && contact.seen_share.value_or(1) >= kSeen) {
      ++counts.deep;
      counts.missed += least > 0;
    }
    if (name == "rest") look_at_held_touch(film, n, surface, body_from_camera, held, counts);
    if (is_near_body(contact) && n % options.every == 0) {
      look_at_sides(judge, film, n, surface, body_from_camera, counts);
      time_surface(judge, scene, run.loop.session, timed, counts);
    }
    bar.show(
        {name, static_cast<double>(counts.frames), static_cast<double>(film.hands.size()), ""});
  }
  if (budget) counts.budget = budget->json();
  return counts;
}

double deviation(const std::vector<double>& values) {
  double mean = 0, square = 0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  for (const double v : values) square += (v - mean) * (v - mean);
  return std::sqrt(square / static_cast<double>(values.size()));
}

int full_length(const std::string& name) {
  for (const SequenceKind& kind : sequence_kinds()) {
    if (kind.name == name) return kind.frames;
  }
  throw Error(fmt::format("--only {}: there is no such sequence; synth --help lists them", name));
}

fs::path filmed(const SurfaceBenchOptions& options, const std::string& name, std::uint64_t seed,
                const ReducedBody& body, const std::string& body_name, ProgressBar& bar) {
  const fs::path folder = options.films / fmt::format("{}-{}", name, seed);
  if (!fs::exists(folder / "truth/camera.toml")) {
    const int frames = options.frames > 0 ? options.frames : full_length(name);
    write_sequence(body, {name, frames, seed, body_name, 2}, folder, bar.progress());
  }
  return folder;
}

Json share(int part, int whole) {
  return whole == 0 ? Json(nullptr) : Json(static_cast<double>(part) / whole);
}

Json ms(double cpu_s, int times) { return times == 0 ? Json(nullptr) : Json(1e3 * cpu_s / times); }

Json sigma_mm(const std::vector<double>& plane) {
  return plane.empty() ? Json(nullptr) : Json(1e3 * deviation(plane));
}

// Figures that are given for each clip and for all clips together.
void add_pooled(const Counts& c, Json& entry) {
  entry["ghost_share"] = share(c.ghosts, c.frames);
  entry["missed_share"] = share(c.missed, c.deep);
  entry["ms_bunny"] = ms(c.cpu_s, c.timed);
  entry["ms_22982"] = ms(c.dense_cpu_s, c.timed);
  entry["max_difference_m"] = c.max_difference;
  entry["hot_allocations"] = c.allocations;
}

Json entry_of(const Counts& c, std::uint64_t seed) {
  Json entry;
  entry["seed"] = seed;
  entry["frames"] = c.frames;
  entry["frames_deep"] = c.deep;
  add_pooled(c, entry);
  entry["unseen_side_behind_share"] = c.measured.behind_share();
  const auto add_side = [&entry](const std::string& side, const SideErrors& of) {
    entry[side + "_median_mm"] = of.quantile_mm(0.5);
    entry[side + "_p90_mm"] = of.quantile_mm(0.9);
    entry[side + "_bias_mm"] = of.bias_mm();
    entry[side + "_coverage"] = of.coverage();
  };
  add_side("unseen_side", c.measured.unseen);
  add_side("unseen_side_true_depth", c.true_depth.unseen);
  entry["unseen_seen_before_share"] = seen_before_share(c.measured);
  add_side("unseen_seen_before", c.measured.seen_before);
  add_side("unseen_seen_before_true_depth", c.true_depth.seen_before);
  add_side("unseen_never_seen", c.measured.never_seen);
  add_side("back", c.measured.back);
  add_side("back_true_depth", c.true_depth.back);
  add_side("front", c.measured.front);
  entry["front_spread_mm"] = c.measured.front.spread_mm();
  add_side("end", c.measured.ends);
  entry["end_spread_mm"] = c.measured.ends.spread_mm();
  const std::vector<double>& outline = c.measured.outline_px;
  entry["outline_px"] = outline.empty() ? Json(nullptr) : Json(percentile(outline, 0.5));
  entry["outline_spread_px"] = outline.empty() ? Json(nullptr) : Json(spread_of(outline));
  if (!c.budget.is_null()) entry["budget"] = c.budget;
  entry["contact_plane_sigma_mm"] = sigma_mm(c.plane);
  return entry;
}

// The figures of the summary: those of the sides for each thing, the others for all clips together.
void summarize(const std::map<std::string, Counts>& counts, Json& result) {
  for (const auto& [thing, sequence] : kThings) {
    const auto found = counts.find(sequence);
    const Counts c = found == counts.end() ? Counts{} : found->second;
    const Json entry = entry_of(c, 0);
    for (const char* key :
         {"unseen_side_median_mm", "unseen_side_p90_mm", "unseen_side_coverage",
          "unseen_side_true_depth_median_mm", "unseen_side_true_depth_p90_mm",
          "unseen_seen_before_median_mm", "unseen_seen_before_p90_mm", "unseen_seen_before_share",
          "front_median_mm", "front_p90_mm", "front_bias_mm", "front_spread_mm", "end_bias_mm",
          "end_spread_mm", "outline_px", "outline_spread_px"}) {
      result[key][thing] = entry[key];
    }
  }
  Counts all;
  for (const auto& [name, c] : counts) {
    if (name != "dark") all.add(c);
  }
  add_pooled(all, result);
  const auto rest = counts.find("rest");
  result["contact_plane_sigma_mm"] =
      rest == counts.end() ? Json(nullptr) : sigma_mm(rest->second.plane);
}

// The key of a clip's figure and the column in which it is listed.
constexpr std::array<std::array<const char*, 2>, 26> kColumns{{
    {"ghosts", "ghost_share"},
    {"missed", "missed_share"},
    {"front", "front_median_mm"},
    {"p90", "front_p90_mm"},
    {"bias", "front_bias_mm"},
    {"spread", "front_spread_mm"},
    {"end", "end_bias_mm"},
    {"line px", "outline_px"},
    {"side", "unseen_side_median_mm"},
    {"p90", "unseen_side_p90_mm"},
    {"cover", "unseen_side_coverage"},
    {"behind", "unseen_side_behind_share"},
    {"before", "unseen_seen_before_share"},
    {"side", "unseen_seen_before_median_mm"},
    {"p90", "unseen_seen_before_p90_mm"},
    {"back", "back_median_mm"},
    {"bias", "back_bias_mm"},
    {"p90", "back_p90_mm"},
    {"cover", "back_coverage"},
    {"true d.", "back_true_depth_median_mm"},
    {"bias", "back_true_depth_bias_mm"},
    {"p90", "back_true_depth_p90_mm"},
    {"cover", "back_true_depth_coverage"},
    {"plane", "contact_plane_sigma_mm"},
    {"ms", "ms_bunny"},
    {"ms 23k", "ms_22982"},
}};

void print_surface_table(const Json& sequences) {
  fmt::print("{:<12} {:>6}", "sequence", "frames");
  for (const auto& [title, key] : kColumns) fmt::print(" {:>7}", title);
  fmt::print("\n");
  for (const auto& [name, entry] : sequences.items()) {
    fmt::print("{:<12} {:>6}", name, entry["frames"].get<int>());
    for (const auto& [title, key] : kColumns) {
      const Json& value = entry[key];
      fmt::print(" {:>7}",
                 value.is_null() ? std::string("-") : fmt::format("{:.3f}", value.get<double>()));
    }
    fmt::print("\n");
  }
  fmt::print(
      "front: what the camera sees within 15 mm of the body, mm off. bias: its median, positive: "
      "the\n"
      "thing is too far. end: the bias at fingertips and other ends. line px: its outline, "
      "positive:\n"
      "the thing is too narrow. side: what no camera sees, mm off. behind: the share of it that "
      "lies behind other things,\n"
      "of which one view says nothing. before: the share of the side that the camera saw in the\n"
      "last 3 s, and how far off that part is. back: what is not behind, by measured and by true\n"
      "depth (true d.).\n");
}

void print_budget(const Json& sequences) {
  fmt::print(
      "\nError of the displacement, and of the force's size, by camera, %: median (90th "
      "percentile),\n"
      "against the same tables under the true hand, if this were perfect:\n{:<30}",
      "");
  for (const auto& [name, entry] : sequences.items()) fmt::print(" {:>25}", name);
  fmt::print("\n{:<30}", "frames");
  for (const auto& [name, entry] : sequences.items()) {
    fmt::print(" {:>25}", entry["budget"]["frames"].get<int>());
  }
  for (const BudgetLine& line : budget_lines()) {
    fmt::print("\n{:<30}", line.words);
    for (const auto& [name, entry] : sequences.items()) {
      const Json& of = entry["budget"][std::string(line.key)];
      const auto percent = [&of](const char* key) {
        return of[key].is_null() ? std::string("-")
                                 : fmt::format("{:.0f}", 100 * of[key].get<double>());
      };
      fmt::print(" {:>25}", fmt::format("{} ({}), force {} ({})", percent("displacement_median"),
                                        percent("displacement_p90"), percent("force_median"),
                                        percent("force_p90")));
    }
  }
  fmt::print("\n");
}

void bench_surface(SurfaceBenchOptions options) {
  const fs::path body_file = options.body.empty() ? default_body() : options.body;
  const ReducedBody body = value_or_throw(read_pressable_body(body_file));
  if (options.films.empty()) options.films = fs::temp_directory_path() / "palpable-bench-films";
  const SurfacePoints skin = sample_surface(body.surface, kPointSpacing);
  const SurfacePoints fine = sample_surface(body.surface, kPointSpacing / 2);
  const Judge judge{
      body_file,
      body,
      SurfaceDistance(body.surface),
      skin.points.cast<float>(),
      spread(fine.points, kBunnyQueries),
      spread(fine.points, kDenseQueries),
      {body.surface.vertices.rowwise().minCoeff(), body.surface.vertices.rowwise().maxCoeff()}};
  if (options.budget && !value_or_throw(read_touchable_body(body_file)).touch) {
    throw Error(fmt::format(
        "{}: it has no tables of touch, which --budget needs; palpable bake makes them ([touch])",
        body_file.string()));
  }
  std::random_device random;
  ProgressBar bar;
  Json result, sequences;
  std::map<std::string, Counts> counts;
  for (const std::string& name : options.only) {
    // Seeds from 1000 on are held out: no parameter is tuned with them.
    const std::uint64_t seed = options.seed > 0 ? options.seed : 1000 + random() % 999'000;
    const SurfaceFilm film(filmed(options, name, seed, body, body_file.stem().string(), bar));
    counts[name] = play_film(options, name, film, judge, bar);
    sequences[name] = entry_of(counts[name], seed);
  }
  bar.finish();
  result["bench"] = "surface";
  result["body"] = body_file.string();
  summarize(counts, result);
  result["sequences"] = sequences;
  if (options.json) {
    fmt::print("{}\n", result.dump(2));
  } else {
    print_surface_table(sequences);
    if (options.budget) print_budget(sequences);
  }
}

}  // namespace

void add_bench_surface(Command bench) {
  auto options = std::make_shared<SurfaceBenchOptions>();
  Command command = bench.add_subcommand("surface",
                                         "The seen surface against the true things of films: "
                                         "front, ends, unseen side, ghosts, misses");
  command.add_option("body", options->body, "Body file")
      .default_is("build/bodies/bunny-dense.palpable, else out/demo/bunny.palpable");
  command.add_option("--only", options->only, "Sequences (synth --help lists them)")
      .type_name("NAME")
      .show_default();
  command.add_option("--seed", options->seed, "Of all films (0: a held-out one for each)")
      .in_range(std::uint64_t{0}, kLargestSeed)
      .show_default();
  command.add_option("--frames", options->frames, "Of each film (0: its full length)")
      .in_range(0, 100000)
      .show_default();
  command
      .add_option("--every", options->every,
                  "Interval of frames in which the sides of things are judged")
      .in_range(1, 1000)
      .show_default();
  command.add_flag(
      "--budget", options->budget,
      "Also the displacement error with each part of the surface made perfect in turn");
  command.add_option("--films", options->films, "Folder in which films are kept and found again")
      .type_name("DIR")
      .default_is("a temporary one");
  command.add_json(options->json);
  command.footer(
      "Example: palpable bench surface out/demo/bunny.palpable --seed 1 --only press palm");
  command.callback([options] { bench_surface(*options); });
}

}  // namespace palpable::app
