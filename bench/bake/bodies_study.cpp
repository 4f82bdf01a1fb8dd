#include "bench/bake/bodies_study.h"

#include "palpable/bake/solid/obstacle.h"
#include "palpable/bake/touch_bake/touch_difference.h"
#include "palpable/bake/truth/clip_hands.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/contact/modal_contact.h"
#include "palpable/common/contact/pressing_bodies.h"
#include "palpable/common/contact/skin_contact.h"
#include "palpable/common/geometry/mesh_file.h"
#include "palpable/desk/clip_files/deformed_file.h"
#include "palpable/desk/score/displacement_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <span>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kTouches = 0.01;  // N between bodies

// What is known of a body.
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

// Some bodies, played frame by frame.
class Players {
 public:
  virtual ~Players() = default;
  // Contact, and all that is shown of what moved. @return ms of CPU
  virtual double advance(std::span<const Obstacles* const> seen) = 0;
  [[nodiscard]] virtual const Eigen::Matrix3Xf& skin(std::size_t k) const = 0;
  [[nodiscard]] virtual std::span<const float> von_mises(std::size_t k) const = 0;  // Pa
  [[nodiscard]] virtual bool is_anything_near() const = 0;
  [[nodiscard]] virtual double between() const = 0;    // m, as ModalReport
  [[nodiscard]] virtual double imbalance() const = 0;  // N
  // N, scene frame.
  [[nodiscard]] virtual Vector3d by_others(std::size_t k) const = 0;
};

class ModalPlayers : public Players {
 public:
  explicit ModalPlayers(const std::vector<const StudiedBody*>& bodies) : bodies_(bodies) {
    std::vector<ModalMember> members;
    for (const StudiedBody* body : bodies) {
      members.push_back({&body->body.body, &*body->body.modal, body->scene_from_body});
      const auto V = static_cast<Eigen::Index>(body->body.body.surface.vertex_count());
      skins_.emplace_back(3, V);
      normals_.emplace_back(3, V);
      stress_.emplace_back(static_cast<std::size_t>(V));
    }
    contact_ = std::make_unique<ModalContact>(members);
    states_.resize(bodies.size());
  }

  double advance(std::span<const Obstacles* const> seen) override {
    const double begin = thread_cpu_seconds();
    report_ = contact_->advance(states_, seen);
    for (std::size_t k = 0; k < states_.size(); ++k) {
      const int member = static_cast<int>(k);
      skins_[k] = contact_->place(member, states_[k]);
      if (states_[k].q.isZero(0)) continue;
      contact_->normals(member, states_[k], normals_[k]);
      contact_->stress(member, states_[k], stress_[k]);
    }
    return 1e3 * (thread_cpu_seconds() - begin);
  }

  [[nodiscard]] const Eigen::Matrix3Xf& skin(std::size_t k) const override { return skins_[k]; }
  [[nodiscard]] std::span<const float> von_mises(std::size_t k) const override {
    return stress_[k];
  }
  [[nodiscard]] bool is_anything_near() const override { return report_.candidates > 0; }
  [[nodiscard]] double between() const override { return report_.between; }
  [[nodiscard]] double imbalance() const override { return report_.imbalance; }
  [[nodiscard]] Vector3d by_others(std::size_t k) const override {
    Vector3d sum = Vector3d::Zero();
    for (const SkinForce& force : states_[k].forces) {
      if (force.by >= 0) sum += force.force.cast<double>();
    }
    return bodies_[k]->scene_from_body.linear() * sum;
  }

 private:
  std::vector<const StudiedBody*> bodies_;
  std::unique_ptr<ModalContact> contact_;
  std::vector<ModalState> states_;
  std::vector<Eigen::Matrix3Xf> skins_, normals_;
  std::vector<std::vector<float>> stress_;
  ModalReport report_;
};

// By tables.
class TablePlayers : public Players {
 public:
  explicit TablePlayers(const std::vector<const StudiedBody*>& bodies) {
    std::vector<PressingBodies::Body> all;
    for (const StudiedBody* body : bodies) {
      parts_.push_back(std::make_unique<Part>(*body));
      Part& part = *parts_.back();
      all.push_back({&body->body.body.surface, body->scene_from_body, &*body->body.touch,
                     &part.contact, &part.state, nullptr, &part.seen});
    }
    together_ = std::make_unique<PressingBodies>(all);
  }

  double advance(std::span<const Obstacles* const> seen) override {
    for (std::size_t k = 0; k < parts_.size(); ++k) parts_[k]->seen.now = seen[k];
    const double begin = thread_cpu_seconds();
    report_ = together_->advance();
    for (const auto& part : parts_) {
      part->contact.place(part->state, part->skin);
      if (part->state.u.isZero(0)) continue;
      vertex_normals(part->skin, part->body.body.body.surface.triangles, part->normals);
      part->contact.stress(part->state, part->stress);
    }
    return 1e3 * (thread_cpu_seconds() - begin);
  }
  [[nodiscard]] const Eigen::Matrix3Xf& skin(std::size_t k) const override {
    return parts_[k]->skin;
  }
  [[nodiscard]] std::span<const float> von_mises(std::size_t k) const override {
    return parts_[k]->stress;
  }
  [[nodiscard]] bool is_anything_near() const override {
    return std::any_of(parts_.begin(), parts_.end(),
                       [](const auto& part) { return !part->state.forces.empty(); });
  }
  [[nodiscard]] double between() const override { return report_.between; }
  [[nodiscard]] double imbalance() const override { return report_.imbalance; }
  [[nodiscard]] Vector3d by_others(std::size_t k) const override {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      for (const PointForce& force : parts_[j]->state.forces) {
        const Vector3d here = parts_[j]->body.scene_from_body.linear() * force.force.cast<double>();
        if (j == k && force.by >= 0) sum += here;
        if (force.by == static_cast<int>(k)) sum -= here;
      }
    }
    return sum;
  }

 private:
  // What presses a body in this frame; null: nothing.
  struct OfThisFrame : Obstacles {
    const Obstacles* now = nullptr;
    void find_gaps(std::span<const Eigen::Vector3f> places,
                   std::span<SurfaceGap> gaps) const override {
      std::fill(gaps.begin(), gaps.end(), SurfaceGap());
      if (now != nullptr) now->find_gaps(places, gaps);
    }
    [[nodiscard]] bool may_be_within(const Eigen::Vector3f& place, float reach) const override {
      return now != nullptr && now->may_be_within(place, reach);
    }
  };
  struct Part {
    explicit Part(const StudiedBody& the_body)
        : body(the_body),
          contact(body.body.body.surface, body.body.body.fixed, *body.body.touch),
          skin(body.body.body.surface.vertices.cast<float>()),
          normals(3, skin.cols()),
          stress(static_cast<std::size_t>(skin.cols())) {}
    const StudiedBody& body;
    SkinContact contact;
    TouchState state;
    OfThisFrame seen;
    Eigen::Matrix3Xf skin, normals;
    std::vector<float> stress;
  };
  std::vector<std::unique_ptr<Part>> parts_;
  std::unique_ptr<PressingBodies> together_;
  PressingReport report_;
};

std::unique_ptr<Players> players_of(const std::vector<const StudiedBody*>& bodies) {
  if (bodies.front()->body.touch) return std::make_unique<TablePlayers>(bodies);
  return std::make_unique<ModalPlayers>(bodies);
}

}  // namespace

BodiesAnswer answer_of_bodies(const std::vector<StudiedBody>& bodies, const fs::path& clip) {
  std::vector<Truth> truths;
  std::vector<const StudiedBody*> all;
  for (const StudiedBody& body : bodies) {
    if (!body.body.touch && !body.body.modal) {
      throw Error(
          fmt::format("'{}' has neither tables of touch nor an energy in modes: bake it with "
                      "[touch] tables, or by --method intrusive-pgd with [intrusive] reactions",
                      body.name));
    }
    if (body.body.touch.has_value() != bodies.front().body.touch.has_value()) {
      throw Error(
          fmt::format("'{}' and '{}' are not answered together: one has tables of touch, "
                      "the other has none",
                      bodies.front().name, body.name));
    }
    truths.push_back(truth_of(body, clip));
    all.push_back(&body);
  }
  // The one that the hand presses.
  const auto pressed = static_cast<std::size_t>(
      std::max_element(truths.begin(), truths.end(),
                       [](const Truth& a, const Truth& b) {
                         const auto count = [](const Truth& t) {
                           return std::count_if(
                               t.hands.contacts.begin(), t.hands.contacts.end(),
                               [](const ContactLine& line) { return line.touching; });
                         };
                         return count(a) < count(b);
                       }) -
      truths.begin());
  const auto players = players_of(all), alone = players_of({all[pressed]});
  // Two more of it that stand a metre aside.
  std::vector<StudiedBody> aside(2, bodies[pressed]);
  for (std::size_t k = 0; k < 2; ++k) {
    aside[k].scene_from_body.translation().x() += 1.0 + static_cast<double>(k);
  }
  const auto three = players_of({all[pressed], &aside[0], &aside[1]});

  BodiesAnswer answer;
  for (int frame = 0; frame < truths.front().hands.frame_count(); ++frame) {
    const auto at = static_cast<std::size_t>(frame);
    std::vector<std::unique_ptr<ObstacleGaps>> gaps;
    std::vector<std::unique_ptr<ExactObstacles>> obstacles;
    std::vector<const Obstacles*> seen;
    for (const Truth& truth : truths) {
      Obstacle hand;
      hand.capsules = truth.hands.capsules[at];
      gaps.push_back(std::make_unique<ObstacleGaps>(std::move(hand)));
      obstacles.push_back(std::make_unique<ExactObstacles>(*gaps.back()));
      seen.push_back(obstacles.back().get());
    }
    const double ms = players->advance(seen);
    const std::vector<const Obstacles*> of_three{seen[pressed], nullptr, nullptr};
    const double ms_alone = alone->advance({&seen[pressed], 1}),
                 ms_three = three->advance(of_three);
    if (players->is_anything_near()) {
      answer.milliseconds.push_back(ms);
      answer.milliseconds_alone.push_back(ms_alone);
      answer.milliseconds_three.push_back(ms_three);
    }
    answer.imbalance = std::max(answer.imbalance, players->imbalance());
    const auto touching = [&](std::size_t k) { return players->by_others(k).norm() > kTouches; };
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      if (k != pressed && touching(k)) { answer.between_penetration.push_back(players->between()); }
    }
    if (!truths.front().lines.contains(frame)) continue;
    ++answer.frames;
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const Truth& truth = truths[k];
      const auto line = truth.lines.find(frame);
      if (line == truth.lines.end()) continue;
      const ValuedSurface true_skin = value_or_throw(
          read_valued_ply(deformed_skin_file(truth.folder, frame), kVonMisesProperty));
      const Matrix3Xd true_u = true_skin.surface.vertices - truth.rest;
      const Matrix3Xd u = players->skin(k).cast<double>() - bodies[k].body.body.surface.vertices;
      const bool moved = true_u.colwise().norm().maxCoeff() > 1e-4;  // m: else nothing is relative
      if (moved) {
        answer.displacement.push_back(displacement_error(true_u, u, truth.areas).relative);
        const std::span<const float> found = players->von_mises(k);
        const Eigen::VectorXd stress =
            Eigen::Map<const Eigen::VectorXf>(found.data(), std::ssize(found)).cast<double>();
        answer.stress.push_back((stress - true_skin.values).norm() / true_skin.values.norm());
      }
      if (k == pressed) continue;  // on the others nothing but bodies acts
      const Vector3d true_force = bodies[k].scene_from_body.linear() * line->second.force;
      const bool here = touching(k), truly = true_force.norm() > kTouches;
      answer.touching += here;
      answer.touching_true += truly;
      answer.disagree += here != truly;
      if (truly) {
        answer.between_force.push_back((players->by_others(k) - true_force).norm() /
                                       true_force.norm());
      }
    }
  }
  return answer;
}

}  // namespace palpable
