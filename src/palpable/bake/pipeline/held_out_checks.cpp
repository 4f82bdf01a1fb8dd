#include "palpable/bake/pipeline/held_out_checks.h"

#include "palpable/bake/campaign/crew.h"
#include "palpable/bake/campaign/held_out.h"
#include "palpable/common/base/text_numbers.h"

#include <fmt/format.h>

#include <string>
#include <vector>

namespace palpable {
namespace {

std::string held_out_errors_text(const HeldOutErrors& errors) {
  return fmt::format(
      "displacement {:.3g} pooled, {:.3g} at the median snapshot, {:.3g} at the worst, in their "
      "own "
      "norms; von Mises stress, worst vertex against the field's largest, {:.3g} at the median, "
      "{:.3g} at the worst",
      errors.displacement_pooled, errors.displacement_median(), errors.displacement.maxCoeff(),
      errors.von_mises_median(), errors.von_mises.maxCoeff());
}

// The description with parameter k at the values half way between its samples, the others at their
// usual values.
BodyDescription between_samples(BodyDescription description, const ReducedBody& body,
                                std::size_t k) {
  for (std::size_t j = 0; j < description.parameters.size(); ++j) {
    description.parameters[j].values = {body.further[j].value};
  }
  const Eigen::VectorXd& samples = body.further[k].samples;
  std::vector<double>& values = description.parameters[k].values;
  values.clear();
  for (Eigen::Index i = 0; i + 1 < samples.size(); ++i) {
    values.push_back(0.5 * (samples[i] + samples[i + 1]));
  }
  return description;
}

}  // namespace

void check_between_levels(const BodyDescription& description, FillSettings settings,
                          const SnapshotStore& campaign, int point, BakedBody& baked,
                          const Progress& progress) {
  settings.held_out_of = &campaign;
  settings.store = campaign.folder();
  settings.store.replace_extension(".held-out");
  LocalCrew crew;
  const FilledStore between = fill_store(description, settings, crew, progress);
  const HeldOutErrors errors =
      held_out_errors(value_or_throw(settled(baked.body)), between.store, point);
  baked.report.held_out = fmt::format("against {} levels between, solved afresh, on the skin: {}",
                                      errors.displacement.size(), held_out_errors_text(errors));
  baked.body.provenance.held_out = baked.report.held_out;
  baked.body.error.held_out = errors.record();
}

void check_between_values(const BodyDescription& description, FillSettings settings,
                          const SnapshotStore& campaign, BakedBody& baked,
                          const Progress& progress) {
  for (std::size_t k = 0; k < baked.body.further.size(); ++k) {
    const std::string& name = baked.body.further[k].name;
    const BodyDescription between = between_samples(description, baked.body, k);
    settings.store = campaign.folder();
    settings.store.replace_extension(".between-" + name);
    LocalCrew crew;
    const FilledStore solved = fill_store(between, settings, crew, progress);
    const std::vector<double>& values = between.parameters[k].values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const ReducedBody there = value_or_throw(settled(baked.body, {{name, values[i]}}));
      const HeldOutErrors errors =
          held_out_errors(there, solved.store, static_cast<int>(i), HeldOutAt::kDepth);
      const std::string line = fmt::format(
          "against {} presses at {} = {}, solved afresh, at equal depth, on the skin: {}",
          errors.displacement.size(), name, number_text(values[i]), held_out_errors_text(errors));
      baked.body.provenance.held_out_values.push_back({name, values[i], line});
      baked.report.held_out += "\n" + line;
    }
  }
}

}  // namespace palpable
