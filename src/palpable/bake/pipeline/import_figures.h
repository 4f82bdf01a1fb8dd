/// @file
/// Judges the units of modes that another program has written, which no file states: lengths,
/// displacement, stress and loads.
#pragma once

#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// What an imported body amounts to, over all its sites at full load and the default values of its
/// further parameters.
struct ImportedFigures {
  Eigen::Vector3d size;        ///< m, of the bounding box
  double displacement = 0;     ///< m, the largest of a vertex
  double stress = 0;           ///< Pa, the largest von Mises stress; 0: the file has none
  std::optional<double> load;  ///< N, the largest; none: the file has none
  double patch_pressure = 0;   ///< Pa, the largest load over the area of its patch; 0 without loads
};

/// @param has_loads  whether the file states the loads of the sites, or they were assumed
[[nodiscard]] ImportedFigures figures_of(const ReducedBody& body, bool has_loads);

/// One line for people: size, largest displacement, stress and load, with units.
[[nodiscard]] std::string figures_text(const ImportedFigures& figures);

/// Warnings, each of which names the unit that is probably wrong: an implausible size
/// (body_size.h), a displacement beyond the range that a bake accepts (a third of the largest
/// extent), stress that is far from what the loads cause.
[[nodiscard]] std::vector<std::string> import_warnings(const ImportedFigures& figures);

}  // namespace palpable
