#include "palpable/bake/pipeline/error_course.h"

#include "tests/support/bodies.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::VectorXf;
using test::tolerance;

TEST_CASE("numbers of modes that are kept begin at one, end at all, and grow",
          "[pipeline][reduction]") {
  for (const int most : {1, 2, 7, 12, 13, 60, 1000}) {
    for (const int count : {2, 3, 12}) {
      INFO(most << " " << count);
      const Eigen::VectorXi some = some_of(most, count);
      CHECK(some.size() == std::min(most, count));
      CHECK(some[0] == 1);
      CHECK(some.tail(1)[0] == most);
      for (Index i = 1; i < some.size(); ++i) CHECK(some[i] > some[i - 1]);
    }
  }
}

TEST_CASE("a long course is kept in part, and what is kept is true", "[pipeline][reduction]") {
  Reduction reduction;
  reduction.course.resize(200, 50'000);
  reduction.pooled_course.resize(200);
  for (Index i = 0; i < 200; ++i) {
    reduction.course.row(i).setLinSpaced(0.0, 1.0 / static_cast<double>(i + 1));
    reduction.pooled_course[i] = 0.5 / static_cast<double>(i + 1);
  }
  const ErrorCourse course = course_of(reduction);
  CHECK(course.modes.size() == 20);
  CHECK(course.snapshots.size() <= 1'000'000);
  CHECK(course.modes.tail(1)[0] == 200);
  for (Index q = 0; q < course.modes.size(); ++q) {
    CHECK(course.pooled[q] == 0.5 / course.modes[q]);
    CHECK(course.snapshots(49'999, q) == Approx(1.0 / course.modes[q]));
  }
}

// Each site of the ball has one mode of its own. A second mode is added; with one mode only, a site
// lacks it.
TEST_CASE("the course of von Mises stress is what the first modes of each site leave",
          "[pipeline][reduction]") {
  const ReducedBody body = test::pressed_ball(0.05, 0.01, 2);
  const Eigen::VectorXd areas = vertex_areas(body.surface);
  const auto V = static_cast<Index>(body.surface.vertex_count());
  const Index S = 6, L = body.levels().size() - 1;

  // Site s: its mode, and s % 2 * 0.1 of it once more as a second mode.
  std::vector<SeparatedField> blocks;
  for (Index s = 0; s < S; ++s) {
    const Index own = s;
    Eigen::MatrixXf F(6 * V, 2);
    F.col(0) = body.stress.modes().col(own);
    F.col(1) = 0.1f * F.col(0);
    ParameterAxis level = body.stress.axes()[1];
    const Eigen::VectorXd G = level.functions.col(own);
    level.functions.resize(G.size(), 2);
    level.functions << G, (s % 2 == 1 ? G : Eigen::VectorXd::Zero(G.size()).eval());
    blocks.emplace_back(std::move(F), std::vector<ParameterAxis>{level});
  }
  const SeparatedField stress = one_block_per_choice("site", blocks);
  VonMisesCourse course(stress, areas, S * L);
  VectorXf truth(6 * V);
  for (Index s = 0; s < S; ++s) {
    for (Index l = 0; l < L; ++l) {
      const std::array mu{static_cast<double>(s), body.levels()[l + 1]};
      stress.evaluate(mu, {truth.data(), static_cast<std::size_t>(truth.size())});
      course.add(s * L + l, mu, truth);
    }
  }
  const ErrorCourse result = course.result();
  REQUIRE(result.modes == Eigen::Vector2i(1, 2));
  // The modes are parallel: at odd sites the field is 1.1 with both and 1 with the first one alone.
  for (Index k = 0; k < S * L; ++k) {
    const double left = (k / L) % 2 == 1 ? 0.1 / 1.1 : 0.0;
    CHECK(std::abs(double(result.snapshots(k, 0)) - left) <= tolerance(1e-6, "single precision"));
    CHECK(std::abs(double(result.snapshots(k, 1))) <= tolerance(1e-6, "single precision"));
  }
  CHECK(result.pooled[0] > 0.01);
  CHECK(result.pooled[0] < 0.1 / 1.1);
  CHECK(result.pooled[1] <= tolerance(1e-6, "single precision"));
}

}  // namespace
}  // namespace palpable
