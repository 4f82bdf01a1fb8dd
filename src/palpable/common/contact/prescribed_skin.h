/// @file
/// A body that does not deform under forces: contact points of other bodies press its skin, whose
/// vertices are prescribed.
///
///   V  vertices
#pragma once

#include "palpable/common/base/contract.h"
#include "palpable/common/contact/contact_body.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

/// Allocates in its constructor.
class PrescribedSkin final : public ContactBody {
 public:
  /// @param skin  closed; at rest
  explicit PrescribedSkin(const SurfaceMesh& skin)
      : rest_(skin.vertices.cast<float>()), now_at_(rest_), surface_(skin) {}

  /// Sets its present positions. @param vertices  (3 x V) m
  void move(const Eigen::Matrix3Xf& vertices) {
    const bool moves = vertices != rest_;
    if (moves || has_moved_) {
      now_at_ = vertices;
      surface_.move(vertices);
    }
    has_moved_ = moves;
  }

  [[nodiscard]] SkinPointSet contact_points() const override { return {}; }
  [[nodiscard]] const ContactLimits& limits() const override { return kNoLimits; }
  void make_room_for_others() override {
    next_.reserve(kMostPlacesWithOthers);
    now_.reserve(kMostPlacesWithOthers);
  }
  void begin_frame() override {}
  [[nodiscard]] bool is_at_rest() const override { return !has_moved_; }
  [[nodiscard]] std::vector<PointForce>& forces() override { return forces_; }
  [[nodiscard]] std::vector<PointAnchor>& anchors() override { return anchors_; }
  [[nodiscard]] Eigen::Vector3f shape_at(int) override { return no_point(); }
  [[nodiscard]] Eigen::Vector3f shape_at_vertex(int vertex) override { return now_at_.col(vertex); }
  [[nodiscard]] Eigen::Vector3f shape_at(const SkinPoint& foot) override {
    return foot.at(now_at_);
  }
  [[nodiscard]] Eigen::Vector3f rest_at(const SkinPoint& foot) const override {
    return foot.at(rest_);
  }
  [[nodiscard]] Eigen::Vector3f normal_at(int) override { return no_point(); }
  [[nodiscard]] Eigen::AlignedBox3f bounds() override { return surface_.bounds(); }
  [[nodiscard]] const MovingSurface& surface() override { return surface_; }
  void clear_places() override { next_.clear(); }
  bool add_place(int) override { return false; }
  bool add_place(const SkinPoint& foot) override {
    next_.push_back(shape_at(foot));
    return true;
  }
  void begin_step(std::span<const PlaceLoad>, bool) override { now_ = next_; }
  [[nodiscard]] Eigen::Vector3f position(std::size_t place) const override { return now_[place]; }
  bool linearise() override { return true; }
  void add_compliance(std::span<const UnitForce>, Tangent, std::span<double>, std::size_t,
                      std::span<double>) override {}
  void add_tangential(std::span<const UnitForce>, Tangent, std::span<float>, std::size_t,
                      std::span<double>, std::span<double>) override {}
  [[nodiscard]] double skin_compliance(double, float, bool) const override { return 0; }
  void find_step(std::span<const Eigen::Vector3f>) override {}
  double move(std::span<const Eigen::Vector3f>, double) override { return 0; }
  void form_shape(bool) override {}
  [[nodiscard]] bool has_moved(double) const override { return false; }
  void keep(bool) override { forces_.clear(); }
  void end_frame(double) override {}
  [[nodiscard]] double moved() const override { return 0; }
  void limit_step(double) override {}

 private:
  static Eigen::Vector3f no_point() {
    PALPABLE_EXPECT(false, "a prescribed skin has no contact points");
    return Eigen::Vector3f::Zero();
  }
  static constexpr ContactLimits kNoLimits{};

  Eigen::Matrix3Xf rest_, now_at_;  // (3 x V) m
  MovingSurface surface_;
  bool has_moved_ = false;
  std::vector<PointForce> forces_;
  std::vector<PointAnchor> anchors_;         // none: it has no points
  std::vector<Eigen::Vector3f> next_, now_;  // positions of feet, m
};

}  // namespace palpable
