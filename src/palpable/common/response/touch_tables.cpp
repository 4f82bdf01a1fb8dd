#include "palpable/common/response/touch_tables.h"

#include "palpable/common/base/row_kernels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace palpable {
namespace {

constexpr double kMostPoints = 300'000;
constexpr std::size_t kMostRegions = 10'000;

std::size_t bytes(const auto& list) { return list.size() * sizeof(list[0]); }
std::size_t bytes(const RoundedRows& rows) { return bytes(rows.values) + bytes(rows.scale); }
std::size_t bytes(const SymmetricForm& form) { return bytes(form.values) + bytes(form.scale); }

std::size_t bytes_of(const ShellTable& shell) {
  std::size_t constants = 0;
  for (const Material& material : shell.materials) {
    constants += constants_of(material).size() * sizeof(double);
  }
  return static_cast<std::size_t>(shell.stress_free.size() + shell.preload.size()) *
             sizeof(double) +
         bytes(shell.elements) + bytes(shell.material_of) + constants + bytes(shell.first) +
         bytes(shell.points) + bytes(shell.weights);
}

// Whether the factors of rows, blocks or runs are finite and not negative.
bool are_scales(const std::vector<float>& scale) {
  return std::all_of(scale.begin(), scale.end(),
                     [](float s) { return std::isfinite(s) && s >= 0.0f; });
}

bool is_length(double length) { return std::isfinite(length) && length > 0.0; }

std::string trouble_of(const RoundedRows& rows, std::size_t count, std::size_t width,
                       std::string_view what) {
  if (rows.width != width || rows.scale.size() != count || rows.values.size() != count * width) {
    return fmt::format("the size of {}", what);
  }
  return are_scales(rows.scale) ? std::string() : fmt::format("a factor of {}", what);
}

std::string trouble_of(const SymmetricForm& form, int degree, int most, std::string_view what) {
  if (form.degree != degree || form.variables < 0 || form.variables > most ||
      form.values.size() != distinct_coefficients(form.variables, degree) ||
      form.scale.size() != runs_of(form.variables, degree)) {
    return fmt::format("the size of {}", what);
  }
  return are_scales(form.scale) ? std::string() : fmt::format("a factor of {}", what);
}

// An estimate of the number of contact points on a skin: skin_points.h divides each triangle by its
// longest edge.
double points_on(const SurfaceMesh& skin, double spacing) {
  double sum = skin.vertex_count();
  for (int t = 0; t < skin.triangle_count(); ++t) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      const auto edge = skin.vertices.col(skin.triangles(k, t)) -
                        skin.vertices.col(skin.triangles((k + 1) % 3, t));
      longest = std::max(longest, edge.norm());
    }
    const double parts = std::ceil(longest / spacing);
    sum += 0.5 * parts * parts;
  }
  return sum;
}

// Counts the clusters of which all nodes are in a list; -1 if only some nodes of one are.
class WholeClusters {
 public:
  explicit WholeClusters(const ComplianceTable& table)
      : table_(table), size_(index(table.clusters), 0), found_(size_.size(), 0) {
    for (const int c : table.cluster_of) ++size_[index(c)];
  }

  [[nodiscard]] int count(const std::vector<int>& nodes) {
    std::fill(found_.begin(), found_.end(), 0);
    for (const int n : nodes) ++found_[index(table_.cluster_of[index(n)])];
    int whole = 0;
    for (std::size_t c = 0; c < size_.size(); ++c) {
      if (found_[c] == 0) continue;
      if (found_[c] != size_[c]) return -1;
      ++whole;
    }
    return whole;
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  const ComplianceTable& table_;
  std::vector<int> size_, found_;  // (C) nodes
};

// @pre the compliance is consistent
std::string trouble_of(const RegionTable& table, const ComplianceTable& compliance,
                       WholeClusters& clusters) {
  const int r = table.mode_count(), V = compliance.vertices, W = compliance.nodes();
  const auto width = static_cast<std::size_t>(std::max(0, r));
  if (r < 1 || r > kMostTouchModes || width % kRowStep != 0) return "its number of modes";
  const std::vector<int>& known = table.vertices;
  const bool rise = std::is_sorted(known.begin(), known.end()) &&
                    std::adjacent_find(known.begin(), known.end()) == known.end();
  if (!rise || (!known.empty() && (known.front() < 0 || known.back() >= W))) {
    return "its list of vertices";
  }
  const int own = clusters.count(known);
  if (own < 0) return "its list of vertices";
  if (table.vertex < 0 || table.vertex >= V) return "its middle";
  const std::size_t f = table.far_count();
  if (f > static_cast<std::size_t>(kMostTouchModes) || f % kRowStep != 0)
    return "its number of far shapes";
  const std::size_t far =
      static_cast<std::size_t>(compliance.clusters - own) * compliance.basis.width;
  for (const std::string& trouble :
       {trouble_of(table.modes, 3 * known.size(), width, "its modes"),
        trouble_of(table.far_shapes, far, f, "its far shapes"),
        trouble_of(table.far_shares, f, width, "its far shares"),
        trouble_of(table.cubic, 3, kMostTouchModes, "its second order"),
        trouble_of(table.quartic, 4, std::min(r, kMostLeadingModes), "its third order")}) {
    if (!trouble.empty()) return trouble;
  }
  return {};
}

// Largest distance of the coarser skin's bounding box from the body's, as a ratio to its diagonal.
constexpr double kSamePlace = 0.1;

std::string trouble_of(const CoarseSkin& coarse, const SurfaceMesh& skin) {
  const SurfaceMesh& surface = coarse.surface;
  const int V = surface.vertex_count();
  if (V < 4 || surface.triangle_count() < 4) return "has no vertices";
  if (!surface.vertices.allFinite()) return "has positions that are not finite";
  if (surface.triangles.minCoeff() < 0 || surface.triangles.maxCoeff() >= V) {
    return "has triangles of vertices that are not there";
  }
  if (coarse.fixed.size() != static_cast<std::size_t>(V))
    return "does not say which vertices are held";
  const Eigen::Vector3d low = skin.vertices.rowwise().minCoeff(),
                        high = skin.vertices.rowwise().maxCoeff();
  const double apart = std::max((surface.vertices.rowwise().minCoeff() - low).norm(),
                                (surface.vertices.rowwise().maxCoeff() - high).norm());
  return apart <= kSamePlace * (high - low).norm() ? "" : "is not where the body's is";
}

std::string trouble_of(const CrossTable& table, int nodes) {
  const std::string form = trouble_of(table.cubic, 3, kMostTouchModes, "its second order");
  if (!form.empty()) return form;
  const auto x = static_cast<std::size_t>(table.cubic.variables);
  if (x == 0 && table.modes.values.empty() && table.modes.scale.empty()) return {};
  if (x % kRowStep != 0) return "its number of modes";
  return trouble_of(table.modes, 3 * static_cast<std::size_t>(nodes), x, "its modes");
}

}  // namespace

std::size_t bytes_of(const TouchTables& tables) {
  const ComplianceTable& c = tables.compliance;
  std::size_t sum = bytes(c.cluster_of) + bytes(c.basis) + bytes(c.beyond) + bytes(c.far_first) +
                    bytes(c.far_second) + bytes(c.couplings) + bytes(c.first) +
                    bytes(c.neighbours) + bytes(c.near) + bytes(c.near_scale);
  for (const RegionTable& region : tables.regions) {
    sum += bytes(region.vertices) + bytes(region.modes) + bytes(region.far_shapes) +
           bytes(region.far_shares) + bytes(region.cubic) + bytes(region.quartic);
  }
  if (tables.coarse) {
    const SurfaceMesh& coarse = tables.coarse->surface;
    sum += static_cast<std::size_t>(coarse.vertices.size()) * sizeof(double) +
           static_cast<std::size_t>(coarse.triangles.size()) * sizeof(int) +
           bytes(tables.coarse->fixed);
  }
  if (tables.vibration) sum += bytes_of(*tables.vibration);
  return sum + bytes(tables.cross.modes) + bytes(tables.cross.cubic) + bytes_of(tables.shell);
}

std::size_t stress_bytes_of(const TouchTables& tables) {
  const ComplianceTable& c = tables.compliance;
  const auto V = static_cast<std::size_t>(c.vertices);
  const std::size_t inner = c.cluster_of.size() - V;
  // Bytes of three rows of 16-bit numbers, with their factors.
  const auto rows = [](std::size_t width) { return 3 * (2 * width + sizeof(float)); };
  std::size_t sum = bytes_of(tables.shell) + inner * (sizeof(int) + 2 * rows(c.basis.width)) +
                    inner * rows(tables.cross.modes.width);
  for (std::size_t v = 0; v < V; ++v) {
    const auto first = c.neighbours.begin() + c.first[v],
               last = c.neighbours.begin() + c.first[v + 1];
    const auto all = static_cast<std::size_t>(last - first);
    const auto skin = static_cast<std::size_t>(std::lower_bound(first, last, c.vertices) - first);
    sum += (all - skin) * sizeof(int) + 9 * 2 * (padded(all) - padded(skin));
  }
  if (tables.vibration) {
    sum += 3 * inner * static_cast<std::size_t>(tables.vibration->mode_count()) * sizeof(float);
  }
  for (const RegionTable& region : tables.regions) {
    const auto inside = region.vertices.end() - std::lower_bound(region.vertices.begin(),
                                                                 region.vertices.end(), c.vertices);
    sum += static_cast<std::size_t>(inside) * (sizeof(int) + rows(region.modes.width));
  }
  return sum;
}

std::string trouble_of(const TouchTables& tables, const SurfaceMesh& skin) {
  const ComplianceTable& c = tables.compliance;
  if (tables.coarse) {
    const std::string trouble = trouble_of(*tables.coarse, skin);
    if (!trouble.empty()) return "the coarser skin " + trouble;
  }
  const int V = tables.coarse ? tables.coarse->surface.vertex_count() : skin.vertex_count();
  if (const std::string_view trouble = trouble_of(c); !trouble.empty()) {
    return fmt::format("the compliance is wrong in {}", trouble);
  }
  if (!are_scales(c.basis.scale) || !are_scales(c.beyond.scale) || !are_scales(c.couplings.scale) ||
      !are_scales(c.near_scale)) {
    return "the compliance is wrong in a factor";
  }
  if (c.vertices != V) {
    return fmt::format("the compliance is of {} vertices where the skin has {}", c.vertices, V);
  }
  if (tables.regions.size() > kMostRegions) {
    return fmt::format("there are {} regions, more than {}", tables.regions.size(), kMostRegions);
  }
  WholeClusters clusters(c);
  for (std::size_t k = 0; k < tables.regions.size(); ++k) {
    const std::string trouble = trouble_of(tables.regions[k], c, clusters);
    if (!trouble.empty()) return fmt::format("region {} is wrong in {}", k, trouble);
  }
  if (const std::string trouble = trouble_of(tables.cross, c.nodes()); !trouble.empty()) {
    return fmt::format("the cross terms are wrong in {}", trouble);
  }
  if (const std::string_view trouble = trouble_of(tables.shell, V); !trouble.empty()) {
    return fmt::format("the shell is wrong in {}", trouble);
  }
  if (tables.shell.nodes() != c.nodes()) {
    return fmt::format("the shell is of {} nodes where the compliance has {}", tables.shell.nodes(),
                       c.nodes());
  }
  if (tables.vibration) {
    const std::string_view trouble = trouble_of(*tables.vibration, c.nodes());
    if (!trouble.empty()) return fmt::format("the vibration modes are wrong in {}", trouble);
  }
  if (const std::string trouble = trouble_of(tables.held_out); !trouble.empty()) {
    return fmt::format("the held-out touches are wrong in {}", trouble);
  }
  if (!is_friction(tables.friction)) return "the coefficient of friction is not from 0 to 10";
  if (!is_length(tables.region_reach)) return "the reach of regions is no length";
  if (!is_length(tables.point_spacing)) return "the spacing of contact points is no length";
  if (const double points = points_on(skin, tables.point_spacing); !(points <= kMostPoints)) {
    return fmt::format("contact points {:.3g} m apart would be {:.2g}, more than {:.2g}",
                       tables.point_spacing, points, kMostPoints);
  }
  return {};
}

}  // namespace palpable
