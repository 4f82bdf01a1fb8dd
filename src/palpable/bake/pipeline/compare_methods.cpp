#include "palpable/bake/pipeline/compare_methods.h"

#include "palpable/bake/campaign/store_rows.h"
#include "palpable/bake/separate/coordinate_reduction.h"
#include "palpable/bake/separate/method_comparison.h"
#include "palpable/bake/separate/pod.h"
#include "palpable/bake/separate/site_bases.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/body_file/body_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <tuple>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;

std::string compared_method_text(ReductionMethod method, std::size_t parameters) {
  switch (method) {
    case ReductionMethod::kPgd:
      return fmt::format("pgd, {} factors", parameters + 1);
    case ReductionMethod::kPgd2:
      return "pgd2, 2 factors";
    default:
      return std::string(method_name(method));
  }
}

MethodLine line_of(const MethodFigures& figures, Index values, std::string name) {
  MethodLine line{.name = std::move(name), .ranks = figures.ranks, .seconds = figures.seconds};
  for (const MethodStep& step : figures.steps) {
    line.modes.push_back(step.modes);
    line.columns.push_back(step.columns);
    line.bytes.push_back(mode_bytes(values, step.columns, step.parameter_values));
    line.pooled.push_back(step.pooled);
    line.median.push_back(step.median);
    line.worst.push_back(step.worst);
  }
  return line;
}

std::vector<MethodLine> lines_of(const SnapshotStore& store, const StoredField& field, int point,
                                 const std::string& prefix, const CompareSettings& settings,
                                 const Progress& progress) {
  const StoreContent& content = store.content();
  const SnapshotRows rows = snapshot_rows(store, point, field);
  const Eigen::VectorXd weights = value_weights(content.mesh, field);
  const std::vector<std::string> names =
      settings.methods.empty() ? method_names() : settings.methods;
  const auto total = static_cast<double>(names.size()) + 1;
  const std::string doing = fmt::format("comparing {}", field.name);
  report(progress, {doing, 0.0, total, "products of snapshots"});
  // The bases of the sites drop less than the tolerance of the methods (CoordinateReduction).
  const Eigen::MatrixXd gram =
      site_bases(rows, weights, kCoordinatesShare * settings.tolerance).gram;
  std::vector<MethodLine> lines;
  for (const std::string& name : names) {
    report(progress, {doing, static_cast<double>(lines.size()) + 1, total, name});
    const ReductionMethod method = *method_named(name);
    const MethodFigures figures = try_method(gram, rows.sizes,
                                             {.method = method,
                                              .tolerance = settings.tolerance,
                                              .max_modes = settings.max_modes,
                                              .weight_snapshots = false});
    lines.push_back(line_of(figures, field.components * static_cast<Index>(content.fixed.size()),
                            prefix + compared_method_text(method, rows.sizes.size())));
  }
  return lines;
}

}  // namespace

void add_store(const SnapshotStore& store, const std::string& prefix,
               const CompareSettings& settings, MethodPage& page, const Progress& progress) {
  const StoreContent& content = store.content();
  const int point = point_of(content, settings.at);
  for (int s = 0; s < content.site_count(); ++s) {
    const int unit = point * content.site_count() + s;
    const std::string why = store.why_not(unit);
    if (!why.empty()) throw Error(fmt::format("{}: {}", store.unit_file(unit).string(), why));
  }
  for (const auto& [name, lines] :
       {std::pair{"displacement", &page.displacement}, std::pair{"stress", &page.stress}}) {
    const StoredField* field = find_field(content, name);
    if (field == nullptr) continue;
    for (MethodLine& line : lines_of(store, *field, point, prefix, settings, progress)) {
      lines->push_back(std::move(line));
    }
  }
  page.provenance.emplace_back(
      "snapshots", fmt::format("{}: {}, {} sites x {} levels, {} nodes; {}",
                               store.folder().string(), content.name, content.site_count(),
                               content.level_count(), content.mesh.node_count(), content.material));
  const std::vector<double> values = content.values_at(point);
  for (std::size_t k = 0; k < values.size(); ++k) {
    page.provenance.emplace_back("parameter",
                                 fmt::format("{} = {:.6g}", content.parameters[k].name, values[k]));
  }
}

namespace {

// Sizes and errors of the first modes of a body (of each site, where it has blocks).
MethodLine line_of(const SeparatedField& field, const ErrorCourse& course, std::string name) {
  const bool blocks = field.largest_block() < field.mode_count();
  const auto sites = field.axes()[0].samples.size();
  double per_mode = 0;  // numbers in the functions of one mode
  for (const ParameterAxis& axis : field.axes()) {
    per_mode += static_cast<double>(axis.samples.size());
  }
  MethodLine line{.name = std::move(name), .is_body = true};
  for (Index q = 0; q < course.modes.size(); ++q) {
    const int modes = course.modes[q];
    int columns = blocks ? 0 : modes;
    for (Index s = 0; blocks && s < sites; ++s) {
      const auto [first, last] = field.block(0, s);
      columns += std::min(modes, last - first);
    }
    line.modes.push_back(modes);
    line.columns.push_back(columns);
    line.bytes.push_back(mode_bytes(field.value_count(), columns, columns * per_mode));
    line.pooled.push_back(course.pooled[q]);
    Eigen::VectorXf errors = course.snapshots.col(q);
    line.median.push_back(static_cast<double>(
        upper_median(std::span(errors.data(), static_cast<std::size_t>(errors.size())))));
    line.worst.push_back(static_cast<double>(course.snapshots.col(q).maxCoeff()));
  }
  return line;
}

// The size of all modes in the file, at the last number of modes of the course.
MethodLine end_of(const SeparatedField& field, const ErrorCourse& course, std::string name) {
  MethodLine line = line_of(field, course, std::move(name));
  const auto last = static_cast<std::ptrdiff_t>(line.modes.size()) - 1;
  line.modes = {line.modes.back()};
  line.columns = {field.mode_count()};
  double functions = 0;
  for (const ParameterAxis& axis : field.axes()) {
    functions += static_cast<double>(axis.functions.size());
  }
  line.bytes = {mode_bytes(field.value_count(), field.mode_count(), functions)};
  for (std::vector<double>* errors : {&line.pooled, &line.median, &line.worst}) {
    *errors = {(*errors)[last]};
  }
  return line;
}

}  // namespace

void add_body(const std::filesystem::path& path, MethodPage& page) {
  const ReducedBody body = value_or_throw(read_body_file(path));
  if (!body.error.displacement_course) {
    throw Error(
        fmt::format("{}: does not say how its errors fall with the number of modes; make it again "
                    "with 'palpable reduce'",
                    path.string()));
  }
  if (const std::string& typed = body.provenance.command_line; !typed.empty()) {
    page.provenance.emplace_back(path.filename().string(), typed);
  }
  const std::string name =
      fmt::format("{} ({})", path.filename().string(),
                  body.method.empty() ? "modes of another program" : body.method);
  for (const auto& [field, course, lines] :
       {std::tuple{&body.displacement, &body.error.displacement_course, &page.displacement},
        std::tuple{&body.stress, &body.error.stress_course, &page.stress}}) {
    if (!*course) continue;
    // Modes that were found for all sites together and stored in blocks have another count in the
    // file, so only the last point of their course is comparable.
    const bool as_found = (*course)->modes.tail(1)[0] == field->largest_block();
    lines->push_back(as_found ? line_of(*field, **course, name) : end_of(*field, **course, name));
  }
}

}  // namespace palpable
