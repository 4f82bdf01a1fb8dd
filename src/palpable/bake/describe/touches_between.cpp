#include "palpable/bake/describe/touches_between.h"

#include <algorithm>

namespace palpable {

NearestSite nearest_site(const SurfaceMesh& skin, const std::vector<int>& sites, int vertex) {
  NearestSite near;
  for (std::size_t s = 0; s < sites.size(); ++s) {
    if (sites[s] == vertex) continue;
    const double distance = (skin.vertices.col(sites[s]) - skin.vertices.col(vertex)).norm();
    if (distance < near.distance) near = {s, distance};
  }
  return near;
}

std::vector<int> touches_between(const SurfaceMesh& skin, const std::vector<int>& sites,
                                 const std::vector<int>& touchable, int most) {
  if (sites.size() < 2) return {};
  double farthest = 0;
  for (const int site : sites) {
    farthest = std::max(farthest, nearest_site(skin, sites, site).distance);
  }
  std::vector<int> between;
  for (const int v : touchable) {
    if (std::find(sites.begin(), sites.end(), v) != sites.end()) continue;
    if (nearest_site(skin, sites, v).distance <= farthest) between.push_back(v);
  }
  const std::size_t n = between.size(), wanted = static_cast<std::size_t>(most);
  if (n <= wanted) return between;
  std::vector<int> some;
  for (std::size_t i = 0; i < wanted; ++i) some.push_back(between[i * n / wanted]);
  return some;
}

}  // namespace palpable
