/// @file
/// All that a body file holds for being touched anywhere, by anything, at several places at once.
///
///   V  vertices of the skin, or of a coarser one that carries it     W  nodes of its shell
///   (shell_table.h), the vertices first
#pragma once

#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/coarse_skin.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/held_out_touch.h"
#include "palpable/common/response/nonlinear_response.h"
#include "palpable/common/response/region.h"
#include "palpable/common/response/shell_table.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct TouchTables {
  std::optional<CoarseSkin> coarse;  ///< whose V vertices these are; none: the body's own skin
  ComplianceTable compliance;
  std::vector<RegionTable> regions;  ///< none: the linear answer alone
  CrossTable cross;
  ShellTable shell;              ///< for the stress
  double region_reach = 0.018;   ///< m, from a region's middle: loads that it answers for
  double point_spacing = 0.002;  ///< m, of contact points, see skin_points.h
  std::vector<HeldOutTouch> held_out = {};  ///< how good all that is; none: not known
};

/// How large the tables are.
[[nodiscard]] std::size_t bytes_of(const TouchTables& tables);
/// How much of that is there for the stress alone: the shell, and all rows of inner nodes.
[[nodiscard]] std::size_t stress_bytes_of(const TouchTables& tables);

/// Modes of one region, or of the cross table, at most, and leading ones of a region.
inline constexpr int kMostTouchModes = 512, kMostLeadingModes = 64;

/// Why tables cannot be those of a skin: one that is not consistent or holds what is no number, one
/// of other vertices, a coarser skin elsewhere, or contact points so near to each other that there
/// would be more than 300,000. Empty if they can.
[[nodiscard]] std::string trouble_of(const TouchTables& tables, const SurfaceMesh& skin);

}  // namespace palpable
