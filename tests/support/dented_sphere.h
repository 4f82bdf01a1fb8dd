/// @file
/// A small body with a known closed form, for tests of the live half: a sphere that stands on Z = 0
/// and gets a Gaussian dent where it is pressed.
#pragma once

#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace palpable::test {

/// Site s is in the unit direction d_s from the sphere's centre; vertex k is displaced by
///
///     u_k(s, level) = -d_s  depth(level)  exp(-|X_k - X_s|^2 / (2 width^2)),
///     depth(level)  = deepest (1.5 level - 0.5 level^2)        a rubber that stiffens
///
/// which a separated field with one mode per site holds exactly at the samples of the level axis.
struct DentedSphere {
  double radius = 0.05;    ///< m
  double width = 0.012;    ///< m, of the dent
  double deepest = 0.015;  ///< m, at level 1
  int subdivisions = 3;    ///< 642 vertices, 6 mm apart on 50 mm
  int samples = 11;        ///< of the level axis
  std::vector<Eigen::Vector3d> directions{{0, 0, 1}, {0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};

  [[nodiscard]] double depth(double level) const {
    return deepest * (1.5 * level - 0.5 * level * level);
  }

  [[nodiscard]] ReducedBody body() const {
    const Eigen::Vector3d centre(0, 0, radius);
    const SurfaceMesh surface = sphere_surface(centre, radius, subdivisions);
    const Eigen::Index V = surface.vertices.cols();
    const auto S = static_cast<Eigen::Index>(directions.size());
    const Eigen::VectorXd levels = Eigen::VectorXd::LinSpaced(samples, 0, 1);

    std::vector<Site> sites;
    Eigen::MatrixXf F = Eigen::MatrixXf::Zero(3 * V, S);
    Eigen::MatrixXf stress = Eigen::MatrixXf::Zero(6 * V, S);
    Eigen::MatrixXd press(samples, S);
    const auto neighbours = vertex_neighbours(surface);
    for (Eigen::Index s = 0; s < S; ++s) {
      const Eigen::Vector3d d = directions[s].normalized();
      Site site;
      ((surface.vertices.colwise() - (centre + radius * d)).colwise().squaredNorm())
          .minCoeff(&site.vertex);
      site.patch = graph_patch(neighbours, site.vertex, 2);
      site.weights.assign(site.patch.size(), 1.0f / static_cast<float>(site.patch.size()));
      site.direction = -d;
      site.full_load = 2.0 + static_cast<double>(s);
      double mean = 0;
      for (Eigen::Index k = 0; k < V; ++k) {
        const double r2 =
            (surface.vertices.col(k) - surface.vertices.col(site.vertex)).squaredNorm();
        const double share = std::exp(-r2 / (2 * width * width));
        F.col(s).segment<3>(3 * k) = (-d * deepest * share).cast<float>();
        stress.col(s).segment<3>(6 * k).setConstant(static_cast<float>(-1e4 * share));
        stress(6 * k + 2, s) *= 2;  // so that it is not hydrostatic
      }
      for (const int k : site.patch) {
        mean += static_cast<double>(-d.cast<float>().dot(F.col(s).segment<3>(3 * k))) * -1.0 /
                static_cast<double>(site.patch.size());
      }
      mean = std::abs(mean);
      for (int l = 0; l < samples; ++l) press(l, s) = mean * depth(levels[l]) / deepest;
      sites.push_back(std::move(site));
    }
    Eigen::MatrixXd growth(samples, S);
    for (int l = 0; l < samples; ++l) growth.row(l).setConstant(depth(levels[l]) / deepest);
    const ParameterAxis site_axis{"site",
                                  Eigen::VectorXd::LinSpaced(S, 0, static_cast<double>(S - 1)),
                                  Eigen::MatrixXd::Identity(S, S), Between::kNothing};
    const ParameterAxis level_axis{"level", levels, growth, Between::kSmooth};
    std::vector<std::uint8_t> fixed(static_cast<std::size_t>(V), 0);
    for (Eigen::Index k = 0; k < V; ++k) { fixed[k] = surface.vertices(2, k) < 0.1 * radius; }
    ReducedBody result{.name = "dented sphere",
                       .surface = surface,
                       .fixed = fixed,
                       .sites = std::move(sites),
                       .displacement = SeparatedField(F, {site_axis, level_axis}),
                       .stress = SeparatedField(stress, {site_axis, level_axis}),
                       .press_depth = press,
                       .largest_von_mises = 1e4,
                       .error = {},
                       .material = "closed form",
                       .provenance = {.others = {{"made by", "tests/support/dented_sphere.h"}}}};
    tabulate_press(result);
    return result;
  }
};

}  // namespace palpable::test
