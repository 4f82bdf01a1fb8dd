/// @file
/// What a body file stores so that a body can be touched anywhere, by any obstacle, at several
/// positions at once.
///
///   V  vertices of the skin, or of a coarser one that carries it     W  nodes of its shell
///   (shell_table.h), the vertices first
#pragma once

#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/nonlinear_response.h"
#include "palpable/common/response/region.h"
#include "palpable/common/response/shell_table.h"
#include "palpable/common/response/stated_error.h"
#include "palpable/common/response/vibration_table.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// The coarser skin for which the tables of touch of a body with a fine skin are made. The fine
/// skin moves with it (touch_skin.h).
struct CoarseSkin {
  SurfaceMesh surface;              ///< m, body frame, in the state without contact
  std::vector<std::uint8_t> fixed;  ///< (V) 1 where the support holds the vertex
};

struct TouchTables {
  std::optional<CoarseSkin> coarse;  ///< the skin of the V vertices; none: the body's own skin
  ComplianceTable compliance;
  std::vector<RegionTable> regions;  ///< none: the response is linear
  CrossTable cross;
  ShellTable shell;                         ///< for the stress
  double region_reach = 0.018;              ///< m from a region's middle, for loads; see RegionMap
  double point_spacing = 0.002;             ///< m between contact points, see skin_points.h
  std::vector<HeldOutTouch> held_out = {};  ///< the tables' accuracy; none: not known
  /// Coulomb's coefficient of friction of the skin against bare skin or a dry thing; 0: none, as in
  /// body files that have no coefficient. The held-out touches are with it.
  double friction = 0;
  /// Vibration modes, for inertia; none: no mass, as in body files older than them and of bodies
  /// without a density.
  std::optional<VibrationTable> vibration = {};
};

/// The coefficient of silicone rubber against dry human skin: 0.61 with a standard deviation of
/// 0.21 between subjects and sites (M. Zhang, A. F. T. Mak, Prosthet. Orthot. Int. 23, 135-141,
/// 1999; five materials, six sites, ten subjects).
inline constexpr double kRubberOnSkin = 0.6;
/// The largest coefficient that is accepted: beyond it every point that presses sticks.
inline constexpr double kMostFriction = 10;
[[nodiscard]] inline bool is_friction(double mu) { return mu >= 0 && mu <= kMostFriction; }

/// Size of the tables.
[[nodiscard]] std::size_t bytes_of(const TouchTables& tables);
/// Size of the part that only the stress needs: the shell, and all rows of inner nodes.
[[nodiscard]] std::size_t stress_bytes_of(const TouchTables& tables);

/// Largest number of modes of a region or of the cross table, and of leading modes of a region.
inline constexpr int kMostTouchModes = 512, kMostLeadingModes = 64;

/// Why the tables cannot belong to a skin; empty if they can. Reasons are tables that are
/// inconsistent or hold numbers that are not finite, another number of vertices, a coarser skin in
/// another position, or contact points so close to each other that there would be more than
/// 300,000.
[[nodiscard]] std::string trouble_of(const TouchTables& tables, const SurfaceMesh& skin);

}  // namespace palpable
