#include "palpable/bake/truth/true_skins.h"

#include "palpable/bake/campaign/fill_store.h"
#include "palpable/bake/campaign/press_solver.h"
#include "palpable/bake/campaign/solid_file.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/bake/truth/episodes.h"
#include "palpable/bake/truth/friction_choice.h"
#include "palpable/bake/truth/hand_walks.h"
#include "palpable/bake/truth/problem_note.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/folder_lock.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/body_file/body_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3Xd;

// Largest depth of a touch that is solved, ratio to the body's height; a deeper hand passes
// through.
constexpr double kDeepest = 0.1;
// Depth (m) from which a touch must reach the body's skin. If it does not, the clip is of another
// body.
constexpr double kSurelyTouches = 2e-3;

// Largest distance between vertices of two skins that count as the same, ratio to the body's
// height. A preloaded skin at rest is solved to this accuracy; without preload, equal skins are
// equal to the bit.
constexpr double kSameTrueSkin = 1e-6;

class TrueSkins {
 public:
  TrueSkins(const fs::path& clip, const BodyDescription& description,
            const TrueSkinSettings& settings, const Progress& progress)
      : folder_(clip / "truth" / "deformed"),
        settings_(settings),
        progress_(progress),
        problem_(pose_body(description)),
        solver_(problem_.model),
        presses_(solver_, problem_.preload),
        has_usual_range_(description.press.has_usual_range()) {
    for (const int node : problem_.mesh.boundary.node_of_vertex) skin_.push_back(node);
    if (!settings.baked.empty()) check_baked(settings.baked, description);
  }

  std::vector<TrueFrame> write(const fs::path& clip) {
    hands_ = read_clip_hands(clip);
    find_episodes(1);
    if (episodes_.empty()) {
      throw Error(fmt::format("{}: nothing touches the body in this clip",
                              (clip / "truth" / "contact.jsonl").string()));
    }
    check_filmed(clip / "truth" / kBodySkinFile);
    check_body(clip);
    make_folder(folder_);
    const FolderLock lock(folder_);
    write_rest();
    friction_ = choose_friction(clip, settings_.friction, {folder_});
    if (friction_ > 0.0) find_episodes(kFramesBetweenTouches);
    check_same(clip);
    leave_out_known();
    follow_hand(solver_, hands_, episodes_,
                {.contact = {.friction = friction_},
                 .preloaded = presses_.preloaded(),
                 .threads = settings_.threads},
                progress_,
                [this](const Episode& episode, const Walked& fine, const Walked& coarse) {
                  keep(episode, fine, coarse);
                });
    std::vector<TrueFrame> frames;
    for (auto& [frame, found] : found_) frames.push_back(std::move(found));
    return frames;
  }

 private:
  void find_episodes(int apart) {
    episodes_ =
        episodes_of(hands_.contacts, settings_.frames, kDeepest * problem_.mesh.height, apart);
  }

  // Throws Error for a skin that is not the one that is solved here. @param what  names its source
  void expect_same_skin(const SurfaceMesh& there, const std::string& what) const {
    const Matrix3Xd here = rest_skin();
    const auto& triangles = problem_.mesh.boundary.surface.triangles;
    double off = std::numeric_limits<double>::infinity();
    if (there.vertices.cols() == here.cols() && there.triangles.cols() == triangles.cols() &&
        there.triangles == triangles) {
      off = (there.vertices - here).colwise().norm().maxCoeff();
    }
    if (off <= kSameTrueSkin * problem_.mesh.height) return;
    const std::string how =
        std::isfinite(off)
            ? fmt::format("its vertices lie up to {:.3g} mm elsewhere", 1e3 * off)
            : fmt::format("it has {} vertices and {} triangles, this one {} and {}, or others",
                          there.vertices.cols(), there.triangles.cols(), here.cols(),
                          triangles.cols());
    throw Error(fmt::format(
        "{}: the description makes another skin ({}); give the description that it was baked from, "
        "or bake and film anew",
        what, how));
  }

  // Compares with the skin of the body that was filmed, if the clip has it; older clips do not.
  void check_filmed(const fs::path& skin) const {
    std::error_code error;
    if (!fs::exists(skin, error)) return;
    expect_same_skin(value_or_throw(read_valued_ply(skin, kVonMisesProperty)).surface,
                     skin.string());
  }

  void check_baked(const fs::path& baked, const BodyDescription& description) const {
    const ReducedBody body = value_or_throw(read_body_file(baked));
    expect_same_skin(body.surface, baked.string());
    const std::optional<StoreContent> kept = solid_beside(baked, body.method);
    if (!kept) return;
    const std::string how = solids_differ(*kept, content_of(description, problem_));
    if (how.empty()) return;
    throw Error(
        fmt::format("{}: was baked from {}; give the description that it was baked from, "
                    "or bake and film anew",
                    baked.string(), how));
  }

  // The deepest touch of the clip must reach this body's skin.
  void check_body(const fs::path& clip) const {
    int frame = episodes_.front().wanted.front();
    for (const Episode& episode : episodes_) {
      for (const int n : episode.wanted) {
        if (hands_.contacts[n].depth > hands_.contacts[frame].depth) frame = n;
      }
    }
    if (hands_.contacts[frame].depth < kSurelyTouches) return;
    const ObstacleGaps gaps(Obstacle{.capsules = hands_.capsules[frame]});
    const Matrix3Xd skin = rest_skin();
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& x : skin.colwise()) nearest = std::min(nearest, gaps.distance(x));
    if (nearest > 0.5 * problem_.mesh.height * kDeepest) {
      throw Error(fmt::format(
          "{}: frame {} touches {:.1f} mm deep, but stays {:.1f} mm off this body: the clip was "
          "filmed with another one; give the description of that",
          (clip / "truth" / "contact.jsonl").string(), frame, 1e3 * hands_.contacts[frame].depth,
          1e3 * nearest));
    }
  }

  [[nodiscard]] Matrix3Xd rest_skin() const {
    return problem_.model.mesh.nodes(Eigen::all, skin_) + presses_.rest()(Eigen::all, skin_);
  }

  void write_rest() const {
    const fs::path file = folder_ / "rest.ply";
    const SurfaceMesh rest{rest_skin(), problem_.mesh.boundary.surface.triangles};
    std::error_code error;
    if (fs::exists(file, error)) {
      const ValuedSurface there = value_or_throw(read_valued_ply(file, kVonMisesProperty));
      const bool same = there.surface.vertices.cols() == rest.vertices.cols() &&
                        there.surface.triangles.cols() == rest.triangles.cols() &&
                        there.surface.vertices == rest.vertices &&
                        there.surface.triangles == rest.triangles;
      if (same) return;
      throw Error(fmt::format("{}: is the truth of another body or mesh; remove {} to solve anew",
                              file.string(), folder_.string()));
    }
    write_valued_ply(file, {rest, Eigen::VectorXd::Zero(rest.vertex_count())}, kVonMisesProperty);
  }

  // The results of an earlier run must be of the same hand and the same problem. The same skin is
  // not enough: law, constants, supports and loads change every solution.
  void check_same(const fs::path& clip) const {
    const SolidModel& model = problem_.model;
    ProblemNote note;
    note.add_mesh(model);
    note.add_numbers(problem_.preload);
    // Not the usual one: results of versions that had none stay valid.
    if (!has_usual_range_) {
      note.add(&model.largest_displacement, sizeof model.largest_displacement);
    }
    note.add_friction(friction_);
    note.add_materials(model);
    for (const char* file :
         {"truth/hand.jsonl", "truth/contact.jsonl", "truth/trajectory.txt", "frames/scene.toml"}) {
      note.add_file(clip / file);
    }
    note.check(folder_, false);
  }

  [[nodiscard]] bool is_whole(int frame) const {
    const auto skin = read_valued_ply(deformed_skin_file(folder_, frame), kVonMisesProperty);
    return skin.ok() &&
           skin.value().surface.vertex_count() == problem_.mesh.boundary.surface.vertex_count();
  }

  void leave_out_known() {
    for (const DeformedLine& line : read_deformed_lines(folder_)) {
      lines_[line.frame] = line;
      if (!line.scored || is_whole(line.frame)) known_.push_back(line.frame);
    }
    for (Episode& episode : episodes_) {
      for (const int frame : episode.wanted) {
        if (is_known(frame)) found_[frame] = {.line = lines_.at(frame), .was_there = true};
      }
      std::erase_if(episode.wanted, [&](int frame) { return is_known(frame); });
    }
    std::erase_if(episodes_, [](const Episode& episode) { return episode.wanted.empty(); });
  }

  [[nodiscard]] bool is_known(int frame) const {
    return std::find(known_.begin(), known_.end(), frame) != known_.end();
  }

  // Writes the results of an episode's frames.
  void keep(const Episode& episode, const Walked& fine, const Walked& coarse) {
    for (const int frame : episode.wanted) {
      TrueFrame found;
      found.line.frame = frame;
      found.line.depth = hands_.contacts[frame].depth;
      const auto solution = fine.frames.find(frame);
      if (solution == fine.frames.end()) {
        found.line.scored = false;
        found.line.why = "no solution: " + fine.why_stopped;
      } else {
        const auto other = coarse.frames.find(frame);
        found.path_change =
            other == coarse.frames.end()
                ? 1.0
                : relative_change(solution->second.displacement, other->second.displacement, skin_,
                                  presses_.rest());
        write_frame(solution->second, found);
        found.line.why = why_not_scored(found.path_change, friction_ > 0.0 && episode.first == 0,
                                        solution->second.held_entry);
        found.line.scored = found.line.why.empty();
      }
      lines_[frame] = found.line;
      found_[frame] = std::move(found);
    }
    std::string text;
    for (const auto& [frame, line] : lines_) text += deformed_line(line);
    write_whole_file(folder_ / "deformed.jsonl", text);
  }

  void write_frame(const WalkedFrame& solution, TrueFrame& found) const {
    const Eigen::VectorXd mises =
        von_mises(nodal_cauchy_stress(solver_.model(), solution.displacement));
    const ValuedSurface skin{
        {(problem_.model.mesh.nodes + solution.displacement)(Eigen::all, skin_),
         problem_.mesh.boundary.surface.triangles},
        mises(skin_)};
    write_valued_ply(deformed_skin_file(folder_, found.line.frame), skin, kVonMisesProperty);
    found.line.force = solution.force;
    if (solution.force.norm() > 0.0) found.line.point = solution.centre;
    found.entry = solution.entry;
    found.largest_displacement =
        (solution.displacement - presses_.rest()).colwise().norm().maxCoeff();
    found.largest_von_mises = skin.values.maxCoeff();
  }

  fs::path folder_;
  TrueSkinSettings settings_;
  const Progress& progress_;
  BodyProblem problem_;
  EquilibriumSolver solver_;
  PressSolver presses_;
  bool has_usual_range_;
  double friction_ = 0;    // Coulomb's coefficient
  std::vector<int> skin_;  // nodes of the skin
  ClipHands hands_;
  std::vector<Episode> episodes_;
  std::vector<int> known_;
  std::map<int, DeformedLine> lines_;
  std::map<int, TrueFrame> found_;
};

}  // namespace

std::vector<TrueFrame> write_true_skins(const fs::path& clip, const BodyDescription& description,
                                        const TrueSkinSettings& settings,
                                        const Progress& progress) {
  return TrueSkins(clip, description, settings, progress).write(clip);
}

}  // namespace palpable
