#include "palpable/bake/truth/scene_skins.h"

#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/solid/displacement_range.h"
#include "palpable/bake/solid/joined_model.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/bake/truth/episodes.h"
#include "palpable/bake/truth/friction_choice.h"
#include "palpable/bake/truth/hand_walks.h"
#include "palpable/bake/truth/problem_note.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/folder_lock.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/geometry/size_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <list>
#include <map>
#include <optional>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3Xd;

// Largest distance between vertices of two skins that count as the same, ratio to the diagonal of
// the body's box.
constexpr double kSameSkin = 1e-6;

// A body within the joined problem.
struct Part {
  fs::path folder;          // of its results
  SurfaceMesh skin;         // body frame, at rest
  std::vector<int> nodes;   // of the joined mesh, vertex by vertex
  int first = 0, last = 0;  // range of its nodes in the joined mesh
  double range = 0;         // m, its SolidModel::largest_displacement
};

class SceneSkins {
 public:
  SceneSkins(const fs::path& clip, const std::vector<SceneSolid>& solids,
             const SceneSkinSettings& settings, const Progress& progress)
      : clip_(clip), solids_(solids), settings_(settings), progress_(progress), joined_(join()) {
    solver_.emplace(joined_.model);
  }

  std::vector<TrueSceneFrame> write() {
    read_hands();
    std::list<FolderLock> locks;  // a list, because locks cannot be moved
    for (std::size_t b = 0; b < parts_.size(); ++b) {
      check_filmed(parts_[b]);
      make_folder(parts_[b].folder);
      locks.emplace_back(parts_[b].folder);
      write_valued_ply(parts_[b].folder / "rest.ply",
                       {parts_[b].skin, Eigen::VectorXd::Zero(parts_[b].skin.vertex_count())},
                       kVonMisesProperty);
    }
    std::vector<fs::path> folders;
    for (const Part& part : parts_) folders.push_back(part.folder);
    ContactSettings contact;
    contact.friction = choose_friction(clip_, settings_.friction, folders);
    contact.mutual = true;
    contact.mutual_friction = contact.friction;
    rubs_ = contact.friction > 0.0;
    if (rubs_) find_episodes(kFramesBetweenTouches);
    check_same(contact.friction);
    leave_out_known();
    follow_hand(*solver_, hands_, episodes_, {.contact = contact, .threads = settings_.threads},
                progress_,
                [this](const Episode& episode, const Walked& fine, const Walked& coarse) {
                  keep(episode, fine, coarse);
                });
    std::vector<TrueSceneFrame> frames;
    for (auto& [key, found] : found_) frames.push_back(std::move(found));
    return frames;
  }

 private:
  JoinedModel join() {
    std::vector<SolidModel> models;
    std::vector<Rigid3> poses;
    std::vector<Boundary> boundaries;
    for (const SceneSolid& solid : solids_) {
      BodyProblem problem = pose_body(solid.description);
      if (problem.preload.cols() > 0) {
        throw Error(
            fmt::format("the body '{}' bears loads before it is touched (weight or pressure), "
                        "which scenes are solved without",
                        solid.name));
      }
      problem.model.mesh.nodes *= solid.scale;
      problem.model.largest_displacement *= solid.scale;
      problem.mesh.boundary.surface.vertices *= solid.scale;
      Part& part = parts_.emplace_back();
      part.folder = clip_ / "truth" / "bodies" / solid.name / "deformed";
      part.skin = problem.mesh.boundary.surface;
      for (const int node : problem.mesh.boundary.node_of_vertex) part.nodes.push_back(node);
      part.range = problem.model.largest_displacement;
      models.push_back(std::move(problem.model));
      poses.push_back(solid.scene_from_body);
    }
    JoinedModel all = joined(models, poses);
    for (std::size_t b = 0; b < parts_.size(); ++b) {
      parts_[b].first = all.first_node[b];
      parts_[b].last = all.first_node[b + 1];
      for (int& node : parts_[b].nodes) node += parts_[b].first;
    }
    return all;
  }

  // Reads the hand in the scene's frame. A frame is a touching one if the hand touches any body.
  void read_hands() {
    for (std::size_t b = 0; b < solids_.size(); ++b) {
      ClipHands hands = read_clip_hands(clip_, solids_[b].name);
      if (b == 0) {
        for (std::size_t n = 0; n < hands.contacts.size(); ++n) {
          depths_[n] = hands.contacts[n].depth;
        }
        for (auto& capsules : hands.capsules) {
          capsules = transformed(std::move(capsules), solids_[0].scene_from_body);
        }
        hands_ = std::move(hands);
        continue;
      }
      for (std::size_t n = 0; n < hands_.contacts.size(); ++n) {
        hands_.contacts[n].touching |= hands.contacts[n].touching;
        depths_[n] = std::max(depths_[n], hands.contacts[n].depth);
      }
    }
    find_episodes(1);
    if (episodes_.empty()) {
      throw Error(fmt::format("{}: nothing touches a body in this clip", clip_.string()));
    }
  }

  void find_episodes(int apart) {
    episodes_ = episodes_of(hands_.contacts, settings_.frames,
                            std::numeric_limits<double>::infinity(), apart);
  }

  // The results of an earlier run must be of the same hands and the same problem.
  void check_same(double friction) const {
    ProblemNote note;
    note.add_mesh(joined_.model);
    note.add_materials(joined_.model);
    note.add_friction(friction);
    for (const Part& part : parts_) {
      note.add(&part.range, sizeof part.range);
      note.add_file(part.folder.parent_path() / "contact.jsonl");
    }
    for (const char* file : {"truth/hand.jsonl", "truth/trajectory.txt", "frames/scene.toml"}) {
      note.add_file(clip_ / file);
    }
    // Palpable 0.1 wrote none for scenes.
    for (const Part& part : parts_) note.check(part.folder, !(friction > 0.0));
  }

  void check_filmed(const Part& part) const {
    const fs::path file = part.folder.parent_path() / kBodySkinFile;
    const SurfaceMesh there = value_or_throw(read_valued_ply(file, kVonMisesProperty)).surface;
    const Eigen::Vector3d size = extent_of(part.skin.vertices);
    double off = std::numeric_limits<double>::infinity();
    if (there.vertices.cols() == part.skin.vertices.cols() &&
        there.triangles.cols() == part.skin.triangles.cols() &&
        there.triangles == part.skin.triangles) {
      off = (there.vertices - part.skin.vertices).colwise().norm().maxCoeff();
    }
    if (off <= kSameSkin * size.norm()) return;
    throw Error(
        fmt::format("{}: the scene's description makes another skin; give the scene that was "
                    "filmed, or bake and film anew",
                    file.string()));
  }

  void leave_out_known() {
    std::vector<std::map<int, DeformedLine>> known(parts_.size());
    for (std::size_t b = 0; b < parts_.size(); ++b) {
      for (const DeformedLine& line : read_deformed_lines(parts_[b].folder)) {
        std::error_code error;
        const bool whole =
            !line.scored || fs::exists(deformed_skin_file(parts_[b].folder, line.frame), error);
        if (whole) known[b][line.frame] = line;
      }
    }
    const auto is_known = [&](int frame) {
      return std::all_of(known.begin(), known.end(),
                         [frame](const auto& lines) { return lines.contains(frame); });
    };
    for (Episode& episode : episodes_) {
      for (const int frame : episode.wanted) {
        if (!is_known(frame)) continue;
        for (std::size_t b = 0; b < parts_.size(); ++b) {
          found_[{b, frame}] = {
              .body = solids_[b].name, .line = known[b][frame], .was_there = true};
        }
      }
      std::erase_if(episode.wanted, is_known);
    }
    std::erase_if(episodes_, [](const Episode& episode) { return episode.wanted.empty(); });
  }

  // Writes the results of an episode's frames.
  void keep(const Episode& episode, const Walked& fine, const Walked& coarse) {
    for (const int frame : episode.wanted) {
      const auto solution = fine.frames.find(frame), other = coarse.frames.find(frame);
      std::string why;
      if (solution == fine.frames.end()) {
        why = "no solution: " + fine.why_stopped;
      } else {
        why = why_not_scored(
            other == coarse.frames.end() ? 1.0 : change_of(solution->second, other->second),
            rubs_ && episode.first == 0, solution->second.held_entry);
      }
      if (why.empty()) why = beyond_range(solution->second);
      for (std::size_t b = 0; b < parts_.size(); ++b) {
        TrueSceneFrame found{.body = solids_[b].name};
        found.line.frame = frame;
        found.line.depth = depths_[static_cast<std::size_t>(frame)];
        found.line.scored = why.empty();
        found.line.why = why;
        if (solution != fine.frames.end()) write_frame(solution->second, b, found);
        found_[{b, frame}] = std::move(found);
      }
    }
    for (std::size_t b = 0; b < parts_.size(); ++b) {
      std::string text;
      for (const auto& [key, frame] : found_) {
        if (key.first == b) text += deformed_line(frame.line);
      }
      write_whole_file(parts_[b].folder / "deformed.jsonl", text);
    }
  }

  // Why a solution is beyond the range of a body; the solver knows that of the largest one only.
  [[nodiscard]] std::string beyond_range(const WalkedFrame& solution) const {
    for (std::size_t b = 0; b < parts_.size(); ++b) {
      const Matrix3Xd u = solution.displacement(Eigen::all, parts_[b].nodes);
      if (u.colwise().norm().maxCoeff() <= parts_[b].range) continue;
      return fmt::format("{}: {}", solids_[b].name, beyond_range_text(parts_[b].range));
    }
    return {};
  }

  // Relative change of all skins together: that of a body that hardly moves would mean nothing.
  [[nodiscard]] double change_of(const WalkedFrame& a, const WalkedFrame& b) const {
    std::vector<int> nodes;
    for (const Part& part : parts_) nodes.insert(nodes.end(), part.nodes.begin(), part.nodes.end());
    return relative_change(a.displacement, b.displacement, nodes);
  }

  void write_frame(const WalkedFrame& solution, std::size_t b, TrueSceneFrame& found) const {
    const Part& part = parts_[b];
    const Rigid3 body_from_scene = solids_[b].scene_from_body.inverse();
    const Matrix3Xd u = body_from_scene.linear() * solution.displacement(Eigen::all, part.nodes);
    const Eigen::VectorXd mises =
        von_mises(nodal_cauchy_stress(joined_.model, solution.displacement));
    const ValuedSurface skin{{part.skin.vertices + u, part.skin.triangles}, mises(part.nodes)};
    write_valued_ply(deformed_skin_file(part.folder, found.line.frame), skin, kVonMisesProperty);
    const Eigen::Index first = part.first, count = part.last - part.first;
    const Eigen::Vector3d hand = solution.hand_forces.middleCols(first, count).rowwise().sum(),
                          others = solution.other_forces.middleCols(first, count).rowwise().sum();
    found.line.force = body_from_scene.linear() * (hand + others);
    found.largest_displacement = u.colwise().norm().maxCoeff();
    found.between = others.norm();
  }

  fs::path clip_;
  bool rubs_ = false;
  const std::vector<SceneSolid>& solids_;
  SceneSkinSettings settings_;
  const Progress& progress_;
  std::vector<Part> parts_;
  JoinedModel joined_;
  std::optional<EquilibriumSolver> solver_;
  ClipHands hands_;
  std::map<std::size_t, double> depths_;  // m, of the deepest touch of any body, by frame
  std::vector<Episode> episodes_;
  std::map<std::pair<std::size_t, int>, TrueSceneFrame> found_;  // by body and frame
};

}  // namespace

std::vector<TrueSceneFrame> write_scene_skins(const fs::path& clip,
                                              const std::vector<SceneSolid>& solids,
                                              const SceneSkinSettings& settings,
                                              const Progress& progress) {
  PALPABLE_EXPECT(!solids.empty(), "a scene has bodies");
  return SceneSkins(clip, solids, settings, progress).write();
}

}  // namespace palpable
