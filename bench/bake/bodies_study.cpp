#include "bench/bake/bodies_study.h"

#include "palpable/bake/solid/obstacle.h"
#include "palpable/bake/touch_bake/touch_difference.h"
#include "palpable/bake/truth/episodes.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/contact/contact_solver.h"
#include "palpable/common/geometry/mesh_file.h"
#include "palpable/common/response/modal_body.h"
#include "palpable/common/response/touch_solver.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/desk/score/deformation_scores.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <span>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kTouches = 0.01;  // N, smallest force between bodies that counts as touching

// The truth of one body.
struct Truth {
  fs::path folder;
  ClipHands hands;
  std::map<int, DeformedLine> lines;
  Matrix3Xd rest;
  Eigen::VectorXd areas;
};

Truth truth_of(const StudiedBody& body, const fs::path& clip) {
  Truth truth;
  truth.folder = clip / "truth" / "bodies" / body.name / "deformed";
  truth.hands = read_clip_hands(clip, body.name);
  for (const DeformedLine& line : read_deformed_lines(truth.folder)) {
    if (line.scored) truth.lines[line.frame] = line;
  }
  if (truth.lines.empty()) {
    throw Error(fmt::format("{}: has no scored frame; palpable truth --scene writes it",
                            truth.folder.string()));
  }
  truth.rest = value_or_throw(read_valued_ply(truth.folder / "rest.ply", kVonMisesProperty))
                   .surface.vertices;
  const SurfaceMesh& skin = body.body.body.surface;
  if (truth.rest.cols() != skin.vertices.cols() ||
      (truth.rest - skin.vertices).cwiseAbs().maxCoeff() > 1e-6) {
    throw Error(fmt::format("{}: is another body's", (truth.folder / "rest.ply").string()));
  }
  truth.areas = vertex_areas(skin);
  return truth;
}

// Several bodies whose contact is computed frame by frame.
class Players {
 public:
  explicit Players(const std::vector<const StudiedBody*>& bodies) {
    std::vector<ContactSolver::Member> members;
    for (const StudiedBody* body : bodies) {
      parts_.push_back(std::make_unique<Part>(*body, twin_of(*body)));
      members.push_back({&parts_.back()->contact_body(), body->scene_from_body});
    }
    together_.emplace(members);
    for (const auto& part : parts_) part->use_state();
  }

  // Solves the contact of a frame and computes all results of the bodies that moved.
  // @return CPU time, ms
  double advance(std::span<const Obstacles* const> seen) {
    std::vector<ContactSolver::Near> near;
    for (const Obstacles* obstacles : seen) near.push_back({obstacles});
    const double begin = thread_cpu_seconds();
    report_ = together_->advance(near);
    for (const auto& part : parts_) part->reconstruct();
    return 1e3 * (thread_cpu_seconds() - begin);
  }
  [[nodiscard]] const Eigen::Matrix3Xf& skin(std::size_t k) const { return parts_[k]->skin; }
  [[nodiscard]] std::span<const float> von_mises(std::size_t k) const {  // Pa
    return parts_[k]->stress;
  }
  [[nodiscard]] bool is_anything_near() const { return report_.candidates > 0; }
  [[nodiscard]] const ContactReport& report() const { return report_; }
  [[nodiscard]] bool is_touched_by_hand(std::size_t k) const {
    const std::vector<PointForce>& forces = parts_[k]->contact_body().forces();
    return std::any_of(forces.begin(), forces.end(),
                       [](const PointForce& at) { return at.by < 0; });
  }
  // Sum of the forces of other bodies on body k, N, scene frame.
  [[nodiscard]] Vector3d by_others(std::size_t k) const {
    Vector3d sum = Vector3d::Zero();
    for (const PointForce& at : parts_[k]->contact_body().forces()) {
      if (at.by >= 0) sum += at.force.cast<double>();
    }
    for (const PressedPoint& point : together_->pressed_by_others(static_cast<int>(k))) {
      sum += point.force.cast<double>();
    }
    return parts_[k]->body.scene_from_body.linear() * sum;
  }

 private:
  struct Part {
    Part(const StudiedBody& the_body, const ModalBody* twin)
        : body(the_body),
          skin(body.body.body.surface.vertices.cast<float>()),
          normals(3, skin.cols()),
          stress(static_cast<std::size_t>(skin.cols())) {
      const ReducedBody& reduced = body.body.body;
      if (body.body.touch) {
        tables.emplace(reduced.surface, reduced.fixed, *body.body.touch);
      } else {
        modal = std::make_unique<ModalBody>(ModalMember{&reduced, &*body.body.modal}, twin);
      }
    }
    [[nodiscard]] ContactBody& contact_body() {
      return tables ? static_cast<ContactBody&>(tables->body()) : *modal;
    }
    void use_state() {
      if (tables) {
        tables->body().use(state);
      } else {
        modal->use(modal_state);
      }
    }
    void reconstruct() {
      if (tables) {
        tables->place(state, skin);
        if (state.u.isZero(0)) return;
        vertex_normals(skin, body.body.body.surface.triangles, normals);
        tables->stress(state, stress);
      } else {
        skin = modal->place(modal_state);
        if (modal_state.q.isZero(0)) return;
        modal->find_normals(modal_state, normals);
        modal->stress(modal_state, stress);
      }
    }

    const StudiedBody& body;
    std::optional<TouchSolver> tables;
    TouchState state;
    std::unique_ptr<ModalBody> modal;
    ModalState modal_state;
    Eigen::Matrix3Xf skin, normals;
    std::vector<float> stress;
  };
  [[nodiscard]] const ModalBody* twin_of(const StudiedBody& body) const {
    if (body.body.touch) return nullptr;
    for (const auto& part : parts_) {
      if (part->modal && are_twins(part->modal->member(), {&body.body.body, &*body.body.modal})) {
        return part->modal.get();
      }
    }
    return nullptr;
  }

  std::vector<std::unique_ptr<Part>> parts_;
  std::optional<ContactSolver> together_;
  ContactReport report_;
};

// The body that the hand presses in most frames.
std::size_t pressed_by_hand(const std::vector<Truth>& truths) {
  const auto touching_frames = [](const Truth& truth) {
    return std::ranges::count_if(truth.hands.contacts, &ContactLine::touching);
  };
  return static_cast<std::size_t>(std::ranges::max_element(truths, {}, touching_frames) -
                                  truths.begin());
}

// The hand of a frame as each body sees it.
struct SeenHands {
  std::vector<std::unique_ptr<ObstacleGaps>> gaps;
  std::vector<std::unique_ptr<ExactObstacles>> obstacles;
  std::vector<const Obstacles*> seen;  // one for each body

  SeenHands(const std::vector<Truth>& truths, std::size_t frame) {
    for (const Truth& truth : truths) {
      Obstacle hand;
      hand.capsules = truth.hands.capsules[frame];
      gaps.push_back(std::make_unique<ObstacleGaps>(std::move(hand)));
      obstacles.push_back(std::make_unique<ExactObstacles>(*gaps.back()));
      seen.push_back(obstacles.back().get());
    }
  }
};

// Compares displacement and stress of body k.
void compare_fields(const StudiedBody& body, const Truth& truth, int frame, const Players& players,
                    std::size_t k, BodiesResult& compared) {
  const ValuedSurface true_skin =
      value_or_throw(read_valued_ply(deformed_skin_file(truth.folder, frame), kVonMisesProperty));
  const Matrix3Xd true_u = true_skin.surface.vertices - truth.rest;
  const Matrix3Xd u = players.skin(k).cast<double>() - body.body.body.surface.vertices;
  if (!(true_u.colwise().norm().maxCoeff() > 1e-4)) return;  // m, or nothing is relative
  compared.displacement.push_back(displacement_error(true_u, u, truth.areas).relative);
  const std::span<const float> found = players.von_mises(k);
  const Eigen::VectorXd stress =
      Eigen::Map<const Eigen::VectorXf>(found.data(), std::ssize(found)).cast<double>();
  compared.stress.push_back((stress - true_skin.values).norm() / true_skin.values.norm());
}

// Compares the force of other bodies on body k.
void compare_forces(const Vector3d& true_force, const Vector3d& force, BodiesResult& compared) {
  const bool here = force.norm() > kTouches, truly = true_force.norm() > kTouches;
  compared.touching += here;
  compared.touching_true += truly;
  compared.disagree += here != truly;
  if (truly) compared.between_force.push_back((force - true_force).norm() / true_force.norm());
}

// Compares all bodies in a frame whose truth is known.
void compare_frame(const std::vector<StudiedBody>& bodies, const std::vector<Truth>& truths,
                   int frame, std::size_t pressed, const Players& players, BodiesResult& compared) {
  if (!truths.front().lines.contains(frame)) return;
  ++compared.frames;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const Truth& truth = truths[k];
    const auto line = truth.lines.find(frame);
    if (line == truth.lines.end()) continue;
    compare_fields(bodies[k], truth, frame, players, k, compared);
    // The truth has only the total force on each body. Without a touching hand it is the force
    // of other bodies.
    if (k == pressed || truth.hands.contacts[static_cast<std::size_t>(frame)].touching ||
        players.is_touched_by_hand(k)) {
      continue;
    }
    compare_forces(bodies[k].scene_from_body.linear() * line->second.force, players.by_others(k),
                   compared);
  }
}

}  // namespace

BodiesResult compare_bodies(const std::vector<StudiedBody>& bodies, const fs::path& clip) {
  std::vector<Truth> truths;
  std::vector<const StudiedBody*> all;
  for (const StudiedBody& body : bodies) {
    if (!body.body.touch && !body.body.modal) {
      throw Error(
          fmt::format("'{}' has neither tables of touch nor an energy in modes: bake it with "
                      "[touch] tables, or by --intrusive with [intrusive] reactions",
                      body.name));
    }
    truths.push_back(truth_of(body, clip));
    all.push_back(&body);
  }
  const std::size_t pressed = pressed_by_hand(truths);
  Players players(all), alone({all[pressed]});
  // Two copies of it, placed a metre and more aside.
  std::vector<StudiedBody> aside(2, bodies[pressed]);
  for (std::size_t k = 0; k < 2; ++k) {
    aside[k].scene_from_body.translation().x() += 1.0 + static_cast<double>(k);
  }
  Players three({all[pressed], &aside[0], &aside[1]});

  BodiesResult compared;
  for (int frame = 0; frame < truths.front().hands.frame_count(); ++frame) {
    const SeenHands hands(truths, static_cast<std::size_t>(frame));
    const std::vector<const Obstacles*>& seen = hands.seen;
    const double ms = players.advance(seen);
    const std::vector<const Obstacles*> of_three{seen[pressed], nullptr, nullptr};
    const double ms_alone = alone.advance({&seen[pressed], 1}), ms_three = three.advance(of_three);
    if (players.is_anything_near()) {
      compared.milliseconds.push_back(ms);
      compared.milliseconds_alone.push_back(ms_alone);
      compared.milliseconds_three.push_back(ms_three);
    }
    compared.imbalance = std::max(compared.imbalance, players.report().imbalance);
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      if (k != pressed && players.by_others(k).norm() > kTouches) {
        compared.between_penetration.push_back(players.report().mutual_penetration);
      }
    }
    compare_frame(bodies, truths, frame, pressed, players, compared);
  }
  return compared;
}

}  // namespace palpable
