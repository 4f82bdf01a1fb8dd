/// @file
/// Separated representations of whatever origin, and the body that one can press with them.
///
///   V  vertices   m  modes   p  parameters   n_j  samples of parameter j
#pragma once

#include "palpable/geometry/surface_mesh.h"
#include "palpable/reduced/reduced_body.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// What another program's file says. Parameters are in any order and under any name.
struct ForeignModes {
  SurfaceMesh surface;                        ///< m
  SeparatedField displacement;                ///< (3V) m
  std::optional<SeparatedField> stress = {};  ///< (6V) Pa: xx yy zz xy yz zx
  /// Of the sites, where the file says it: their vertices, and (3 x S) loads in N at the last
  /// level.
  std::vector<int> site_vertices = {};
  Eigen::Matrix3Xd site_loads = {};
};

struct ImportSettings {
  std::string name = "imported";
  std::string site = "site";    ///< which parameter is the place of the touch; a choice
  std::string level = "level";  ///< which is the load, from its first sample to its last
  std::vector<std::pair<std::string, std::string>> provenance = {};
};

/// A body of them. What the file does not say is found from the field:
///
/// * no parameter of the site's name: one site.
/// * a site's vertex: the one that moves most at the last level; its load: along that displacement,
///   1 N. The patch is of graph distance 2, shared by nodal areas.
/// * the level's samples are scaled to end at 1; if the first is above 0, rest is put before it.
/// * a vertex is held where no mode moves it.
/// * no stress: zero.
/// @throws Error if the surface is not watertight, there is no such level, a site's patch does not
///         move farther with every level, or the sizes do not fit
[[nodiscard]] ReducedBody body_of_modes(const ForeignModes& modes, const ImportSettings& settings);

/// What another program needs of a body.
[[nodiscard]] ForeignModes modes_of_body(const ReducedBody& body);

}  // namespace palpable
