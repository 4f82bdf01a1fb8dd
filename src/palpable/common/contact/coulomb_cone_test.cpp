#include "palpable/common/contact/coulomb_cone.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::tolerance;

using RowsD = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using RowsF = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kSpacing = 0.002;  // m, between points
constexpr double kRadius = 0.008;   // m, of the ball

// Compliance of an elastic half space, z upwards, between points `x` apart (Boussinesq, Cerruti;
// Johnson, Contact Mechanics, 3.2 and 3.6). A point itself counts as a disc.
Matrix3d half_space(const Vector2d& x, double nu) {
  const double shear = 3e5 / 2 / (1 + nu);
  const double c = 1 / (2 * 3.14159265358979 * shear);
  Matrix3d G = Matrix3d::Zero();
  const double r = x.norm();
  if (r == 0) {
    const double own = 0.28 * kSpacing;
    G.diagonal() << c * (1 - nu / 2) / own, c * (1 - nu / 2) / own, c * (1 - nu) / own;
    return G;
  }
  const double across = c * (1 - 2 * nu) / 2 / (r * r);
  G(0, 0) = c * ((1 - nu) / r + nu * x.x() * x.x() / (r * r * r));
  G(1, 1) = c * ((1 - nu) / r + nu * x.y() * x.y() / (r * r * r));
  G(0, 1) = G(1, 0) = c * nu * x.x() * x.y() / (r * r * r);
  G(2, 2) = c * (1 - nu) / r;
  G(0, 2) = across * x.x();
  G(1, 2) = across * x.y();
  G(2, 0) = -G(0, 2);
  G(2, 1) = -G(1, 2);
  return G;
}

// A ball that is pressed into a half space and moved aside.
struct Ball {
  std::size_t m = 0;
  RowsD W, W_tt;
  RowsF W_nt;
  VectorXd q, q_t, mu;
  std::vector<std::size_t> contacts;

  Ball(double depth, const Vector2d& aside, double friction, double nu) {
    std::vector<Vector2d> at;
    for (int i = -3; i <= 3; ++i) {
      for (int j = -3; j <= 3; ++j) {
        if (i * i + j * j <= 9) at.emplace_back(kSpacing * i, kSpacing * j);
      }
    }
    m = at.size();
    const auto n = static_cast<Index>(m);
    W.resize(n, n);
    W_tt.resize(2 * n, 2 * n);
    W_nt = RowsF::Zero(n, 64);
    q.resize(n);
    q_t.resize(2 * n);
    mu = VectorXd::Constant(n, friction);
    for (Index i = 0; i < n; ++i) {
      const Vector2d& x = at[static_cast<std::size_t>(i)];
      for (Index j = 0; j < n; ++j) {
        Matrix3d G = half_space(x - at[static_cast<std::size_t>(j)], nu);
        if (i == j) G.diagonal() *= 1.01;
        W(i, j) = G(2, 2);
        W_tt.block<2, 2>(2 * i, 2 * j) = G.topLeftCorner<2, 2>();
        W_nt(i, 2 * j) = static_cast<float>(G(2, 0));
        W_nt(i, 2 * j + 1) = static_cast<float>(G(2, 1));
      }
      q[i] = x.squaredNorm() / (2 * kRadius) - depth;
      q_t.segment<2>(2 * i) = -aside;  // the ball moved by `aside`, the points not yet
      contacts.push_back(static_cast<std::size_t>(i));
    }
  }

  [[nodiscard]] ConeProblem problem() const {
    const std::size_t k = contacts.size();
    return {.W = {W.data(), m * m},
            .q = {q.data(), m},
            .W_nt = {W_nt.data(), m * 64},
            .wide = 64,
            .W_tt = {W_tt.data(), 4 * k * k},
            .q_t = {q_t.data(), 2 * k},
            .contacts = contacts,
            .mu = {mu.data(), k},
            .tolerance = 1e-6};
  }
};

struct Forces {
  std::vector<double> f, t;
  ConeOutcome outcome;
};

Forces solved(const Ball& ball) {
  CoulombCone cone;
  cone.make_room(ball.m);
  Complementarity normal(static_cast<int>(ball.m));
  Forces forces{std::vector<double>(ball.m), std::vector<double>(2 * ball.m), {}};
  forces.outcome = cone.solve(ball.problem(), normal, forces.f, forces.t);
  return forces;
}

// Checks all conditions of the problem by themselves.
void check_conditions(const Ball& ball, const Forces& forces) {
  const auto n = static_cast<Index>(ball.m);
  const Eigen::Map<const VectorXd> f(forces.f.data(), n), t(forces.t.data(), 2 * n);
  const VectorXd g = ball.W * f + ball.W_nt.leftCols(2 * n).cast<double>() * t + ball.q;
  const VectorXd s =
      ball.W_nt.leftCols(2 * n).cast<double>().transpose() * f + ball.W_tt * t + ball.q_t;
  for (Index i = 0; i < n; ++i) {
    INFO("point " << i);
    CHECK(f[i] >= 0);
    CHECK(g[i] > -tolerance(1e-6, "m: that of the solver"));
    CHECK(std::min(g[i], ball.W(i, i) * f[i]) < tolerance(1e-6, "m"));
    const Vector2d rub = t.segment<2>(2 * i), slip = s.segment<2>(2 * i);
    const double bound = ball.mu[i] * f[i];
    CHECK(rub.norm() <= bound * (1 + tolerance(1e-9, "rounding")));
    if (rub.norm() < 0.999 * bound) {
      CHECK(slip.norm() < tolerance(3e-6, "m: it sticks"));
    } else if (bound * ball.W_tt(2 * i, 2 * i) > 1e-4 && slip.norm() > 1e-5) {
      CHECK(rub.dot(slip) < -(1 - tolerance(0.01, "against the slip")) * bound * slip.norm());
    }
  }
}

TEST_CASE("forces lie in Coulomb's cone, and friction acts against the slip",
          "[contact][friction]") {
  for (const double nu : {0.0, 0.4, 0.49}) {
    for (const double mu : {0.1, 0.5, 1.0, 3.0}) {
      for (const double aside : {0.0, 3e-4, 2e-3}) {
        INFO("nu " << nu << ", mu " << mu << ", aside " << aside << " m");
        const Ball ball(0.002, Vector2d(aside, 0.3 * aside), mu, nu);
        const Forces forces = solved(ball);
        REQUIRE(forces.outcome.is_solved);
        CHECK(forces.outcome.residual <= tolerance(1e-6, "m: as asked for"));
        check_conditions(ball, forces);
      }
    }
  }
}

TEST_CASE("Gauss-Seidel and Alart-Curnier find the same forces", "[contact][friction]") {
  for (const double aside : {0.0, 3e-4, 2e-3}) {
    INFO(aside << " m aside");
    const Ball ball(0.002, Vector2d(0, aside), 0.5, 0.4);
    CoulombCone cone;
    cone.make_room(ball.m);
    Complementarity normal(static_cast<int>(ball.m));
    Forces one{std::vector<double>(ball.m), std::vector<double>(2 * ball.m), {}};
    one.outcome = cone.solve_by_rounds(ball.problem(), normal, one.f, one.t, 20);
    REQUIRE(one.outcome.residual <= 1e-6);
    Forces other{std::vector<double>(ball.m), std::vector<double>(2 * ball.m), {}};
    for (std::size_t i = 0; i < ball.m; ++i) {
      other.f[i] = 0.9 * one.f[i];
      other.t[2 * i] = 0.9 * one.t[2 * i];
      other.t[2 * i + 1] = 0.9 * one.t[2 * i + 1];
    }
    other.outcome = cone.solve_by_newton(ball.problem(), other.f, other.t, 10);
    REQUIRE(other.outcome.is_solved);
    REQUIRE(other.outcome.residual <= 1e-6);
    double largest = 0, apart = 0;
    for (std::size_t i = 0; i < ball.m; ++i) {
      largest = std::max(largest, one.f[i]);
      apart =
          std::max({apart, std::abs(one.f[i] - other.f[i]), std::abs(one.t[2 * i] - other.t[2 * i]),
                    std::abs(one.t[2 * i + 1] - other.t[2 * i + 1])});
    }
    CHECK(apart < tolerance(0.01, "residuals of 1e-6 m of 2 mm, compliance of a point") * largest);
  }
}

TEST_CASE("without a coefficient the problem is that of normal forces", "[contact][friction]") {
  const Ball ball(0.002, Vector2d(1e-3, 0), 0, 0.4);
  const Forces forces = solved(ball);
  Complementarity normal(static_cast<int>(ball.m));
  std::vector<double> f(ball.m);
  REQUIRE(normal.solve(ball.problem().W, ball.problem().q, f));
  CHECK(forces.f == f);
  CHECK(std::all_of(forces.t.begin(), forces.t.end(), [](double t) { return t == 0; }));
}

TEST_CASE("a ball that is moved aside sticks, then slides with mu times the normal force",
          "[contact][friction]") {
  const auto sum = [](const std::vector<double>& values, std::size_t first, std::size_t step) {
    double all = 0;
    for (std::size_t i = first; i < values.size(); i += step) all += values[i];
    return all;
  };
  const Forces little = solved(Ball(0.002, Vector2d(1e-5, 0), 0.5, 0.4));
  const Forces far = solved(Ball(0.002, Vector2d(5e-3, 0), 0.5, 0.4));
  // The friction on the skin is along the motion of the ball.
  CHECK(sum(little.t, 0, 2) > 0);
  CHECK(sum(little.t, 0, 2) < 0.1 * 0.5 * sum(little.f, 0, 1));
  CHECK(sum(far.t, 0, 2) == Approx(0.5 * sum(far.f, 0, 1)).epsilon(tolerance(0.01, "all slide")));
}

TEST_CASE("the problem with friction allocates nothing, and gives the same bytes",
          "[contact][friction]") {
  const Ball ball(0.002, Vector2d(1e-3, 0), 0.5, 0.4);
  CoulombCone cone;
  cone.make_room(ball.m);
  Complementarity normal(static_cast<int>(ball.m));
  Forces one{std::vector<double>(ball.m), std::vector<double>(2 * ball.m), {}}, other = one;
  cone.solve(ball.problem(), normal, one.f, one.t);
  const ConeProblem problem = ball.problem();
  CHECK(test::allocations_during([&] { cone.solve(problem, normal, other.f, other.t); }) == 0);
  CHECK(one.f == other.f);
  CHECK(one.t == other.t);
}

}  // namespace
}  // namespace palpable
