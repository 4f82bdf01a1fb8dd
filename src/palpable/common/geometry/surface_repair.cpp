#include "palpable/common/geometry/surface_repair.h"

#include "palpable/common/geometry/oriented_sheets.h"
#include "palpable/common/geometry/shells.h"
#include "palpable/common/geometry/vertex_weld.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Corners = std::array<int, 3>;

Corners sorted_corners(const SurfaceMesh& surface, int triangle) {
  Corners corners{surface.triangles(0, triangle), surface.triangles(1, triangle),
                  surface.triangles(2, triangle)};
  std::sort(corners.begin(), corners.end());
  return corners;
}

// Whether the corners, read in the triangle's order, go round as their sorted numbers do.
bool winds_upwards(const SurfaceMesh& surface, int triangle) {
  const auto t = surface.triangles.col(triangle);
  return (t[0] < t[1]) + (t[1] < t[2]) + (t[2] < t[0]) == 2;
}

// The surface of the triangles in `kept`, with unused vertices dropped.
SurfaceMesh with_triangles(const SurfaceMesh& surface, const std::vector<int>& kept) {
  SurfaceMesh less;
  less.vertices = surface.vertices;
  less.triangles = surface.triangles(Eigen::all, kept);
  return merge_equal_vertices(less);
}

int drop_collapsed(SurfaceMesh& surface) {
  std::vector<int> kept;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const auto v = surface.triangles.col(t);
    if (v[0] != v[1] && v[1] != v[2] && v[2] != v[0]) kept.push_back(t);
  }
  const int dropped = surface.triangle_count() - static_cast<int>(kept.size());
  if (dropped == 0 || kept.empty()) return 0;
  surface = with_triangles(surface, kept);
  return dropped;
}

// The first of the triangles with the same corners. @param alike  only of those wound alike
std::vector<int> without_duplicates(const SurfaceMesh& surface, bool alike) {
  std::map<std::pair<Corners, bool>, int> first;
  std::vector<int> kept;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const bool winding = alike && winds_upwards(surface, t);
    if (first.try_emplace({sorted_corners(surface, t), winding}, t).second) kept.push_back(t);
  }
  return kept;
}

// A face that is there twice with both windings may be an export of both sides, or the wall between
// two solids that touch: it is an export if one of each pair closes the surface.
int drop_duplicates(SurfaceMesh& surface) {
  for (const bool alike : {false, true}) {
    const std::vector<int> kept = without_duplicates(surface, alike);
    const int dropped = surface.triangle_count() - static_cast<int>(kept.size());
    if (dropped == 0) continue;
    SurfaceMesh less = with_triangles(surface, kept);
    const WatertightReport report = check_watertight(less);
    if (!alike && report.open_edges + report.crowded_edges + report.bad_triangles > 0) continue;
    surface = std::move(less);
    return dropped;
  }
  return 0;
}

}  // namespace

std::string SurfaceRepair::describe() const {
  std::vector<std::string> parts;
  const auto add = [&](int count, const char* one, const char* many) {
    if (count > 0) parts.push_back(fmt::format("{} {}", count, count == 1 ? one : many));
  };
  add(welded, "vertex joined with another one", "vertices joined with others");
  if (welded > 0) parts.back() += fmt::format(" at most {:.2g} away", moved);
  add(collapsed, "triangle without area left out", "triangles without area left out");
  add(duplicates, "duplicate face left out", "duplicate faces left out");
  if (turned > 0) {
    parts.push_back(fmt::format("{} of {} faces turned, which now enclose a volume of {:.6g}",
                                turned, triangles, volume));
  }
  if (parts.empty()) return {};
  return fmt::format("repaired: {} (in the file's lengths)", fmt::join(parts, ", "));
}

SurfaceRepair repair_surface(SurfaceMesh& surface) {
  SurfaceRepair repair;
  WatertightReport report = check_watertight(surface);
  // check_watertight() judges a single shell completely. It does not see a shell that faces inwards
  // beside others.
  if (report.watertight() && shells_of(surface).size() == 1) return repair;
  if (report.open_edges > 0) {
    const VertexWeld weld = weld_open_vertices(surface);
    repair.welded = weld.welded;
    repair.moved = weld.moved;
    if (weld.welded > 0) report = check_watertight(surface);
  }
  if (report.bad_triangles > 0) repair.collapsed = drop_collapsed(surface);
  if (report.crowded_edges > 0) repair.duplicates = drop_duplicates(surface);
  repair.turned = turn_outwards(surface);
  repair.triangles = surface.triangle_count();
  if (repair.turned > 0) repair.volume = enclosed_volume(surface);
  return repair;
}

}  // namespace palpable
