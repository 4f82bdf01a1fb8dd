#include "palpable/common/reduced/separated_field.h"

#include "palpable/common/base/contract.h"
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

TEST_CASE("at a sample the field is the sum of products of its factors", "[reduced][Eq4]") {
  const VectorXf u = evaluate(two_mode_field(), {1.0, 2.0});
  for (int k = 0; k < 3; ++k) CHECK(u[k] == float(k) * 4.0f + 2.0f);  // exact: small integers
}

TEST_CASE("a parameter beyond its axis is clamped to the end of the axis", "[reduced]") {
  const SeparatedField field = two_mode_field();
  CHECK(evaluate(field, {1, 7}) == evaluate(field, {1, 2}));
  CHECK(evaluate(field, {-3, 2}) == evaluate(field, {0, 2}));
}

TEST_CASE("a choice that is not a sample is refused", "[reduced][errors]") {
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
  field.evaluate(mu, u);  // the kernels are chosen once
  CHECK(test::allocations_during([&] {
          field.evaluate(mu, u);
          field.derivative(mu, 1, u);
          field.derivative_part(mu, 1, 1, std::span(u).first(1));
        }) == 0);
  CHECK(test::allocations_during([&] { (void)field.truncated(1); }) > 0);  // the counter counts
}

// Three choices with 2, 1 and 3 modes over an uneven level axis and a temperature.
std::vector<SeparatedField> three_blocks() {
  VectorXd level(5);
  level << 0, 0.2, 0.5, 0.6, 1;
  std::vector<SeparatedField> blocks;
  for (const Eigen::Index m : {2, 1, 3}) {
    auto random = test::random_case(static_cast<unsigned>(m));
    const auto number = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
    const MatrixXf F = MatrixXd::NullaryExpr(37, m, number).cast<float>();
    blocks.push_back({F,
                      {{"level", level, MatrixXd::NullaryExpr(5, m, number), Between::kSmooth},
                       {"heat", VectorXd::LinSpaced(4, 1, 7), MatrixXd::NullaryExpr(4, m, number),
                        Between::kSmooth}}});
  }
  return blocks;
}

TEST_CASE("a field with one block per choice equals that block at each choice", "[reduced]") {
  const std::vector<SeparatedField> blocks = three_blocks();
  const SeparatedField field = one_block_per_choice("site", blocks);
  CHECK(field.mode_count() == 6);
  CHECK(field.largest_block() == 3);
  CHECK(field.block(0, 1) == std::pair{2, 3});
  CHECK(field.block(1, 1) == std::pair{0, 6});  // a quantity has no blocks
  for (std::size_t c = 0; c < 3; ++c) {
    for (const double level : {0.0, 0.11, 0.6, 0.97}) {
      CHECK(evaluate(field, {double(c), level, 3.3}) == evaluate(blocks[c], {level, 3.3}));
    }
  }
}

TEST_CASE("only the modes of a choice are read", "[reduced]") {
  SeparatedField field = one_block_per_choice("site", three_blocks());
  MatrixXf F = field.modes();
  F.col(2).setConstant(NAN);  // 0 * NaN would give NaN
  const SeparatedField spoiled(F, field.axes());
  CHECK(evaluate(spoiled, {0, 0.3, 2}) == evaluate(field, {0, 0.3, 2}));
  CHECK(evaluate(spoiled, {2, 0.3, 2}) == evaluate(field, {2, 0.3, 2}));
  CHECK(std::isnan(evaluate(spoiled, {1, 0.3, 2})[0]));
}

TEST_CASE("functions of a choice that are zero altogether give zero", "[reduced]") {
  std::vector<ParameterAxis> axes = one_block_per_choice("site", three_blocks()).axes();
  axes[0].functions.row(1).setZero();
  const SeparatedField field(MatrixXf::Ones(4, 6), axes);
  CHECK(evaluate(field, {1, 0.3, 2}) == VectorXf::Zero(4));
}

TEST_CASE("blocks that do not fit together are refused", "[reduced][errors]") {
  std::vector<SeparatedField> blocks = three_blocks();
  SECTION("none") { blocks.clear(); }
  SECTION("another length") { blocks[1] = SeparatedField(MatrixXf::Ones(3, 1), blocks[1].axes()); }
  SECTION("another sample") {
    std::vector<ParameterAxis> axes = blocks[1].axes();
    axes[0].samples[1] = 0.3;
    blocks[1] = SeparatedField(blocks[1].modes(), axes);
  }
  SECTION("another axis") {
    std::vector<ParameterAxis> axes = blocks[1].axes();
    axes[1].name = "cold";
    blocks[1] = SeparatedField(blocks[1].modes(), axes);
  }
  SECTION("an axis less") { blocks[1] = blocks[1].settled(1, 3.0); }
  CHECK_THROWS_AS(one_block_per_choice("site", blocks), ContractViolation);
}

TEST_CASE("a field of more modes than are weighed at once is their sum", "[reduced]") {
  constexpr int m = 600;
  const VectorXd t = VectorXd::LinSpaced(3, 0, 1);
  const SeparatedField field(MatrixXf::Ones(5, m), {{"t", t, t.replicate(1, m), Between::kSmooth}});
  CHECK(evaluate(field, {0.5}) == VectorXf::Constant(5, 300));  // exact: halves
  VectorXf w(m);
  field.weights(std::array{0.5}, std::span<float>(w.data(), m));
  CHECK(w == VectorXf::Constant(m, 0.5f));
}

TEST_CASE("the derivative by a parameter is the limit of differences", "[reduced]") {
  const SeparatedField field = one_block_per_choice("site", three_blocks());
  VectorXf du(37), middle(5);
  for (const int j : {1, 2}) {
    for (const double level : {0.05, 0.2, 0.55, 0.93}) {
      const std::vector<double> mu{2, level, 2.7};
      field.derivative(mu, j, std::span<float>(du.data(), 37));
      std::vector<double> more = mu, less = mu;
      const double h = 1e-2;
      more[std::size_t(j)] += h;
      less[std::size_t(j)] -= h;
      const VectorXf slope = (evaluate(field, more) - evaluate(field, less)) / float(2 * h);
      // A wrong sign or factor would give a far larger difference: slopes are 1 to 30.
      CHECK((du - slope).norm() <=
            tolerance(0.03, "h^2/6 of third derivatives, of jumps of them") * (1 + slope.norm()));
      field.derivative_part(mu, j, 4, std::span<float>(middle.data(), 5));
      CHECK(middle == du.segment(4, 5));
    }
  }
}

TEST_CASE("the derivative is one-sided at an end of the axis and zero beyond", "[reduced]") {
  const VectorXd t = VectorXd::LinSpaced(4, 0, 3);
  const SeparatedField field(MatrixXf::Ones(1, 1), {{"t", t, t.cwiseAbs2(), Between::kSmooth}});
  const auto slope = [&](double at) {
    float value = NAN;
    field.derivative(std::array{at}, 0, std::span(&value, 1));
    return value;
  };
  CHECK(std::abs(slope(0)) <= tolerance(1e-12, "rounding"));
  CHECK(slope(3) == Approx(6));
  CHECK(slope(1) == Approx(2));
  CHECK(slope(-0.1) == 0);
  CHECK(slope(3.1) == 0);
}

TEST_CASE("there is no derivative by a choice", "[reduced][errors]") {
  const SeparatedField field = one_block_per_choice("site", three_blocks());
  std::array<float, 37> du{};
  CHECK_THROWS_AS(field.derivative(std::array{1.0, 0.5, 2.0}, 0, du), ContractViolation);
  CHECK_THROWS_AS(field.derivative(std::array{1.0, 0.5, 2.0}, 3, du), ContractViolation);
}

TEST_CASE("a field with a settled parameter is the field there, with one axis less", "[reduced]") {
  const SeparatedField field = one_block_per_choice("site", three_blocks());
  for (const double heat : {1.0, 2.2, 7.0, 9.0}) {
    const SeparatedField warm = field.settled(2, heat);
    CHECK(warm.axes().size() == 2);
    CHECK(warm.largest_block() == 3);
    CHECK((evaluate(warm, {2, 0.35}) - evaluate(field, {2, 0.35, heat})).norm() <=
          tolerance(1e-6, "weights are rounded to single precision") *
              evaluate(field, {2, 0.35, heat}).norm());
  }
  const SeparatedField one = field.settled(0, 1);
  CHECK((evaluate(one, {0.35, 2}) - evaluate(field, {1, 0.35, 2})).norm() <=
        tolerance(1e-6, "likewise"));
  CHECK_THROWS_AS(one.settled(0, 0.5).settled(0, 2), ContractViolation);
}

TEST_CASE("a model whose tables do not fit together is refused", "[reduced][errors]") {
  const SeparatedField good = two_mode_field();
  std::vector<ParameterAxis> axes = good.axes();

  SECTION("one function too few") { axes[0].functions = axes[0].functions.leftCols(1).eval(); }
  SECTION("one sample too many") { axes[1].samples = VectorXd::LinSpaced(4, 0, 3); }
  SECTION("samples that repeat") { axes[1].samples << 0, 1, 1; }
  SECTION("a sample that is not a number") { axes[1].samples[1] = std::nan(""); }
  SECTION("no parameter at all") { axes.clear(); }
  SECTION("too many parameters") { axes.resize(9, axes[0]); }

  CHECK_THROWS_AS(SeparatedField(good.modes(), axes), ContractViolation);
}

TEST_CASE("a parameter point of the wrong length or no number is refused", "[reduced][errors]") {
  CHECK_THROWS_AS(evaluate(two_mode_field(), {1.0}), ContractViolation);
  CHECK_THROWS_AS(evaluate(two_mode_field(), {std::nan(""), 1.0}), ContractViolation);
}

}  // namespace
}  // namespace palpable
