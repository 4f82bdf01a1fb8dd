#include "bench/bake/clip_study.h"

#include "palpable/bake/solid/obstacle.h"
#include "palpable/bake/touch_bake/touch_difference.h"
#include "palpable/bake/truth/episodes.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/mesh_file.h"
#include "palpable/common/response/skin_contact.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/desk/score/deformation_scores.h"
#include "palpable/desk/score/touch_scores.h"
#include "palpable/live/seen_object/object_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3Xd;

ValuedSurface skin_in(const fs::path& file, const SurfaceMesh& of) {
  ValuedSurface skin = value_or_throw(read_valued_ply(file, kVonMisesProperty));
  if (skin.surface.vertex_count() != of.vertex_count()) {
    throw Error(fmt::format("{}: has {} vertices where the body has {}; it is of another body",
                            file.string(), skin.surface.vertex_count(), of.vertex_count()));
  }
  return skin;
}

// The lines of the frames that are compared, by frame.
std::map<int, DeformedLine> lines_of(const fs::path& deformed, double depth) {
  std::map<int, DeformedLine> lines;
  for (const DeformedLine& line : read_deformed_lines(deformed)) {
    if (line.scored && line.depth >= depth) lines[line.frame] = line;
  }
  if (lines.empty()) {
    throw Error(fmt::format("{}: has no frame of at least {:.3g} mm; palpable truth writes it",
                            deformed.string(), 1e3 * depth));
  }
  return lines;
}

// A body's contact in one frame, and the stress and the skin of a state.
struct BodyContact {
  std::function<TouchReport(int frame, TouchState& state)> advance;
  std::function<void(const TouchState& state, std::span<float> von_mises)> stress;
  std::function<void(const TouchState& state, Eigen::Matrix3Xf& skin)> place;
};

BodyContact to_capsules(const TouchableBody& body, const ClipHands& hands) {
  const auto solver =
      std::make_shared<TouchSolver>(body.body.surface, body.body.fixed, *body.touch);
  return {
      [solver, &hands](int frame, TouchState& state) {
        Obstacle hand;
        hand.capsules = hands.capsules[static_cast<std::size_t>(frame)];
        const ObstacleGaps gaps(hand);
        return solver->advance(state, ExactObstacles(gaps));
      },
      [solver](const TouchState& state, std::span<float> von_mises) {
        solver->stress(state, von_mises);
      },
      [solver](const TouchState& state, Eigen::Matrix3Xf& skin) { solver->place(state, skin); }};
}

// Contact with the visible side of the hand, its hidden side assumed.
BodyContact to_depth(const TouchableBody& body, const fs::path& clip, const ClipHands& hands) {
  const SurfaceMesh& rest = body.body.surface;
  const fs::path truth = clip / "truth";
  const TruthCamera camera = read_truth_camera(truth / "camera.toml");
  if (!camera.camera) throw Error((truth / "camera.toml").string() + ": has no camera");
  ObjectSurfaceSettings exact;
  exact.noise_quadratic = 0;
  exact.noise_constant = camera.depth_unit / std::sqrt(12.0);  // sigma of rounding
  const auto surface = std::make_shared<ObjectSurface>(exact);
  const auto contact = std::make_shared<SkinContact>(rest, body.body.fixed, *body.touch);
  const Eigen::AlignedBox3d region(rest.vertices.rowwise().minCoeff(),
                                   rest.vertices.rowwise().maxCoeff());
  return {
      [=, &hands](int frame, TouchState& state) {
        const auto view = read_true_view(truth, frame, camera.depth_unit);
        if (!view) {
          throw Error(
              fmt::format("{}: depth or labels of frame {} are missing", truth.string(), frame));
        }
        surface->build(view->depth, view->shows, *camera.camera,
                       hands.body_from_camera[static_cast<std::size_t>(frame)], region,
                       frame / camera.frames_per_second);
        std::vector<Touch> touches;
        return contact->advance(state, *surface, touches);
      },
      [contact](const TouchState& state, std::span<float> von_mises) {
        contact->stress(state, von_mises);
      },
      [contact](const TouchState& state, Eigen::Matrix3Xf& skin) { contact->place(state, skin); }};
}

}  // namespace

ClipResult compare_with_true_hand(const TouchableBody& body, const fs::path& clip, TrueHand hand,
                                  double depth) {
  if (!body.touch) throw Error("the body has no tables of touch; palpable inspect says why");
  const SurfaceMesh& rest = body.body.surface;
  const fs::path deformed = clip / "truth/deformed";
  const std::map<int, DeformedLine> lines = lines_of(deformed, depth);
  const Matrix3Xd true_rest = skin_in(deformed / "rest.ply", rest).surface.vertices;
  if ((true_rest - rest.vertices).cwiseAbs().maxCoeff() > 1e-6) {
    throw Error(fmt::format("{}: is another body's", (deformed / "rest.ply").string()));
  }
  const ClipHands hands = read_clip_hands(clip);
  const Eigen::VectorXd areas = vertex_areas(rest);
  const BodyContact to_hand =
      hand == TrueHand::kCapsules ? to_capsules(body, hands) : to_depth(body, clip, hands);
  TouchState state;
  Matrix3Xd before = Matrix3Xd::Zero(3, rest.vertex_count());
  Eigen::Matrix3Xf skin(3, rest.vertex_count());
  std::vector<float> stress(static_cast<std::size_t>(rest.vertex_count()));
  ClipResult compared;
  for (int frame = 0; frame < hands.frame_count(); ++frame) {
    const auto begin = std::chrono::steady_clock::now();
    const TouchReport report = to_hand.advance(frame, state);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    if (report.candidates > 0) compared.milliseconds.push_back(took.count());
    to_hand.place(state, skin);
    const Matrix3Xd u = skin.cast<double>() - rest.vertices;
    compared.largest_jump_mm =
        std::max(compared.largest_jump_mm, 1e3 * (u - before).colwise().norm().maxCoeff());
    before = u;
    const auto line = lines.find(frame);
    if (line == lines.end()) continue;
    const ContactLine& contact = hands.contacts[static_cast<std::size_t>(frame)];
    if (hand == TrueHand::kDepth && contact.seen_share.value_or(1) < kSeenFrom) {
      ++compared.unseen;
      continue;
    }
    const ValuedSurface truth = skin_in(deformed_skin_file(deformed, frame), rest);
    const DisplacementError error =
        displacement_error(truth.surface.vertices - true_rest, u, areas);
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (const PointForce& point : state.forces) force += point.force.cast<double>();
    to_hand.stress(state, stress);
    compared.frames.push_back(
        {.frame = frame,
         .displacement = error.relative,
         .worst_vertex_mm = 1e3 * error.worst,
         .force = force_error(line->second.force, std::array{force}),
         .von_mises = von_mises_error(
             truth.values, Eigen::Map<const Eigen::VectorXf>(stress.data(), rest.vertex_count())
                               .cast<double>())});
  }
  return compared;
}

}  // namespace palpable
