/// @file
/// One of the bodies of a modal contact (modal_contact.h): what is made of it once, and its present
/// shape. All of the shape is summed only where somebody asks for it; while Newton's method goes
/// on, places of single points tell enough.
///
///   V  vertices of the skin     W  nodes of its shell     n  modes     C  contact points
#pragma once

#include "palpable/common/contact/moving_surface.h"
#include "palpable/common/contact/skin_clusters.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/modal_stress.h"
#include "palpable/common/response/modal_tables.h"
#include "palpable/common/response/packed_energy.h"
#include "palpable/common/response/shell_stress.h"
#include "palpable/common/response/skin_normals.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// A heap's points may lie so much farther from its middle than at rest, where the skin is
/// stretched.
inline constexpr float kHeapStretch = 1.2f;

/// Neighbouring heaps of contact points (skin_clusters.h), so that most heaps need not be asked
/// for.
struct HeapBlock {
  int first = 0;  ///< heaps()[first] .. [last - 1]
  int last = 0;
  float radius = 0;             ///< m, at rest: the largest of them
  Eigen::AlignedBox3f middles;  ///< m, of the heaps' vertices, where they are now
};

/// A body that is answered, and where it stands.
struct ModalMember {
  const ReducedBody* body = nullptr;    ///< with SeveralLoads
  const ModalTables* tables = nullptr;  ///< of it
  Rigid3 world_from_body = Rigid3::Identity();
};

/// Whether two have the same shape, modes, energy and shell: beams from one file.
[[nodiscard]] bool are_twins(const ModalMember& one, const ModalMember& other);

/// Allocates in its constructor.
class ModalBody {
 public:
  /// @param member  what it points to outlives this. @pre trouble_of(tables, body) is empty
  /// @param twin    a body of the same make (are_twins()), or none: both read the same numbers,
  ///                which then need not come from memory twice. To be asked on the same thread
  explicit ModalBody(const ModalMember& member, const ModalBody* twin = nullptr);

  [[nodiscard]] const ModalMember& member() const { return member_; }
  [[nodiscard]] Eigen::Index modes() const { return n_; }

  /// (C) where things may press, and their levels (point_levels.h).
  [[nodiscard]] std::span<const SkinPoint> points() const { return points_; }
  [[nodiscard]] std::span<const float> levels() const { return levels_; }
  /// The same points in heaps: those of a heap are order()[first] .. [last - 1].
  [[nodiscard]] std::span<const SkinCluster> heaps() const { return heaps_; }
  [[nodiscard]] std::span<const int> order() const { return clusters_.order(); }
  /// m between the points that a flat seen object is asked at, and those that the sharpest is.
  [[nodiscard]] float coarsest() const { return coarsest_; }
  [[nodiscard]] float finest() const { return finest_; }
  /// m between the points that are asked of other bodies: skins that lie on each other are flat.
  [[nodiscard]] float spacing_between() const { return between_; }
  /// Those points.
  [[nodiscard]] std::span<const int> points_between() const { return points_between_; }

  /// (n) amplitudes now.
  [[nodiscard]] const Eigen::VectorXd& q() const { return q_; }
  void set_q(const Eigen::VectorXd& q);
  /// q += share * step. @return m that the vertex moved that moved most, of some over the skin:
  /// modes are smooth
  double move(const Eigen::VectorXd& step, double share);
  /// m, of the same vertices: how far the body is from rest.
  [[nodiscard]] double farthest() const;

  /// How the modes move a point of the skin, sum_k weights_k F(corner k): (n x 3) a direction a
  /// column. @param rows  with at least n rows
  void find_rows(const Eigen::Vector3i& corners, const Eigen::Vector3f& weights,
                 Eigen::Ref<Eigen::MatrixXf> rows) const;
  /// m, where that point is now.
  [[nodiscard]] Eigen::Vector3f place(const Eigen::Vector3f& at_rest,
                                      const Eigen::Ref<const Eigen::MatrixXf>& rows) const {
    return at_rest + rows.transpose() * narrow_q_;
  }
  [[nodiscard]] Eigen::Vector3f rest_place(int point) const { return places_.col(point); }
  [[nodiscard]] Eigen::Vector3f rest_place(const Eigen::Vector3i& corners,
                                           const Eigen::Vector3f& weights) const;
  /// Unit, outwards, of the skin at a contact point, as it is now.
  [[nodiscard]] Eigen::Vector3f normal(int point);
  /// m, of a point of the skin at rest from the nearest edge that the body has, 1 at most.
  [[nodiscard]] float from_edge(const Eigen::Vector3i& corners,
                                const Eigen::Vector3f& weights) const;
  /// (3 x V) m, all of the skin, and distances to it.
  const Eigen::Matrix3Xf& skin();
  const MovingSurface& surface();
  /// Of the skin as it is now: its heaps in blocks, and a box that holds all contact points.
  std::span<const HeapBlock> blocks();
  Eigen::AlignedBox3f bounds();

  /// Of the skin as it is now. @param normals  (3 x V) unit
  void find_normals(Eigen::Matrix3Xf& normals) { normals_.find(skin(), normals); }
  /// The true stress on the skin now, Pa. @param von_mises  (V)  @param cauchy  (6V) or empty
  /// @pre the tables have a shell
  void stress(std::span<float> von_mises, std::span<float> cauchy);

  /// W' and W'' at q. (n), (n x n)
  void evaluate(Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) {
    energy_->evaluate(q_, gradient, hessian);
  }

 private:
  void sum(const Eigen::MatrixXf& F, float* u) const;
  void changed();
  void arrange_heaps();

  ModalMember member_;
  Eigen::Index n_, V_;
  Eigen::Matrix3Xf rest_;
  std::vector<SkinPoint> points_;
  Eigen::Matrix3Xf places_;  // (3 x C) m, at rest
  float coarsest_, finest_, between_;
  std::vector<float> levels_;
  SkinClusters clusters_;
  std::vector<SkinCluster> heaps_;  // along a curve
  std::vector<HeapBlock> blocks_;
  std::vector<int> points_between_;
  std::vector<float> rows_;               // (V x 3 x n) of the modes: vertex, direction, mode
  const Eigen::MatrixXf* modes_;          // (3V x n)
  std::shared_ptr<PackedEnergy> energy_;  // this one's and its twins'
  MovingSurface surface_;
  SkinNormals normals_;
  std::vector<float> from_edge_;  // (V) m, at rest
  // One of the two, if there is a shell; the first is its twins', too.
  std::shared_ptr<ModalStress> stress_;
  std::optional<ShellStress> shell_;

  Eigen::VectorXd q_;
  Eigen::VectorXf narrow_q_;              // the same
  Eigen::Matrix3Xf u_, x_;                // (3 x V) m: displacement and place
  Eigen::Matrix3Xf shell_u_;              // (3 x W) m
  Eigen::MatrixXf probes_;                // (3 probes x n) of the modes
  Eigen::Matrix3Xf probe_u_, probe_was_;  // of them
  bool is_skin_old_ = false, is_surface_old_ = false, are_blocks_old_ = true;
};

}  // namespace palpable
