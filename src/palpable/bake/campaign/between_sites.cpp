#include "palpable/bake/campaign/between_sites.h"

#include "palpable/bake/describe/body_mesh.h"
#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::VectorXd;

// A response divided by the displacement of its own vertex: a touch of 1 m depth.
VectorXd per_depth(const MatrixXf& responses, Index column, int vertex) {
  const VectorXd u = responses.col(column).cast<double>();
  return u / u.segment<3>(Index{3} * vertex).norm();
}

}  // namespace

BetweenSites between_sites(const SurfaceMesh& skin, const std::vector<int>& sites,
                           const MatrixXf& site_responses, const std::vector<int>& touches,
                           const MatrixXf& touch_responses) {
  PALPABLE_EXPECT(site_responses.cols() == static_cast<Index>(sites.size()) &&
                      touch_responses.cols() == static_cast<Index>(touches.size()) &&
                      !sites.empty() && !touches.empty(),
                  "a response for each site and for each touch");
  const VectorXd areas = vertex_areas(skin).transpose().replicate(3, 1).reshaped();
  std::vector<double> errors;
  for (std::size_t t = 0; t < touches.size(); ++t) {
    const VectorXd u = per_depth(touch_responses, static_cast<Index>(t), touches[t]);
    const std::size_t s = nearest_site(skin, sites, touches[t]).site;
    const VectorXd left = u - per_depth(site_responses, static_cast<Index>(s), sites[s]);
    errors.push_back(std::sqrt(left.cwiseAbs2().dot(areas) / u.cwiseAbs2().dot(areas)));
  }
  std::sort(errors.begin(), errors.end());
  const std::size_t n = errors.size();
  return {static_cast<int>(n), errors[n / 2], errors[n * 9 / 10], errors.back()};
}

std::optional<BetweenSites> between_sites(const SnapshotStore& store) {
  const StoreContent& content = store.content();
  if (content.linear.empty()) return std::nullopt;
  const SurfaceMesh skin = split_boundary_of(content.mesh).surface;
  std::vector<int> sites;
  for (const Site& site : content.sites) sites.push_back(site.vertex);
  const std::vector<int> touches = touches_between(skin, sites, content.linear, kTouchesBetween);
  if (touches.empty()) return std::nullopt;

  std::map<int, Index> wanted;  // column of a vertex: sites, then touches
  for (const int v : sites) wanted.emplace(v, static_cast<Index>(wanted.size()));
  for (const int v : touches) wanted.emplace(v, static_cast<Index>(wanted.size()));
  const auto S = static_cast<Index>(sites.size());
  MatrixXf responses(Index{3} * skin.vertex_count(), static_cast<Index>(wanted.size()));
  Index found = 0;
  for (int k = 0; k < content.linear_file_count(); ++k) {
    if (!store.has_linear(k)) return std::nullopt;
    const MatrixXf row = store.linear(k);
    for (Index i = 0; i < row.cols(); ++i) {
      const auto at = wanted.find(content.linear[Index{kLinearRow} * k + i]);
      if (at == wanted.end()) continue;
      responses.col(at->second) = row.col(i);
      ++found;
    }
  }
  if (found < responses.cols()) return std::nullopt;
  return between_sites(skin, sites, responses.leftCols(S), touches,
                       responses.rightCols(responses.cols() - S));
}

}  // namespace palpable
