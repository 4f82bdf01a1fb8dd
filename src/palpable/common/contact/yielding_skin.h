/// @file
/// The skin of a body with tables of touch as what presses another body: where it is now, how it
/// faces, and how it gives way to forces on it, to first order.
///
///   F  vertices of the skin     V  vertices that the tables know (touch_skin.h)
#pragma once

#include "palpable/common/contact/moving_surface.h"
#include "palpable/common/contact/obstacles.h"
#include "palpable/common/contact/surface_gap.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/touch_tables.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <memory>
#include <span>
#include <vector>

namespace palpable {

/// Allocates in its constructor. The gaps that it tells leave OtherSkin::body at -1: the number of
/// a body is known only to whoever has several of them.
class YieldingSkin : public Obstacles {
 public:
  /// @param skin    closed; at rest
  /// @param tables  outlive this; null: a skin that moves, but does not give way
  YieldingSkin(const SurfaceMesh& skin, const TouchTables* tables);
  ~YieldingSkin() override;
  YieldingSkin(YieldingSkin&&) noexcept;

  [[nodiscard]] bool gives_way() const { return give_ != nullptr; }

  /// @param vertices  (3 x F) m, where it is from now on
  void move(const Eigen::Matrix3Xf& vertices) { surface_.move(vertices); }
  /// Forces that press it there. @param forces  N, at vertices that the tables know
  void bear(std::span<const VertexForce> forces);

  [[nodiscard]] const MovingSurface& surface() const { return surface_; }

  /// Places and gaps are in the frame of this body. A place that lies deeper than 20 mm inside has
  /// an infinite gap, as one that lies farther than kGapReach outside.
  void find_gaps(std::span<const Eigen::Vector3f> places,
                 std::span<SurfaceGap> gaps) const override;
  [[nodiscard]] bool may_be_within(const Eigen::Vector3f& place, float reach) const override {
    return surface_.may_be_within(place, reach);
  }
  /// Adds the compliance that the tables know; without tables, nothing.
  /// @param points  on this skin, normals in its frame
  void add_compliance(std::span<const YieldingPoint> points, std::span<double> W) const override;
  /// What is nearest to a place, 20 mm away at most; false: nothing.
  bool find(const Eigen::Vector3f& place, OtherSkin& on) const;

  /// A force at a place of the skin, as forces at vertices that the tables know: appended.
  void add_shares(const OtherSkin& on, const Eigen::Vector3f& force,
                  std::vector<VertexForce>& forces) const;

 private:
  struct Give;  // by the tables
  [[nodiscard]] SurfaceGap gap_of(const Eigen::Vector3f& place) const;
  MovingSurface surface_;
  std::unique_ptr<Give> give_;
};

}  // namespace palpable
