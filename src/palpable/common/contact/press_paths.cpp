#include "palpable/common/contact/press_paths.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace palpable {
namespace {

// Whether a point is a vertex of the site's patch.
bool is_in_patch(const SkinPoint& point, const Site& site) {
  return point.weights[0] == 1 &&
         std::find(site.patch.begin(), site.patch.end(), point.corners[0]) != site.patch.end();
}

}  // namespace

double level_that_moves(const SitePath& path, const Eigen::VectorXd& levels, double depth) {
  const Eigen::VectorXd& moved = path.farthest;
  if (!(depth > moved[0])) return levels[0];
  for (Eigen::Index l = 1; l < levels.size(); ++l) {
    if (moved[l] < depth) continue;
    const double t = (depth - moved[l - 1]) / (moved[l] - moved[l - 1]);
    return levels[l - 1] + t * (levels[l] - levels[l - 1]);
  }
  return levels[levels.size() - 1];
}

std::vector<SitePath> press_paths(const ReducedBody& body, std::span<const SkinPoint> skin,
                                  double least_share) {
  PALPABLE_EXPECT(0 < least_share && least_share <= 1, "a share is in (0, 1]");
  const Eigen::Matrix3Xf X = body.surface.vertices.cast<float>();
  const Eigen::VectorXd& levels = body.levels();
  const Eigen::Index L = levels.size();

  std::vector<SitePath> paths(body.sites.size());
  Eigen::Matrix3Xf u(3, X.cols());
  const std::span<float> values(u.data(), static_cast<std::size_t>(u.size()));
  for (std::size_t s = 0; s < paths.size(); ++s) {
    const Site& site = body.sites[s];
    SitePath& path = paths[s];
    body.displacement.evaluate(std::array{static_cast<double>(s), levels[L - 1]}, values);
    float most = 0;
    for (const int k : site.patch) most = std::max(most, u.col(k).norm());
    const float least = static_cast<float>(least_share) * most;
    for (std::size_t k = 0; k < skin.size(); ++k) {
      if (skin[k].at(u).norm() >= least || is_in_patch(skin[k], site)) {
        path.points.push_back(static_cast<int>(k));
      }
    }
    path.positions.resize(3, std::ssize(path.points) * L);
    path.farthest.setZero(L);
    for (Eigen::Index l = 0; l < L; ++l) {
      body.displacement.evaluate(std::array{static_cast<double>(s), levels[l]}, values);
      for (const int k : site.patch) {
        path.farthest[l] = std::max(path.farthest[l], static_cast<double>(u.col(k).norm()));
      }
      if (l > 0) path.farthest[l] = std::max(path.farthest[l], path.farthest[l - 1]);
      const Eigen::Matrix3Xf x = X + u;
      for (Eigen::Index j = 0; j < std::ssize(path.points); ++j) {
        path.positions.col(j * L + l) = skin[path.points[j]].at(x);
        path.box.extend(path.positions.col(j * L + l));
      }
    }
  }
  return paths;
}

}  // namespace palpable
