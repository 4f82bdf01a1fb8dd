#include "palpable/bake/pipeline/export_store.h"

#include "palpable/bake/campaign/store_rows.h"
#include "palpable/bake/exchange/vtu_file.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/npy_file.h"
#include "palpable/common/base/output_file.h"

#include <fmt/format.h>

#include <functional>
#include <span>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

std::size_t size_of(Eigen::Index count) { return static_cast<std::size_t>(count); }

// The numbers of the wanted units in the store's order.
std::vector<int> units_of(const SnapshotStore& store, const WantedUnits& wanted) {
  const StoreContent& content = store.content();
  const int S = content.site_count();
  if (wanted.site && *wanted.site >= S) {
    throw Error(fmt::format("--site {}: {} has the sites 0 to {}", *wanted.site,
                            store.folder().string(), S - 1));
  }
  std::optional<int> point;
  if (!wanted.at.empty()) point = point_of(content, wanted.at);
  std::vector<int> units;
  for (int unit = 0; unit < content.unit_count(); ++unit) {
    if (wanted.site && unit % S != *wanted.site) continue;
    if (!point || unit / S == *point) units.push_back(unit);
  }
  return units;
}

// Calls `show` for each wanted unit with its fields (c N x L).
void for_each_unit(const SnapshotStore& store, const std::vector<int>& units,
                   const std::function<void(int unit, const std::vector<Eigen::MatrixXf>&)>& show) {
  const StoreContent& content = store.content();
  for (const int unit : units) {
    if (const std::string why = store.why_not(unit); !why.empty()) {
      throw Error(fmt::format("{}: {}", store.unit_file(unit).string(), why));
    }
    std::vector<Eigen::MatrixXf> fields;
    for (const StoredField& field : content.fields) {
      fields.push_back(
          store.rows(unit, field, 0, Eigen::Index{content.mesh.node_count()} * field.components));
    }
    show(unit, fields);
  }
}

}  // namespace

void export_store_to_vtu(const SnapshotStore& store, const WantedUnits& wanted,
                         const fs::path& folder) {
  const std::vector<int> units = units_of(store, wanted);
  make_folder(folder);
  const StoreContent& content = store.content();
  const Eigen::Index N = content.mesh.node_count();
  for_each_unit(store, units, [&](int unit, const std::vector<Eigen::MatrixXf>& fields) {
    for (int l = 0; l < content.level_count(); ++l) {
      std::vector<VtuField> shown;
      for (std::size_t f = 0; f < fields.size(); ++f) {
        const StoredField& field = content.fields[f];
        shown.push_back(
            {field.name, fields[f].col(l).reshaped(field.components, N).cast<double>()});
      }
      write_vtu_file(folder / fmt::format("unit_{:05}_level_{:03}.vtu", unit, l + 1), content.mesh,
                     shown);
    }
  });
}

void export_store_to_numpy(const SnapshotStore& store, const WantedUnits& wanted,
                           const fs::path& folder) {
  const std::vector<int> units = units_of(store, wanted);
  make_folder(folder);
  const StoreContent& content = store.content();
  const Eigen::Matrix3Xd& nodes = content.mesh.nodes;
  for_each_unit(store, units, [&](int unit, const std::vector<Eigen::MatrixXf>& fields) {
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const StoredField& field = content.fields[f];
      write_npy(folder / fmt::format("unit_{:05}_{}.npy", unit, field.name),
                {size_of(content.level_count()), size_of(nodes.cols()), size_of(field.components)},
                std::span<const float>(fields[f].data(), size_of(fields[f].size())));
    }
  });
  write_npy(folder / "nodes.npy", {size_of(nodes.cols()), 3},
            std::span<const double>(nodes.data(), size_of(nodes.size())));
  write_npy(folder / "levels.npy", {size_of(content.levels.size())},
            std::span<const double>(content.levels.data(), size_of(content.levels.size())));
}

}  // namespace palpable
