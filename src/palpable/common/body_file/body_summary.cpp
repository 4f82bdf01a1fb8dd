#include "palpable/common/body_file/body_summary.h"

#include "palpable/common/body_file/body_facts.h"
#include "palpable/common/geometry/size_text.h"
#include "palpable/common/response/stated_error.h"

#include <fmt/format.h>

namespace palpable {
namespace {

// How the body can be touched.
std::string kind_of(const BodyAndTouch& content) {
  if (content.modal) {
    return "a body that bends far, to be pressed anywhere, also by other bodies";
  }
  if (!content.touch.ok()) return "its tables of touch are damaged, to be pressed at its sites";
  if (content.touch.value()) return "to be pressed anywhere, several touches at a time";
  const std::size_t sites = content.body.sites.size();
  return fmt::format("to be pressed at its {}, one at a time",
                     sites == 1 ? "site" : fmt::format("{} sites", sites));
}

// How far its bake has come; empty when finished.
std::string stage_of(const ReducedBody& body) {
  const std::string_view missing = missing_at(body.provenance.stage);
  return missing.empty() ? "" : fmt::format("; its bake has not ended: {}", missing);
}

std::string error_text(const char* what, double typical, double worst) {
  return fmt::format("{} off by {} ({})", what, percent_text(typical), percent_text(worst));
}

// The errors of touches that were solved in full to check the tables; empty without any.
std::string touch_errors(const BodyAndTouch& content) {
  if (!content.touch.ok() || !content.touch.value()) return {};
  const std::vector<HeldOutTouch>& touches = content.touch.value()->held_out;
  if (touches.empty()) return {};
  const auto of = [&](const char* what, double HeldOutTouch::*difference) {
    const TouchErrors errors = errors_of(touches, difference);
    return error_text(what, errors.median, errors.worst);
  };
  return fmt::format(
      "touches: {}, {}, {} in the median (worst) of {} against full finite "
      "elements; ",
      of("displacement", &HeldOutTouch::displacement), of("force", &HeldOutTouch::force),
      of("stress", &HeldOutTouch::von_mises), touches.size());
}

std::string accuracy_of(const BodyAndTouch& content) {
  const ReductionError& error = content.body.error;
  std::string text = touch_errors(content);
  if (const auto& several = content.body.several; several && several->checked > 0) {
    text += fmt::format("two loads at once: {} in the median (worst) of {} pairs; ",
                        error_text("displacement", several->error_median, several->error_worst),
                        several->checked);
  }
  if (content.body.method.empty() && error.displacement_worst == 0) {
    return text + "error of the reduced model not known";
  }
  return text + fmt::format(
                    "reduced model: {}, {} over all snapshots (in the worst)",
                    error_text("displacement", error.displacement_pooled, error.displacement_worst),
                    error_text("stress", error.stress_pooled, error.stress_worst));
}

}  // namespace

std::string body_summary(const BodyAndTouch& content, double evaluation_ms, std::uintmax_t bytes) {
  const ReducedBody& body = content.body;
  const Eigen::Vector3d size = extent_of(body.surface.vertices);
  return fmt::format(
      "body:     {}, {}; {}; {}{}\n"
      "accuracy: {}\n"
      "speed:    {:.3g} ms to evaluate displacement and stress of the whole skin; {:.1f} MB file\n",
      body.name, kind_of(content), size_text(size), with_larger_pascals(body.material),
      stage_of(body), accuracy_of(content), evaluation_ms, static_cast<double>(bytes) / 1e6);
}

}  // namespace palpable
