#include "palpable/bake/separate/method_comparison.h"

#include "palpable/bake/separate/pod.h"
#include "tests/support/tensors.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

using Eigen::Index;
using test::dents;
using test::random_case;
using test::random_weights;
using test::tolerance;

TEST_CASE("the figures of a method from the Gram matrix alone are those of its reduction",
          "[separate][reduction]") {
  const SnapshotTensor snapshots = dents(60, 9, 6);
  auto random = random_case(1);
  const Eigen::VectorXd w = random_weights(60, random);
  const Eigen::MatrixXd gram = gram_of(rows_of(snapshots), w);
  for (const std::string& name : method_names()) {
    for (const bool own : {false, true}) {
      INFO(name << " own " << own);
      const ReductionSettings settings{
          .method = *method_named(name), .tolerance = 1e-3, .weight_snapshots = own};
      const Reduction done = reduce(rows_of(snapshots), w, settings);
      const MethodFigures predicted = try_method(gram, snapshots.sizes, settings);
      CHECK(predicted.modes == done.most_modes());
      CHECK(predicted.columns == done.total_modes());
      CHECK(predicted.ranks == done.ranks);
      CHECK(predicted.reached);
      CHECK(std::abs(predicted.pooled - done.error) <=
            tolerance(1e-7, "what the Gram matrix drops"));
      CHECK(std::abs(predicted.worst - done.snapshot_errors.maxCoeff()) <=
            tolerance(1e-6, "what the Gram matrix drops, of the smallest snapshot"));
      CHECK(predicted.median <= predicted.worst);
      CHECK(predicted.bytes(180) == 4.0 * (180.0 * predicted.columns + predicted.parameter_values));
      CHECK(predicted.parameter_values > 0.0);
      REQUIRE(static_cast<int>(predicted.steps.size()) == predicted.modes);
      for (Index i = 0; i < done.pooled_course.size(); ++i) {
        const MethodStep& step = predicted.steps[i];
        CHECK(step.modes == i + 1);
        CHECK(std::abs(step.pooled - done.pooled_course[i]) <=
              tolerance(1e-7, "what the Gram matrix drops"));
        CHECK(std::abs(step.worst - done.course.row(i).maxCoeff()) <=
              tolerance(1e-6, "what the Gram matrix drops, of the smallest snapshot"));
      }
      CHECK(predicted.steps.back().columns == predicted.columns);
      CHECK(predicted.steps.back().parameter_values == predicted.parameter_values);
    }
  }
}

}  // namespace
}  // namespace palpable
