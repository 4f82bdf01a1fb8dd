#include "palpable/common/geometry/oriented_sheets.h"

#include "palpable/common/geometry/shells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;

// The triangles of a closed part, all wound alike once those in `reversed` are reversed.
struct Sheet {
  std::vector<int> triangles, reversed;
  SurfaceMesh surface;  // wound alike, facing outwards
  Eigen::AlignedBox3d box;
  bool faces_inwards = false;  // before `surface` was made to face outwards
  bool mixed = false;          // wound both ways in the file
};

struct Neighbour {
  int triangle = -1;
  bool opposite = false;  // wound the other way
};

// (M) the neighbours of each triangle over its edges; empty where an edge has not two triangles.
std::vector<std::array<Neighbour, 3>> neighbours_of(const SurfaceMesh& surface) {
  struct Side {
    int low, high, triangle, edge;
    bool forward;
  };
  std::vector<Side> sides;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = surface.triangles(k, t), b = surface.triangles((k + 1) % 3, t);
      if (a == b) return {};
      sides.push_back({std::min(a, b), std::max(a, b), t, k, a < b});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
    return std::pair(x.low, x.high) < std::pair(y.low, y.high);
  });
  std::vector<std::array<Neighbour, 3>> neighbours(sides.size() / 3);
  const auto same = [](const Side& x, const Side& y) { return x.low == y.low && x.high == y.high; };
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    if (i + 1 == sides.size() || !same(sides[i], sides[i + 1])) return {};
    if (i + 2 < sides.size() && same(sides[i], sides[i + 2])) return {};
    const Side &x = sides[i], &y = sides[i + 1];
    neighbours[x.triangle][x.edge] = {y.triangle, x.forward == y.forward};
    neighbours[y.triangle][y.edge] = {x.triangle, x.forward == y.forward};
  }
  return neighbours;
}

// The closed parts of a surface, without their geometry; empty if one of them has only one side.
std::vector<Sheet> sheets_of(const std::vector<std::array<Neighbour, 3>>& neighbours) {
  std::vector<Sheet> sheets;
  enum class Seen : char { kNo, kAsItIs, kReversed };
  std::vector<Seen> seen(neighbours.size(), Seen::kNo);
  for (std::size_t first = 0; first < neighbours.size(); ++first) {
    if (seen[first] != Seen::kNo) continue;
    seen[first] = Seen::kAsItIs;
    Sheet sheet;
    sheet.triangles.push_back(static_cast<int>(first));
    for (std::size_t at = 0; at < sheet.triangles.size(); ++at) {
      const int t = sheet.triangles[at];
      for (const Neighbour& next : neighbours[t]) {
        const bool reversed = (seen[t] == Seen::kReversed) != next.opposite;
        const Seen wanted = reversed ? Seen::kReversed : Seen::kAsItIs;
        if (seen[next.triangle] == Seen::kNo) {
          seen[next.triangle] = wanted;
          sheet.triangles.push_back(next.triangle);
        } else if (seen[next.triangle] != wanted) {
          return {};
        }
      }
    }
    for (const int t : sheet.triangles) {
      if (seen[t] == Seen::kReversed) sheet.reversed.push_back(t);
    }
    sheet.mixed = !sheet.reversed.empty();
    sheets.push_back(std::move(sheet));
  }
  return sheets;
}

void reverse(SurfaceMesh& surface, int triangle) {
  std::swap(surface.triangles(1, triangle), surface.triangles(2, triangle));
}

// The triangles of a sheet that are to be reversed for the other side.
std::vector<int> others_of(const Sheet& sheet) {
  std::vector<int> all = sheet.triangles, some = sheet.reversed, others;
  std::sort(all.begin(), all.end());
  std::sort(some.begin(), some.end());
  std::set_difference(all.begin(), all.end(), some.begin(), some.end(), std::back_inserter(others));
  return others;
}

// Sets the geometry of a sheet. False if it encloses no volume.
// @param alike  the surface with the triangles in `reversed` of all sheets reversed
bool measure(const SurfaceMesh& alike, Sheet& sheet) {
  sheet.surface = surface_of(alike, sheet.triangles);
  sheet.box = box_of(sheet.surface);
  const double volume = enclosed_volume(sheet.surface);
  sheet.faces_inwards = volume < 0.0;
  if (sheet.faces_inwards) { sheet.surface.triangles.row(1).swap(sheet.surface.triangles.row(2)); }
  return volume != 0.0 && std::isfinite(volume);
}

// The sheets around a sheet.
std::vector<std::size_t> around(const std::vector<Sheet>& sheets, std::size_t which) {
  std::vector<std::size_t> outer;
  const Vector3d at = sheets[which].surface.vertices.col(0);
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    if (s == which || !sheets[s].box.contains(at)) continue;
    if (std::lround(winding_number(sheets[s].surface, at)) == 1) outer.push_back(s);
  }
  return outer;
}

// Whether the sheet that is wound alike is to face the other way than it does in the file.
// @param outer  around() of each sheet
bool turns_with_outermost(const std::vector<Sheet>& sheets, std::size_t which,
                          const std::vector<std::vector<std::size_t>>& outer) {
  if (outer[which].empty()) return sheets[which].faces_inwards;
  return std::any_of(outer[which].begin(), outer[which].end(), [&](std::size_t s) {
    return !sheets[s].mixed && sheets[s].faces_inwards && outer[s].empty();
  });
}

}  // namespace

int turn_outwards(SurfaceMesh& surface) {
  std::vector<Sheet> sheets = sheets_of(neighbours_of(surface));
  SurfaceMesh alike = surface;
  for (const Sheet& sheet : sheets) {
    for (const int t : sheet.reversed) reverse(alike, t);
  }
  bool anything = false;
  for (Sheet& sheet : sheets) {
    if (!measure(alike, sheet)) return 0;
    anything = anything || sheet.mixed || sheet.faces_inwards;
  }
  if (!anything) return 0;
  std::vector<std::vector<std::size_t>> outer;
  for (std::size_t s = 0; s < sheets.size(); ++s) outer.push_back(around(sheets, s));
  std::vector<int> turned;
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    const Sheet& sheet = sheets[s];
    std::vector<int> mine;
    if (sheet.mixed) {
      const bool inwards = outer[s].size() % 2 == 1;
      mine = inwards == sheet.faces_inwards ? sheet.reversed : others_of(sheet);
    } else if (turns_with_outermost(sheets, s, outer)) {
      mine = sheet.triangles;
    }
    turned.insert(turned.end(), mine.begin(), mine.end());
  }
  for (const int t : turned) reverse(surface, t);
  return static_cast<int>(turned.size());
}

}  // namespace palpable
