#include "palpable/bake/describe/contact_sites.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace palpable {
namespace {

// The candidate with the largest distance, the lowest number among equals.
std::size_t farthest(const std::vector<double>& distances) {
  return static_cast<std::size_t>(std::max_element(distances.begin(), distances.end()) -
                                  distances.begin());
}

// Mean outward normal of the patch, not normalised: of its triangles, or of those around its middle
// where it is too small to hold one.
Eigen::Vector3d patch_normal(const SurfaceMesh& skin, const std::vector<int>& patch) {
  const auto in_patch = [&](int v) {
    return std::find(patch.begin(), patch.end(), v) != patch.end();
  };
  Eigen::Vector3d within = Eigen::Vector3d::Zero(), around = within;
  for (const auto& t : skin.triangles.colwise()) {
    const auto corner = [&](int k) -> Eigen::Vector3d { return skin.vertices.col(t[k]); };
    const bool touches = (t.array() == patch.front()).any();
    const bool inside = std::all_of(t.begin(), t.end(), in_patch);
    if (!touches && !inside) continue;
    const Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    if (touches) around += normal;
    if (inside) within += normal;
  }
  return within.isZero(0.0) ? around : within;
}

// Makes sites from vertices; holds the data that all sites share.
class SiteMaker {
 public:
  SiteMaker(const SurfaceMesh& skin, const std::vector<std::uint8_t>& fixed,
            const SiteSettings& settings)
      : skin_(skin),
        fixed_(fixed),
        settings_(settings),
        neighbours_(vertex_neighbours(skin)),
        areas_(settings.areas.size() > 0 ? settings.areas : vertex_areas(skin)),
        centre_(enclosed_centroid(skin)) {
    PALPABLE_EXPECT(fixed.size() == static_cast<std::size_t>(skin.vertex_count()),
                    "one flag per vertex");
    PALPABLE_EXPECT(areas_.size() == skin.vertex_count(), "one area per vertex");
    PALPABLE_EXPECT(settings.patch_distance >= 0, "a patch has an extent");
  }

  [[nodiscard]] const Eigen::Vector3d& centre() const { return centre_; }
  [[nodiscard]] bool is_fixed(int vertex) const { return fixed_[vertex] != 0; }
  [[nodiscard]] std::vector<int> patch_of(int vertex) const {
    return graph_patch(neighbours_, vertex, settings_.patch_distance);
  }

  [[nodiscard]] Site make(int vertex) const {
    Site site;
    site.vertex = vertex;
    site.patch = patch_of(vertex);
    std::erase_if(site.patch, [&](int v) { return is_fixed(v); });
    double patch_area = 0;
    for (const int p : site.patch) patch_area += areas_[p];
    // A patch of a single corner of 10-node elements has no area: its vertex takes all of the load.
    const bool has_area = patch_area > 0.0;
    for (const int p : site.patch) {
      site.weights.push_back(has_area ? static_cast<float>(areas_[p] / patch_area)
                                      : (p == vertex ? 1.0f : 0.0f));
    }
    site.direction = direction(site);
    return site;
  }

 private:
  [[nodiscard]] Eigen::Vector3d direction(const Site& site) const {
    const Eigen::Vector3d x = skin_.vertices.col(site.vertex);
    Eigen::Vector3d towards = settings_.given;
    if (settings_.direction == SiteDirection::kToCentre) towards = centre_ - x;
    if (settings_.direction == SiteDirection::kAlongNormal) {
      towards = -patch_normal(skin_, site.patch);
    }
    const double length = towards.norm();
    if (!(length > 0.0) || !std::isfinite(length)) {
      throw Error(
          fmt::format("the site at ({:.4g}, {:.4g}, {:.4g}) m has no direction: it lies at "
                      "the centre of mass, or its patch has no normal; give a 'direction' "
                      "in [sites]",
                      x[0], x[1], x[2]));
    }
    return towards / length;
  }

  const SurfaceMesh& skin_;
  const std::vector<std::uint8_t>& fixed_;
  const SiteSettings& settings_;
  std::vector<std::vector<int>> neighbours_;
  Eigen::VectorXd areas_;
  Eigen::Vector3d centre_;
};

// Farthest points; the first is the one farthest from `centre`.
std::vector<int> far_apart(const SurfaceMesh& skin, const std::vector<int>& candidates,
                           const Eigen::Vector3d& centre, int count) {
  std::vector<double> distances(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    distances[i] = (skin.vertices.col(candidates[i]) - centre).norm();
  }
  std::size_t next = farthest(distances);
  std::fill(distances.begin(), distances.end(), std::numeric_limits<double>::infinity());
  std::vector<int> chosen;
  while (chosen.size() < static_cast<std::size_t>(count)) {
    const Eigen::Vector3d x = skin.vertices.col(candidates[next]);
    chosen.push_back(candidates[next]);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      distances[i] = std::min(distances[i], (skin.vertices.col(candidates[i]) - x).norm());
    }
    next = farthest(distances);
  }
  return chosen;
}

std::vector<int> most_salient(const SurfaceMesh& skin, std::vector<int> candidates,
                              const SiteSettings& settings) {
  const Eigen::VectorXd score = salience(skin, settings.patch_distance);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&](int a, int b) { return score[a] > score[b]; });
  const Eigen::VectorXd areas = vertex_areas(skin);
  double area = 0.0;
  for (const int v : candidates) area += areas[v];
  const auto count = static_cast<std::size_t>(settings.count);
  std::vector<int> chosen;
  for (double apart = 0.5 * std::sqrt(area / settings.count); chosen.size() < count;
       apart *= 2.0 / 3.0) {
    for (const int v : candidates) {
      if (chosen.size() == count) break;
      const bool is_free = std::all_of(chosen.begin(), chosen.end(), [&](int other) {
        return other != v && (skin.vertices.col(other) - skin.vertices.col(v)).norm() >= apart;
      });
      if (is_free) chosen.push_back(v);
    }
  }
  return chosen;
}

}  // namespace

Eigen::VectorXd salience(const SurfaceMesh& skin, int patch_distance) {
  const auto normal = [&](Eigen::Index t) -> Eigen::Vector3d {
    const Eigen::Vector3d a = skin.vertices.col(skin.triangles(0, t));
    return (Eigen::Vector3d(skin.vertices.col(skin.triangles(1, t))) - a)
        .cross(Eigen::Vector3d(skin.vertices.col(skin.triangles(2, t))) - a)
        .normalized();
  };
  // The mean curvature integrated over an edge is half of angle * length; each end gets half of
  // that.
  Eigen::VectorXd bend = Eigen::VectorXd::Zero(skin.vertex_count());
  std::map<std::pair<int, int>, Eigen::Index> triangle_of;
  for (Eigen::Index t = 0; t < skin.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      triangle_of[{skin.triangles(k, t), skin.triangles((k + 1) % 3, t)}] = t;
    }
  }
  for (const auto& [edge, t] : triangle_of) {
    const auto [from, to] = edge;
    const auto other = triangle_of.find({to, from});
    if (from > to || other == triangle_of.end()) continue;
    const Eigen::Vector3d along = skin.vertices.col(to) - skin.vertices.col(from);
    const Eigen::Vector3d a = normal(t), b = normal(other->second);
    const double angle = std::atan2(a.cross(b).dot(along.normalized()), a.dot(b));
    for (const int v : {from, to}) bend[v] += 0.25 * angle * along.norm();
  }
  const Eigen::VectorXd areas = vertex_areas(skin);
  const std::vector<std::vector<int>> neighbours = vertex_neighbours(skin);
  Eigen::VectorXd result(skin.vertex_count());
  for (int v = 0; v < skin.vertex_count(); ++v) {
    double bent = 0.0, area = 0.0;
    for (const int p : graph_patch(neighbours, v, patch_distance)) {
      bent += bend[p];
      area += areas[p];
    }
    result[v] = area > 0.0 ? std::abs(bent / area) : 0.0;
  }
  return result;
}

namespace {

// Why so few vertices may be sites, setting by setting.
std::string why_few_sites(int candidates, int low, int near_support, int count,
                          const SiteSettings& settings) {
  std::string why = fmt::format(
      "only {} of {} surface vertices may be contact sites where 'count' in [sites] is {}",
      candidates, count, settings.count);
  if (low > 0) {
    why += fmt::format("; {} lie lower than 'above' in [sites] allows ({:.4g} m)", low,
                       settings.lowest);
  }
  if (near_support > 0) {
    why += fmt::format(
        "; of {} the patch ('patch' in [sites]: {} edges around) reaches what [support] holds",
        near_support, settings.patch_distance);
  }
  why += ": ask for fewer";
  if (low > 0) why += ", lower 'above'";
  if (near_support > 0) {
    why += settings.patch_distance > 0 ? ", make 'patch' smaller, hold less" : ", hold less";
  }
  return why + ", or mesh finer";
}

}  // namespace

std::vector<Site> choose_sites(const SurfaceMesh& skin, const std::vector<std::uint8_t>& fixed,
                               const SiteSettings& settings) {
  PALPABLE_EXPECT(settings.count >= 1, "at least one site");
  const SiteMaker maker(skin, fixed, settings);
  std::vector<int> candidates;
  int low = 0, near_support = 0;
  for (int v = 0; v < skin.vertex_count(); ++v) {
    if (skin.vertices(2, v) < settings.lowest) {
      ++low;
      continue;
    }
    const std::vector<int> patch = maker.patch_of(v);
    if (std::none_of(patch.begin(), patch.end(), [&](int p) { return maker.is_fixed(p); })) {
      candidates.push_back(v);
    } else {
      ++near_support;
    }
  }
  if (candidates.size() < static_cast<std::size_t>(settings.count)) {
    throw Error(why_few_sites(static_cast<int>(candidates.size()), low, near_support,
                              skin.vertex_count(), settings));
  }

  std::vector<Site> sites;
  const std::vector<int> chosen = settings.choice == SiteChoice::kSalient
                                      ? most_salient(skin, candidates, settings)
                                      : far_apart(skin, candidates, maker.centre(), settings.count);
  for (const int v : chosen) sites.push_back(maker.make(v));
  return sites;
}

std::vector<Site> sites_at(const SurfaceMesh& skin, const std::vector<std::uint8_t>& fixed,
                           const std::vector<int>& vertices, const SiteSettings& settings) {
  const SiteMaker maker(skin, fixed, settings);
  std::vector<Site> sites;
  for (const int v : vertices) {
    if (maker.is_fixed(v)) {
      const Eigen::Vector3d x = skin.vertices.col(v);
      throw Error(
          fmt::format("the site at ({:.4g}, {:.4g}, {:.4g}) m lies on a node that [support] holds, "
                      "where a load "
                      "moves nothing: choose another place, or hold less",
                      x[0], x[1], x[2]));
    }
    sites.push_back(maker.make(v));
  }
  return sites;
}

}  // namespace palpable
