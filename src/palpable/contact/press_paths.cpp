#include "palpable/contact/press_paths.h"

#include "palpable/base/contract.h"

#include <array>
#include <cstddef>

namespace palpable {

std::vector<SitePath> press_paths(const ReducedBody& body, double least_share) {
  PALPABLE_EXPECT(0 < least_share && least_share <= 1, "a share is in (0, 1]");
  const Eigen::Matrix3Xf X = body.surface.vertices.cast<float>();
  const Eigen::Index V = X.cols();
  const Eigen::VectorXd& levels = body.levels();
  const Eigen::Index L = levels.size();

  std::vector<SitePath> paths(body.sites.size());
  Eigen::Matrix3Xf u(3, V);
  const std::span<float> values(u.data(), static_cast<std::size_t>(u.size()));
  for (std::size_t s = 0; s < paths.size(); ++s) {
    const Site& site = body.sites[s];
    SitePath& path = paths[s];
    body.displacement.evaluate(std::array{static_cast<double>(s), levels[L - 1]}, values);
    float most = 0;
    for (const int k : site.patch) most = std::max(most, u.col(k).norm());
    std::vector<char> follows(static_cast<std::size_t>(V), 0);
    for (Eigen::Index k = 0; k < V; ++k) {
      follows[k] = u.col(k).norm() >= static_cast<float>(least_share) * most;
    }
    for (const int k : site.patch) follows[k] = 1;
    for (Eigen::Index k = 0; k < V; ++k) {
      const bool fixed = body.fixed[k] != 0;
      if (follows[k] != 0 && !fixed) { path.vertices.push_back(static_cast<int>(k)); }
    }
    path.positions.resize(3, static_cast<Eigen::Index>(path.vertices.size()) * L);
    for (Eigen::Index l = 0; l < L; ++l) {
      body.displacement.evaluate(std::array{static_cast<double>(s), levels[l]}, values);
      for (std::size_t j = 0; j < path.vertices.size(); ++j) {
        const int k = path.vertices[j];
        path.positions.col(static_cast<Eigen::Index>(j) * L + l) = X.col(k) + u.col(k);
      }
    }
  }
  return paths;
}

}  // namespace palpable
