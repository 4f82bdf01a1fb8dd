// palpable export bunny.palpable --to pxdmf -o bunny.pxdmf

#include "apps/common/command_line.h"
#include "apps/palpable-bake/body_report.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/base/error.h"
#include "palpable/campaign/snapshot_store.h"
#include "palpable/exchange/modes_files.h"
#include "palpable/exchange/npy_file.h"
#include "palpable/exchange/press_series.h"
#include "palpable/exchange/vtu_file.h"
#include "palpable/reduced/body_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string input, to, output;
  int site = -1;  // all
  std::vector<std::string> set;
};

void export_body(const Options& options) {
  if (options.to == "numpy" || options.to == "pxdmf") {  // all parameters, nothing settled
    const ForeignModes modes = modes_of_body(value_or_throw(read_body_file(options.input)));
    options.to == "numpy" ? write_numpy_modes(options.output, modes)
                          : write_pxdmf(options.output, modes);
    return;
  }
  const ReducedBody body =
      value_or_throw(read_pressable_body(options.input, parse_settings(options.set)));
  const std::optional<int> site = options.site < 0 ? std::nullopt : std::optional(options.site);
  options.to == "vtu" ? write_vtu_series(options.output, body, site)
                      : write_xdmf_series(options.output, body, site);
}

void export_store(const Options& options) {
  const SnapshotStore store = SnapshotStore::open(options.input);
  if (options.to == "pxdmf") {
    throw Error(
        fmt::format("{}: snapshots have no modes; make a body of them first (palpable "
                    "reduce)",
                    options.input));
  }
  if (options.to == "xdmf") {
    throw Error(fmt::format("{}: is XDMF already; open {} in ParaView", options.input,
                            (store.folder() / "campaign.xdmf").string()));
  }
  const StoreContent& content = store.content();
  fs::create_directories(options.output);
  const Eigen::Index N = content.mesh.node_count();
  const int L = content.level_count();
  int written = 0;
  for (int unit = 0; unit < content.unit_count(); ++unit) {
    if (options.site >= 0 && unit % content.site_count() != options.site) continue;
    if (const std::string why = store.why_not(unit); !why.empty()) {
      throw Error(fmt::format("{}: {}", store.unit_file(unit).string(), why));
    }
    std::vector<Eigen::MatrixXf> fields;
    for (const StoredField& field : content.fields) {
      fields.push_back(store.rows(unit, field, 0, N * field.components));
    }
    for (int l = 0; l < L && options.to == "vtu"; ++l) {
      std::vector<VtuField> shown;
      for (std::size_t f = 0; f < fields.size(); ++f) {
        shown.push_back(
            {content.fields[f].name,
             fields[f].col(l).reshaped(content.fields[f].components, N).cast<double>()});
      }
      write_vtu_file(
          fs::path(options.output) / fmt::format("unit_{:05}_level_{:03}.vtu", unit, l + 1),
          content.mesh, shown);
    }
    for (std::size_t f = 0; f < fields.size() && options.to == "numpy"; ++f) {
      write_npy(
          fs::path(options.output) / fmt::format("unit_{:05}_{}.npy", unit, content.fields[f].name),
          {static_cast<std::size_t>(L), static_cast<std::size_t>(N),
           static_cast<std::size_t>(content.fields[f].components)},
          std::span<const float>(fields[f].data(), static_cast<std::size_t>(fields[f].size())));
    }
    ++written;
  }
  if (written == 0) throw Error(fmt::format("--site {}: there is no such site", options.site));
  if (options.to == "numpy") {
    write_npy(fs::path(options.output) / "nodes.npy", {static_cast<std::size_t>(N), 3},
              std::span<const double>(content.mesh.nodes.data(),
                                      static_cast<std::size_t>(content.mesh.nodes.size())));
    write_npy(fs::path(options.output) / "levels.npy",
              {static_cast<std::size_t>(content.levels.size())},
              std::span<const double>(content.levels.data(),
                                      static_cast<std::size_t>(content.levels.size())));
  }
}

void run(const Options& options) {
  require_folder_of(options.output);
  fs::is_directory(options.input) ? export_store(options) : export_body(options);
  fmt::print("{}\n", options.output);
}

}  // namespace

void add_export(Command app) {
  const auto options = std::make_shared<Options>();
  Command command =
      app.add_subcommand("export", "Write a body or its snapshots for other programs");
  command.add_option("input", options->input, "A body file, or a folder of snapshots")
      .required()
      .type_name("BODY|STORE");
  command
      .add_option(
          "--to", options->to,
          "vtu: a folder, one file per site and level; xdmf: one file of the same; numpy: a "
          "folder of arrays, the modes (of a store: the snapshots); pxdmf: the modes as "
          "other PGD programs read them")
      .required()
      .one_of({"vtu", "xdmf", "numpy", "pxdmf"});
  command.add_option("-o,--out", options->output, "File or folder to write").required();
  command.add_option("--site", options->site, "vtu, xdmf: this site only").not_negative();
  add_set_option(command, options->set);
  command.footer(
      "docs/exchange.md says what is where.\n"
      "Example: palpable export bunny.palpable --to vtu --site 4 -o bunny_site_4");
  command.callback([options] { run(*options); });
}

}  // namespace palpable::app
