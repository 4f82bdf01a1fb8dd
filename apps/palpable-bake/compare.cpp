// palpable compare bunny.snapshots bunny.palpable: methods and bodies on one chart.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable-bake/body_report.h"
#include "apps/palpable-bake/commands.h"
#include "apps/palpable-bake/machine.h"
#include "apps/palpable-bake/text_file.h"
#include "palpable/bake/bake_body.h"
#include "palpable/base/error.h"
#include "palpable/campaign/store_rows.h"
#include "palpable/exchange/method_page.h"
#include "palpable/reduced/body_file.h"
#include "palpable/separate/coordinate_reduction.h"
#include "palpable/separate/method_comparison.h"
#include "palpable/separate/pod_coordinates.h"
#include "palpable/separate/site_bases.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;
using Eigen::Index;

struct Options {
  std::vector<std::string> inputs;
  std::string output = "compare.html";
  std::vector<std::string> methods, at;
  double tolerance = 1e-3;
  int max_modes = 1000;
};

double median(Eigen::VectorXf values) {
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

std::string method_text(ReductionMethod method, std::size_t parameters) {
  switch (method) {
    case ReductionMethod::kPgd:
      return fmt::format("pgd, {} factors", parameters + 1);
    case ReductionMethod::kPgd2:
      return "pgd2, 2 factors";
    default:
      return std::string(method_name(method));
  }
}

// ---- methods on snapshots ----------------------------------------------------------------------

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

std::vector<MethodLine> lines_of(const SnapshotStore& store, const StoredField& field,
                                 const std::string& prefix, const Options& options,
                                 ProgressBar& bar) {
  const StoreContent& content = store.content();
  const SnapshotRows rows =
      snapshot_rows(store, point_of(content, parse_values(options.at)), field);
  const Eigen::VectorXd weights = value_weights(content.mesh, field);
  const Progress progress = bar.progress();
  const std::vector<std::string> names = options.methods.empty() ? method_names() : options.methods;
  const auto total = static_cast<double>(names.size()) + 1;
  const std::string doing = fmt::format("comparing {}", field.name);
  report(progress, {doing, 0.0, total, "products of snapshots"});
  // What the bases of sites leave out is below what every method may (CoordinateReduction).
  const Eigen::MatrixXd gram =
      site_bases(rows, weights, kCoordinatesShare * options.tolerance).gram;
  std::vector<MethodLine> lines;
  for (const std::string& name : names) {
    report(progress, {doing, static_cast<double>(lines.size()) + 1, total, name});
    const ReductionMethod method = *method_named(name);
    const MethodFigures figures = try_method(gram, rows.sizes,
                                             {.method = method,
                                              .tolerance = options.tolerance,
                                              .max_modes = options.max_modes,
                                              .weight_snapshots = false});
    lines.push_back(line_of(figures, field.components * static_cast<Index>(content.fixed.size()),
                            prefix + method_text(method, rows.sizes.size())));
  }
  return lines;
}

void add_store(const SnapshotStore& store, const std::string& prefix, const Options& options,
               MethodPage& page) {
  const StoreContent& content = store.content();
  const int point = point_of(content, parse_values(options.at));
  for (int s = 0; s < content.site_count(); ++s) {
    const int unit = point * content.site_count() + s;
    const std::string why = store.why_not(unit);
    if (!why.empty()) throw Error(fmt::format("{}: {}", store.unit_file(unit).string(), why));
  }
  ProgressBar bar;
  for (const auto& [name, lines] :
       {std::pair{"displacement", &page.displacement}, std::pair{"stress", &page.stress}}) {
    const StoredField* field = find_field(content, name);
    if (field == nullptr) continue;
    for (MethodLine& line : lines_of(store, *field, prefix, options, bar)) {
      lines->push_back(std::move(line));
    }
  }
  bar.finish();
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

// ---- body files --------------------------------------------------------------------------------

// What the first modes of a body take, of each site where it has blocks.
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
    line.median.push_back(median(course.snapshots.col(q)));
    line.worst.push_back(static_cast<double>(course.snapshots.col(q).maxCoeff()));
  }
  return line;
}

// What the file holds, at the number of modes that the course ends with.
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
    *errors = {(*errors)[static_cast<std::size_t>(last)]};
  }
  return line;
}

void add_body(const fs::path& path, MethodPage& page) {
  const ReducedBody body = value_or_throw(read_body_file(path));
  if (!body.error.displacement_course) {
    throw Error(
        fmt::format("{}: does not say how its errors fall with the number of modes; make it again "
                    "with 'palpable reduce'",
                    path.string()));
  }
  std::string method = "modes of another program";
  for (const auto& [key, value] : body.provenance) {
    if (key == "reduction") method = value.substr(0, value.find(' '));
    if (key == "command line") { page.provenance.emplace_back(path.filename().string(), value); }
  }
  const std::string name = fmt::format("{} ({})", path.filename().string(), method);
  for (const auto& [field, course, lines] :
       {std::tuple{&body.displacement, &body.error.displacement_course, &page.displacement},
        std::tuple{&body.stress, &body.error.stress_course, &page.stress}}) {
    if (!*course) continue;
    // Modes that were found for all sites together and stored in blocks have another count there:
    // of those only the end is known.
    const bool as_found = (*course)->modes.tail(1)[0] == field->largest_block();
    lines->push_back(as_found ? line_of(*field, **course, name) : end_of(*field, **course, name));
  }
}

void compare(const Options& options, const std::string& command_line) {
  require_folder_of(options.output);
  const fs::path table = table_beside(options.output);
  std::vector<SnapshotStore> stores;
  std::vector<fs::path> bodies;
  for (const std::string& input : options.inputs) {
    if (fs::is_directory(input)) {
      stores.push_back(SnapshotStore::open(input));
    } else {
      bodies.emplace_back(input);
    }
  }
  MethodPage page;
  for (const fs::path& body : bodies) add_body(body, page);
  for (const SnapshotStore& store : stores) {
    const std::string prefix =
        stores.size() > 1 ? store.folder().filename().string() + ": " : std::string();
    add_store(store, prefix, options, page);
  }
  page.title = "Methods of reduction, side by side";
  page.lead = fmt::format(
      "How much of the solved states is lost with so many modes or bytes{}.",
      stores.empty() ? std::string()
                     : fmt::format("; each method goes on until {:.3g} of all snapshots together "
                                   "(per-site: of each site's) is left",
                                   options.tolerance));
  page.provenance.emplace_back("program", std::string("palpable ") + PALPABLE_VERSION);
  page.provenance.emplace_back("command line", command_line);
  page.provenance.emplace_back("computed on",
                               fmt::format("{}, {}", processor_name(), date_today()));
  page.footer = fmt::format("Written by palpable {} on {}; the same numbers are in {}.",
                            PALPABLE_VERSION, date_today(), table.filename().string());
  write_text_file(options.output, method_page(page));
  write_text_file(table, method_table(page));
  for (const auto& [name, lines] :
       {std::pair{"displacement", &page.displacement}, std::pair{"stress", &page.stress}}) {
    if (lines->empty()) continue;
    fmt::print("{}\n  {:<34} {:>6} {:>7} {:>10} {:>12} {:>9} {:>9}\n", name, "", "modes", "in all",
               "MB", "all together", "median", "worst");
    for (const MethodLine& line : *lines) {
      fmt::print("  {:<34} {:>6} {:>7} {:>10.2f} {:>12.2g} {:>9.2g} {:>9.2g}\n", line.name,
                 line.modes.back(), line.columns.back(), line.bytes.back() / 1e6,
                 line.pooled.back(), line.median.back(), line.worst.back());
    }
  }
  fmt::print("{}: opens in any browser, loads nothing; the same numbers: {}\n", options.output,
             table.string());
}

}  // namespace

void add_compare(Command app, const std::string& command_line) {
  const auto options = std::make_shared<Options>();
  Command command = app.add_subcommand(
      "compare", "All methods of reduction, and body files, on one chart of errors: an HTML page");
  command
      .add_option("inputs", options->inputs,
                  "Folders of snapshots: every method is tried on them; body files: as they are")
      .required()
      .type_name("STORE|BODY ...");
  command
      .add_option("-o,--out", options->output,
                  "Page to write, NAME.html; the numbers go to NAME.csv")
      .type_name("FILE")
      .show_default();
  command
      .add_option("--method", options->methods,
                  "Only these, else all: " + fmt::format("{}", fmt::join(method_names(), " ")))
      .one_of(method_names())
      .type_name("METHOD");
  command
      .add_option("-e,--error", options->tolerance,
                  "Relative error at which each method stops, all snapshots together (per-site: "
                  "those of each site)")
      .in_range(1e-6, 0.999)
      .show_default();
  command.add_option("-n,--modes", options->max_modes, "Or at this many modes")
      .in_range(1, 100000)
      .show_default();
  command
      .add_option("--at", options->at,
                  "Of a further parameter, the value whose snapshots are compared; else the "
                  "middle one")
      .type_name("NAME=VALUE");
  command.footer("Example: palpable compare bunny.snapshots bunny.palpable -o compare.html");
  command.callback([options, command_line] { compare(*options, command_line); });
}

}  // namespace palpable::app
