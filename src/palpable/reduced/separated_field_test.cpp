#include "palpable/reduced/separated_field.h"

#include "palpable/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <array>

namespace palpable {
namespace {

using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;
using Eigen::VectorXf;
using test::tolerance;

// u(X, a, b) = (X_k)(a)(b^2) + (1)(1)(b) on X = (0, 1, 2), a in {0, 1}, b in {0, 1, 2}.
SeparatedField two_mode_field() {
  MatrixXf F(3, 2);
  F << 0, 1, 1, 1, 2, 1;
  ParameterAxis a{"a", VectorXd::LinSpaced(2, 0, 1), MatrixXd(2, 2), Between::kSmooth};
  a.functions << 0, 1, 1, 1;
  ParameterAxis b{"b", VectorXd::LinSpaced(3, 0, 2), MatrixXd(3, 2), Between::kSmooth};
  b.functions << 0, 0, 1, 1, 4, 2;
  return {F, {a, b}};
}

VectorXf evaluate(const SeparatedField& field, std::vector<double> mu) {
  VectorXf u(field.value_count());
  field.evaluate(mu, std::span<float>(u.data(), static_cast<std::size_t>(u.size())));
  return u;
}

// One value, one mode, one axis: G itself.
SeparatedField curve(const VectorXd& samples, const VectorXd& values) {
  return {MatrixXf::Ones(1, 1), {{"t", samples, values, Between::kSmooth}}};
}

TEST_CASE("at a sample the field is the sum of products of its factors", "[reduced][Eq4]") {
  const VectorXf u = evaluate(two_mode_field(), {1.0, 2.0});
  for (int k = 0; k < 3; ++k) CHECK(u[k] == float(k) * 4.0f + 2.0f);  // exact: small integers
}

TEST_CASE("between samples a parabola is exact, on uneven samples and at both ends", "[reduced]") {
  VectorXd t(5);
  t << 0, 0.3, 0.4, 0.8, 1.0;
  const auto parabola = [](double x) { return 2.0 - 3.0 * x + 5.0 * x * x; };
  const SeparatedField field = curve(t, t.unaryExpr(parabola));
  for (unsigned seed = 0; seed < 100; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    const double x = std::uniform_real_distribution<double>(0.0, 1.0)(random);
    CHECK(std::abs(evaluate(field, {x})[0] - parabola(x)) <=
          tolerance(5e-7, "single precision of numbers up to 4"));
  }
}

TEST_CASE("the error of interpolation falls with the third power of the spacing", "[reduced]") {
  const auto error = [](int n) {
    const VectorXd t = VectorXd::LinSpaced(n + 1, 0.0, 1.0);
    const SeparatedField field =
        curve(t, t.unaryExpr([](double x) { return 0.01 * std::exp(3 * x); }));
    double worst = 0;  // values below 0.2, so that single precision (1e-8) does not hide the order
    for (int k = 0; k < 1000; ++k) {
      const double x = (k + 0.5) / 1000.0;
      worst = std::max(worst, std::abs(double(evaluate(field, {x})[0]) - 0.01 * std::exp(3 * x)));
    }
    return worst;
  };
  const double order = std::log2(error(6) / error(12));
  CHECK(order > 3.0 - tolerance(0.3, "the end intervals carry the third-order term"));
}

TEST_CASE("the slope has no jump at a sample", "[reduced]") {
  VectorXd t(5), g(5);
  t << 0, 1, 2, 3, 4;
  g << 0, 1, 0.5, 0.6, -1;
  const SeparatedField field = curve(t, g);
  const double h = 1e-2;
  for (const double x : {1.0, 2.0, 3.0}) {
    const double middle = evaluate(field, {x})[0];
    const double before = (middle - double(evaluate(field, {x - h})[0])) / h;
    const double after = (double(evaluate(field, {x + h})[0]) - middle) / h;
    CHECK(std::abs(after - before) <= tolerance(0.1, "h times the jump of curvature, up to 9"));
  }
}

TEST_CASE("a parameter beyond its axis counts as the end of the axis", "[reduced]") {
  const SeparatedField field = two_mode_field();
  CHECK(evaluate(field, {1, 7}) == evaluate(field, {1, 2}));
  CHECK(evaluate(field, {-3, 2}) == evaluate(field, {0, 2}));
}

TEST_CASE("a choice has no in-between and no beyond", "[reduced][errors]") {
  std::vector<ParameterAxis> axes = two_mode_field().axes();
  axes[1].between = Between::kNothing;
  const SeparatedField field(two_mode_field().modes(), axes);
  for (double site : {0.0, 1.0, 2.0}) {
    CHECK(evaluate(field, {1, site}) == evaluate(two_mode_field(), {1, site}));
  }
  for (double nowhere : {-1.0, 0.5, 3.0, std::nan("")}) {
    CHECK_THROWS_AS(evaluate(field, {1, nowhere}), ContractViolation);
  }
}

TEST_CASE("a part of the field is that part of the whole field", "[reduced]") {
  const SeparatedField field = two_mode_field();
  const std::array<double, 2> mu{0.3, 1.4};
  std::array<float, 2> part{};
  field.evaluate_part(mu, 1, part);
  CHECK(part[0] == evaluate(field, {0.3, 1.4})[1]);
  CHECK(part[1] == evaluate(field, {0.3, 1.4})[2]);
  CHECK_THROWS_AS(field.evaluate_part(mu, 2, part), ContractViolation);
}

TEST_CASE("modes times weights are the field", "[reduced]") {
  const SeparatedField field = two_mode_field();
  VectorXf w(2);
  field.weights(std::array{0.3, 1.4}, std::span<float>(w.data(), 2));
  CHECK((field.modes() * w - evaluate(field, {0.3, 1.4})).norm() <=
        tolerance(1e-6, "single precision of numbers up to 8"));
}

TEST_CASE("cutting the modes removes exactly their part of the sum", "[reduced]") {
  const VectorXf u = evaluate(two_mode_field().truncated(1), {1.0, 2.0});
  for (int k = 0; k < 3; ++k) CHECK(u[k] == float(k) * 4.0f);
}

TEST_CASE("evaluating allocates nothing", "[reduced][frame loop]") {
  const SeparatedField field = two_mode_field();
  const std::array<double, 2> mu{0.3, 1.4};
  std::array<float, 3> u{};
  CHECK(test::allocations_during([&] { field.evaluate(mu, u); }) == 0);
  CHECK(test::allocations_during([&] { (void)field.truncated(1); }) > 0);  // the counter counts
}

TEST_CASE("a model whose tables do not fit together is refused", "[reduced][errors]") {
  const SeparatedField good = two_mode_field();
  std::vector<ParameterAxis> axes = good.axes();

  SECTION("one function too few") { axes[0].functions = axes[0].functions.leftCols(1).eval(); }
  SECTION("one sample too many") { axes[1].samples = VectorXd::LinSpaced(4, 0, 3); }
  SECTION("samples that repeat") { axes[1].samples << 0, 1, 1; }
  SECTION("a sample that is not a number") { axes[1].samples[1] = std::nan(""); }
  SECTION("no parameter at all") { axes.clear(); }

  CHECK_THROWS_AS(SeparatedField(good.modes(), axes), ContractViolation);
}

TEST_CASE("a parameter point of the wrong length or no number is refused", "[reduced][errors]") {
  CHECK_THROWS_AS(evaluate(two_mode_field(), {1.0}), ContractViolation);
  CHECK_THROWS_AS(evaluate(two_mode_field(), {std::nan(""), 1.0}), ContractViolation);
}

}  // namespace
}  // namespace palpable
