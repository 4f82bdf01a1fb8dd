#include "palpable/common/reduced/loaded_body.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/size_text.h"
#include "palpable/common/geometry/surface_distance.h"
#include "palpable/common/reduced/mode_kernels.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

int place_count(const ReducedBody& body) {
  const std::size_t reactions = body.several ? body.several->reactions.size() : 0;
  return static_cast<int>(body.sites.size() + reactions);
}

std::string place_name(const ReducedBody& body, int place) {
  const auto S = static_cast<int>(body.sites.size());
  return place < S ? fmt::format("site {}", place) : fmt::format("reaction {}", place - S);
}

std::string point_text(const Vector3d& X) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) m", X[0], X[1], X[2]);
}

// m, upper bound of the rounding of a body's coordinates.
double rounding_of(const SurfaceMesh& skin) { return 1e-6 * extent_of(skin.vertices).norm(); }

// m, from the patch's middle to its farthest vertex; more than 0 even for a patch of one vertex.
double patch_radius(const ReducedBody& body, const Site& site) {
  double radius = 10.0 * rounding_of(body.surface);
  for (const int v : site.patch) {
    radius = std::max(
        radius, (body.surface.vertices.col(v) - body.surface.vertices.col(site.vertex)).norm());
  }
  return radius;
}

// Outward unit normal of triangle t.
Vector3d normal_of(const SurfaceMesh& skin, Index t) {
  const Vector3d a = skin.vertices.col(skin.triangles(0, t));
  const Vector3d b = skin.vertices.col(skin.triangles(1, t));
  const Vector3d c = skin.vertices.col(skin.triangles(2, t));
  return (b - a).cross(c - a).normalized();
}

struct OnSkin {
  double distance = std::numeric_limits<double>::infinity();  // m
  // Normals of all triangles at this distance; there are several if an edge or corner is nearest.
  std::vector<Vector3d> normals = {};
};

OnSkin nearest_skin(const SurfaceMesh& skin, const Vector3d& X) {
  std::vector<double> distance;
  OnSkin nearest;
  for (Index t = 0; t < skin.triangles.cols(); ++t) {
    const auto corner = [&](int k) -> Vector3d { return skin.vertices.col(skin.triangles(k, t)); };
    const Vector3d a = corner(0), b = corner(1), c = corner(2), w = nearest_weights(a, b, c, X);
    distance.push_back((w[0] * a + w[1] * b + w[2] * c - X).norm());
    nearest.distance = std::min(nearest.distance, distance.back());
  }
  const double rounding = rounding_of(skin);
  for (Index t = 0; t < skin.triangles.cols(); ++t) {
    if (distance[t] > nearest.distance + rounding) continue;
    nearest.normals.push_back(normal_of(skin, t));
  }
  return nearest;
}

// How directly a load enters the skin, the largest value of these normals: 1 if it is perpendicular
// to the skin, 0 if parallel, -1 if it pulls.
double directness(const std::vector<Vector3d>& normals, const Vector3d& direction) {
  double most = -1;
  for (const Vector3d& n : normals) most = std::max(most, -n.dot(direction));
  return most;
}

std::vector<Vector3d> normals_at(const SurfaceMesh& skin, int vertex) {
  std::vector<Vector3d> normals;
  for (Index t = 0; t < skin.triangles.cols(); ++t) {
    if ((skin.triangles.col(t).array() == vertex).any()) normals.push_back(normal_of(skin, t));
  }
  return normals;
}

}  // namespace

const Site& load_place(const ReducedBody& body, int place) {
  PALPABLE_EXPECT(place >= 0 && place < place_count(body), "the place exists");
  const auto at = static_cast<std::size_t>(place), S = body.sites.size();
  return at < S ? body.sites[at] : body.several->reactions[at - S];
}

Result<PlacedLoad> load_at(const ReducedBody& body, const Vector3d& X, double force) {
  if (!X.allFinite()) return Problem{"a point is three numbers, m"};
  if (!(force >= 0) || !std::isfinite(force)) {
    return Problem{fmt::format("a load of {} N: loads are 0 or more", force)};
  }
  const OnSkin skin = nearest_skin(body.surface, X);
  int place = -1, facing = -1;  // the nearest, and the nearest whose load enters the skin at X
  double least = std::numeric_limits<double>::infinity(), least_facing = least;
  for (int p = 0; p < place_count(body); ++p) {
    const Site& site = load_place(body, p);
    const double distance = (body.surface.vertices.col(site.vertex) - X).norm();
    if (distance < least) {
      least = distance;
      place = p;
    }
    if (distance >= least_facing) continue;
    // Directness is a cosine: 0.5 less than at the load's own site is 60 degrees for a load that is
    // perpendicular there.
    const double there = directness(normals_at(body.surface, site.vertex), site.direction);
    if (directness(skin.normals, site.direction) < there - 0.5) continue;
    least_facing = distance;
    facing = p;
  }
  const auto nearest_text = [&](int p, double distance) {
    return fmt::format("the nearest place for one is {} at {}, {:.3g} mm away", place_name(body, p),
                       point_text(body.surface.vertices.col(load_place(body, p).vertex)),
                       1e3 * distance);
  };
  const double radius = patch_radius(body, load_place(body, place));
  if (skin.distance > 0.1 * radius) {
    const bool far = skin.distance > extent_of(body.surface.vertices).norm();
    return Problem{fmt::format("a load at {} is {:.3g} mm off the body's surface{}; {}",
                               point_text(X), 1e3 * skin.distance,
                               far ? ": coordinates are metres" : "", nearest_text(place, least))};
  }
  if (facing < 0 || least_facing > patch_radius(body, load_place(body, facing))) {
    return Problem{fmt::format(
        "a load at {} is on a part of the surface that the body was baked for no load on; {}",
        point_text(X), nearest_text(place, least))};
  }
  const Site& site = load_place(body, facing);
  if (force > site.full_load) {
    return Problem{
        fmt::format("{:.4g} N at {} is beyond the range: at {} the body was baked for "
                    "loads of up to {:.4g} N",
                    force, point_text(X), place_name(body, facing), site.full_load)};
  }
  return PlacedLoad{facing, force / site.full_load};
}

LoadedBody::LoadedBody(const ReducedBody& body)
    : body_(&body),
      newton_(body.several->energy),
      unit_(body.several->mode_count(), place_count(body)),
      f_(VectorXd::Zero(unit_.rows())),
      q_(VectorXd::Zero(unit_.rows())),
      weights_(static_cast<std::size_t>(unit_.rows())) {
  const Eigen::MatrixXf& F = body.several->modes;
  for (int p = 0; p < place_count(body); ++p) {
    const Site& site = load_place(body, p);
    VectorXd sum = VectorXd::Zero(unit_.rows());
    for (std::size_t k = 0; k < site.patch.size(); ++k) {
      const auto rows = F.middleRows<3>(3 * Index{site.patch[k]}).cast<double>();
      sum += static_cast<double>(site.weights[k]) * (rows.transpose() * site.direction);
    }
    unit_.col(p) = site.full_load * sum;
  }
}

Result<LoadedBody> LoadedBody::make(const ReducedBody& body) {
  if (!body.several) {
    return Problem{
        fmt::format("'{}' answers one load at a time: its file holds no energy of several loads "
                    "(bake it with --intrusive, and [intrusive] reactions in its description)",
                    body.name)};
  }
  return LoadedBody(body);
}

LoadedBody::Answer LoadedBody::solve(std::span<const PlacedLoad> loads) noexcept {
  Answer answer;
  double presses = 0, reactions = 0;
  const auto S = static_cast<int>(body_->sites.size());
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const auto [place, level] = loads[k];
    answer.load = static_cast<int>(k);
    if (place < 0 || place >= unit_.cols()) {
      answer.refused = LoadsRefused::kNoSuchPlace;
      return answer;
    }
    if (!(level >= 0)) {
      answer.refused = LoadsRefused::kNoLevel;
      return answer;
    }
    double& sum = place < S ? presses : reactions;
    sum += level;
    if (sum > 1.0 + 1e-9) {  // 1e-9: rounding of levels that sum up to 1
      answer.refused = LoadsRefused::kBeyondRange;
      answer.sum = sum;
      return answer;
    }
  }
  answer.load = -1;
  f_.setZero();
  for (const auto [place, level] : loads) f_ += level * unit_.col(place);
  QuarticEquilibrium::Answer found = newton_.solve(f_, q_);
  if (!found.converged) {  // the last state may be a bad start: try once more from rest
    q_.setZero();
    found = newton_.solve(f_, q_);
  }
  answer.steps = found.steps;
  answer.residual = found.residual;
  if (!found.converged) {
    answer.refused = LoadsRefused::kNoEquilibrium;
    q_.setZero();
  }
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    weights_[i] = static_cast<float>(q_[static_cast<Index>(i)]);
  }
  return answer;
}

void LoadedBody::displacement(std::span<float> u) const {
  const Eigen::MatrixXf& F = body_->several->modes;
  PALPABLE_EXPECT(static_cast<Index>(u.size()) == F.rows(), "three values per vertex");
  mode_kernels().front().sum({F.data(), static_cast<std::size_t>(F.rows()), weights_.size()},
                             weights_.data(), false, u);
}

double LoadedBody::press_depth(int place) const {
  // The modal forces of the full load times q are the work of the full load.
  return unit_.col(place).dot(q_) / load_place(*body_, place).full_load;
}

std::string refusal_text(const ReducedBody& body, const LoadedBody::Answer& answer,
                         std::span<const PlacedLoad> loads) {
  const auto refused = [&] { return loads[answer.load]; };
  switch (answer.refused) {
    case LoadsRefused::kNot:
      return "";
    case LoadsRefused::kNoSuchPlace:
      return fmt::format("load {}: there is no place {}; the body has {} sites and {} reactions",
                         answer.load, refused().place, body.sites.size(),
                         place_count(body) - static_cast<int>(body.sites.size()));
    case LoadsRefused::kNoLevel:
      return fmt::format("load {}: a level is 0 or more, not {}", answer.load, refused().level);
    case LoadsRefused::kBeyondRange:
      return fmt::format(
          "the {} together are {:.3g} of a full load, beyond the range: the body was baked for 1",
          refused().place < static_cast<int>(body.sites.size()) ? "presses" : "reactions",
          answer.sum);
    case LoadsRefused::kNoEquilibrium:
      return fmt::format("no equilibrium was found: forces are left of {:.2g} of the loads",
                         answer.residual);
  }
  return "";
}

namespace {

PressResponse under_one(const ReducedBody& body, const PlacedLoad& load) {
  const std::array<double, 2> mu{static_cast<double>(load.place), load.level};
  PressResponse response{{press_depth_of_level(body, load.place, load.level)},
                         std::vector<float>(body.displacement.value_count()),
                         {},
                         body.error.displacement_worst};
  std::vector<float> stress(2 * response.displacement.size()), of_mises(stress.size() / 6);
  body.displacement.evaluate(mu, response.displacement);
  body.stress.evaluate(mu, stress);
  von_mises(stress, of_mises);
  response.largest_von_mises = *std::max_element(of_mises.begin(), of_mises.end());
  return response;
}

PressResponse under_several(const ReducedBody& body, std::span<const PlacedLoad> loads) {
  LoadedBody loaded = value_or_throw(LoadedBody::make(body));
  const LoadedBody::Answer found = loaded.solve(loads);
  if (!found.ok()) throw Error(refusal_text(body, found, loads));
  PressResponse response;
  response.displacement.resize(body.displacement.value_count());
  loaded.displacement(response.displacement);
  for (const PlacedLoad& load : loads) response.depth.push_back(loaded.press_depth(load.place));
  response.error = body.several->error_worst;
  return response;
}

}  // namespace

PressResponse find_press_response(const ReducedBody& body, std::span<const PlacedLoad> loads) {
  PALPABLE_EXPECT(!loads.empty(), "there is at least one load");
  const bool at_one_site = loads.size() == 1 && loads[0].place < std::ssize(body.sites);
  return at_one_site ? under_one(body, loads[0]) : under_several(body, loads);
}

}  // namespace palpable
