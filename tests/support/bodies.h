/// @file
/// A small body whose behaviour is known in closed form, shared by the tests of the live half.
#pragma once

#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace palpable::test {

/// A ball that stands on Z = 0 and can be pressed at six sites (+-X, +-Y, top and one oblique).
///
/// Pressed at site s to `level`, a vertex moves along the load, towards the centre, by
///
///     u(X) = level * full_depth * w_s(X) * direction_s,   w_s = exp(-|X - X_s|^2 / (radius/2)^2)
///
/// so the middle of the patch moves by level * full_depth. The stress is -level * 1 kPa * w_s in
/// all three normal components plus shear xy of level * 1 kPa * w_s: von Mises sqrt(3) kPa there.
/// Vertices below a fifth of the radius are fixed (w_s is set to zero there).
inline ReducedBody pressed_ball(double radius = 0.05, double full_depth = 0.01,
                                int subdivisions = 3, int level_count = 5) {
  const Eigen::Vector3d centre(0, 0, radius);
  SurfaceMesh surface = sphere_surface(centre, radius, subdivisions);
  const int V = surface.vertex_count();
  const auto neighbours = vertex_neighbours(surface);
  const Eigen::VectorXd areas = vertex_areas(surface);

  std::vector<std::uint8_t> fixed(static_cast<std::size_t>(V));
  for (int v = 0; v < V; ++v) { fixed[v] = surface.vertices(2, v) < 0.2 * radius; }
  std::vector<Site> sites;
  for (const Eigen::Vector3d& outwards :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, 1, 0),
        Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 1, 1)}) {
    Eigen::Index vertex = 0;
    (outwards.normalized().transpose() * (surface.vertices.colwise() - centre)).maxCoeff(&vertex);
    Site site;
    site.vertex = static_cast<int>(vertex);
    site.patch = graph_patch(neighbours, site.vertex, 2);
    double sum = 0;
    for (const int v : site.patch) sum += areas[v];
    for (const int v : site.patch) site.weights.push_back(static_cast<float>(areas[v] / sum));
    site.direction = (centre - surface.vertices.col(vertex)).normalized();
    site.full_load = 2.0;
    sites.push_back(site);
  }

  const auto S = static_cast<Eigen::Index>(sites.size());
  const Eigen::VectorXd levels = Eigen::VectorXd::LinSpaced(level_count, 0.0, 1.0);
  Eigen::MatrixXf u_modes = Eigen::MatrixXf::Zero(3 * V, S),
                  s_modes = Eigen::MatrixXf::Zero(6 * V, S);
  Eigen::MatrixXd press_depth(level_count, S);
  for (Eigen::Index s = 0; s < S; ++s) {
    const Site& site = sites[s];
    double mean = 0;
    for (int v = 0; v < V; ++v) {
      const double r = (surface.vertices.col(v) - surface.vertices.col(site.vertex)).norm();
      const double w = fixed[v] ? 0.0 : std::exp(-r * r / (0.25 * radius * radius));
      u_modes.col(s).segment<3>(3 * v) = (full_depth * w * site.direction).cast<float>();
      const float kPa = static_cast<float>(1e3 * w);
      s_modes.col(s).segment<6>(6 * v) << -kPa, -kPa, -kPa, kPa, 0, 0;
      for (std::size_t k = 0; k < site.patch.size(); ++k) {
        if (site.patch[k] == v) mean += static_cast<double>(site.weights[k]) * full_depth * w;
      }
    }
    press_depth.col(s) = mean * levels;
  }
  const ParameterAxis site_axis{"site", Eigen::VectorXd::LinSpaced(S, 0.0, double(S - 1)),
                                Eigen::MatrixXd::Identity(S, S), Between::kNothing};
  const ParameterAxis level_axis{"level", levels, levels.replicate(1, S), Between::kSmooth};
  ReducedBody body{.name = "ball",
                   .surface = std::move(surface),
                   .fixed = std::move(fixed),
                   .sites = std::move(sites),
                   .displacement = {u_modes, {site_axis, level_axis}},
                   .stress = {s_modes, {site_axis, level_axis}},
                   .press_depth = std::move(press_depth),
                   .largest_von_mises = std::numbers::sqrt3 * 1e3,
                   .error = {},
                   .material = "closed form of a test",
                   .provenance = {.others = {{"source", "tests/support/bodies.h"}, {"note", ""}}}};
  tabulate_press(body);
  return body;
}

/// The same body with two further parameters: displacement and depth are proportional to softness
/// (1 + heat), the load at level 1 to 3 - softness. Samples: softness 0.5, 1, 2 (default 1), heat
/// 0, 0.5, 1 (default 0). It also has a volume mesh, a single tetrahedron.
inline ReducedBody with_further(ReducedBody body) {
  const Eigen::Vector3d softness(0.5, 1, 2), heat(0, 0.5, 1);
  const Eigen::Vector3d growth = (1 + heat.array()).matrix();
  const auto longer = [&](const SeparatedField& field, Eigen::MatrixXf F) {
    std::vector<ParameterAxis> axes = field.axes();
    axes.push_back({"softness", softness, softness.replicate(1, F.cols()), Between::kSmooth});
    axes.push_back({"heat", heat, growth.replicate(1, F.cols()), Between::kSmooth});
    return SeparatedField(std::move(F), std::move(axes));
  };
  Eigen::Matrix3Xd nodes(3, 4);
  nodes << 0, 0.01, 0, 0, 0, 0, 0.01, 0, 0, 0, 0, 0.01;
  const SeparatedField& u = body.displacement;
  body.volume.emplace(BodyVolume{nodes, Eigen::Vector4i(0, 1, 2, 3),
                                 longer(u, u.modes().topRows(12)),
                                 longer(body.stress, body.stress.modes().topRows(24))});
  body.displacement = longer(u, u.modes());
  body.stress = longer(body.stress, body.stress.modes());
  body.further = {{"softness", softness, 1}, {"heat", heat, 0}};
  const auto S = static_cast<Eigen::Index>(body.sites.size());
  body.further_press_depth.resize(body.press_depth.rows(), 9 * S);
  body.further_full_load.resize(S, 9);
  for (Eigen::Index a = 0; a < 3; ++a) {
    for (Eigen::Index b = 0; b < 3; ++b) {
      const Eigen::Index k = 3 * a + b;
      body.further_press_depth.middleCols(k * S, S) = softness[a] * growth[b] * body.press_depth;
      body.further_full_load.col(k).setConstant((3 - softness[a]) * body.sites[0].full_load);
    }
  }
  return body;
}

/// The ball with an energy in four modes, so that several loads may act. Each mode moves the skin
/// along one axis, more at larger heights, except the last, which makes it broader; the strain is
/// quadratic in the amplitudes, like Green's. There is one reaction, 3 N towards the centre at the
/// lowest free vertex.
inline ReducedBody with_several(ReducedBody body) {
  constexpr Eigen::Index n = 4, P = 10, m = 12;
  const Eigen::Index V = body.surface.vertices.cols();
  const double height = body.surface.vertices.row(2).maxCoeff();
  SeveralLoads several;
  several.modes = Eigen::MatrixXf::Zero(3 * V, n);
  Eigen::Index lowest = -1;
  for (Eigen::Index v = 0; v < V; ++v) {
    if (body.fixed[v] != 0) continue;
    const Eigen::Vector3d X = body.surface.vertices.col(v);
    const auto up = static_cast<float>(0.01 * X.z() / height);
    for (Eigen::Index i = 0; i < 3; ++i) several.modes(3 * v + i, i) = up;
    several.modes.col(3).segment<2>(3 * v) = (0.2 * X.head<2>()).cast<float>();
    if (lowest < 0 || X.z() < body.surface.vertices(2, lowest)) lowest = v;
  }
  // W = 1/2 |e q + 1/2 g qq|^2 with arbitrary coefficients; 0.02 J at amplitude 1.
  Eigen::MatrixXd e(m, n), g(m, P);
  const auto some = [](Eigen::Index number) {
    return std::cos(1.0 + 0.7 * double(number * number));
  };
  for (Eigen::Index r = 0; r < m; ++r) {
    for (Eigen::Index i = 0; i < n; ++i) e(r, i) = 0.1 * some(r * n + i);
    for (Eigen::Index p = 0; p < P; ++p) g(r, p) = 0.3 * some(100 + r * P + p);
  }
  DistinctCoefficients distinct{Eigen::VectorXd(P), Eigen::VectorXd(20), Eigen::VectorXd(35)};
  const auto gg = [&](Eigen::Index i, Eigen::Index j) { return g.col(pair_row(i, j)); };
  Eigen::Index of_pair = 0, of_three = 0, of_four = 0;
  for (Eigen::Index l = 0; l < n; ++l) {
    for (Eigen::Index k = 0; k <= l; ++k) {
      distinct.quadratic[of_pair++] = e.col(k).dot(e.col(l));
      for (Eigen::Index j = 0; j <= k; ++j) {
        distinct.cubic[of_three++] =
            e.col(j).dot(gg(k, l)) + e.col(k).dot(gg(j, l)) + e.col(l).dot(gg(j, k));
        for (Eigen::Index i = 0; i <= j; ++i) {
          distinct.quartic[of_four++] =
              gg(i, j).dot(gg(k, l)) + gg(i, k).dot(gg(j, l)) + gg(i, l).dot(gg(j, k));
        }
      }
    }
  }
  several.energy = energy_of(static_cast<int>(n), distinct);
  Site reaction;
  reaction.vertex = static_cast<int>(lowest);
  reaction.patch = {reaction.vertex};
  reaction.weights = {1.0f};
  const Eigen::Vector3d X = body.surface.vertices.col(lowest);
  reaction.direction = (Eigen::Vector3d(0, 0, 0.5 * height) - X).normalized();
  reaction.full_load = 3.0;
  several.reactions = {reaction};
  several.checked = 6;
  several.error_median = 0.004;
  several.error_worst = 0.02;
  body.several = std::move(several);
  return body;
}

}  // namespace palpable::test
