#include "palpable/bake/contact_sites.h"

#include "palpable/base/contract.h"
#include "palpable/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace palpable {
namespace {

// The candidate with the largest distance, the lowest number among equals.
std::size_t farthest(const std::vector<double>& distances) {
  return static_cast<std::size_t>(std::max_element(distances.begin(), distances.end()) -
                                  distances.begin());
}

}  // namespace

std::vector<Site> choose_sites(const SurfaceMesh& skin, const std::vector<std::uint8_t>& fixed,
                               const SiteSettings& settings) {
  PALPABLE_EXPECT(fixed.size() == static_cast<std::size_t>(skin.vertex_count()),
                  "one flag per vertex");
  PALPABLE_EXPECT(settings.count >= 1 && settings.patch_distance >= 0, "at least one site");
  const auto neighbours = vertex_neighbours(skin);
  const Eigen::VectorXd areas = vertex_areas(skin);
  const Eigen::Vector3d centre = enclosed_centroid(skin);

  std::vector<int> candidates;
  for (int v = 0; v < skin.vertex_count(); ++v) {
    if (skin.vertices(2, v) < settings.lowest) continue;
    const std::vector<int> patch = graph_patch(neighbours, v, settings.patch_distance);
    if (std::none_of(patch.begin(), patch.end(),
                     [&](int p) { return fixed[static_cast<std::size_t>(p)] != 0; })) {
      candidates.push_back(v);
    }
  }
  if (candidates.size() < static_cast<std::size_t>(settings.count)) {
    throw Error(fmt::format(
        "only {} of {} surface vertices may be contact sites (at or above {:.4g} m, patch clear of "
        "the support), {} are asked for: ask for fewer, or mesh finer",
        candidates.size(), skin.vertex_count(), settings.lowest, settings.count));
  }

  std::vector<double> distances(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    distances[i] = (skin.vertices.col(candidates[i]) - centre).norm();
  }
  std::size_t next = farthest(distances);
  std::fill(distances.begin(), distances.end(), std::numeric_limits<double>::infinity());

  std::vector<Site> sites;
  while (sites.size() < static_cast<std::size_t>(settings.count)) {
    const Eigen::Vector3d x = skin.vertices.col(candidates[next]);
    Site site;
    site.vertex = candidates[next];
    site.patch = graph_patch(neighbours, site.vertex, settings.patch_distance);
    double patch_area = 0;
    for (const int p : site.patch) patch_area += areas[p];
    for (const int p : site.patch)
      site.weights.push_back(static_cast<float>(areas[p] / patch_area));
    site.direction = (centre - x).normalized();
    if (!site.direction.allFinite() || site.direction.isZero()) {
      throw Error(
          fmt::format("site {} lies at the centre of mass: no load points there", sites.size()));
    }
    sites.push_back(std::move(site));
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      distances[i] = std::min(distances[i], (skin.vertices.col(candidates[i]) - x).norm());
    }
    next = farthest(distances);
  }
  return sites;
}

}  // namespace palpable
