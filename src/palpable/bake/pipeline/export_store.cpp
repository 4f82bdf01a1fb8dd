#include "palpable/bake/pipeline/export_store.h"

#include "palpable/bake/exchange/vtu_file.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/npy_file.h"

#include <fmt/format.h>

#include <functional>
#include <span>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

std::size_t size_of(Eigen::Index count) { return static_cast<std::size_t>(count); }

// Calls `show` for each unit of the site, or of all sites, with its fields (c N x L), in the
// store's order. @returns the number of units
int for_each_unit(const SnapshotStore& store, std::optional<int> site,
                  const std::function<void(int unit, const std::vector<Eigen::MatrixXf>&)>& show) {
  const StoreContent& content = store.content();
  int shown = 0;
  for (int unit = 0; unit < content.unit_count(); ++unit) {
    if (site && unit % content.site_count() != *site) continue;
    if (const std::string why = store.why_not(unit); !why.empty()) {
      throw Error(fmt::format("{}: {}", store.unit_file(unit).string(), why));
    }
    std::vector<Eigen::MatrixXf> fields;
    for (const StoredField& field : content.fields) {
      fields.push_back(
          store.rows(unit, field, 0, Eigen::Index{content.mesh.node_count()} * field.components));
    }
    show(unit, fields);
    ++shown;
  }
  return shown;
}

}  // namespace

int export_store_to_vtu(const SnapshotStore& store, std::optional<int> site,
                        const fs::path& folder) {
  fs::create_directories(folder);
  const StoreContent& content = store.content();
  const Eigen::Index N = content.mesh.node_count();
  return for_each_unit(store, site, [&](int unit, const std::vector<Eigen::MatrixXf>& fields) {
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

int export_store_to_numpy(const SnapshotStore& store, std::optional<int> site,
                          const fs::path& folder) {
  fs::create_directories(folder);
  const StoreContent& content = store.content();
  const Eigen::Matrix3Xd& nodes = content.mesh.nodes;
  const int written =
      for_each_unit(store, site, [&](int unit, const std::vector<Eigen::MatrixXf>& fields) {
        for (std::size_t f = 0; f < fields.size(); ++f) {
          const StoredField& field = content.fields[f];
          write_npy(
              folder / fmt::format("unit_{:05}_{}.npy", unit, field.name),
              {size_of(content.level_count()), size_of(nodes.cols()), size_of(field.components)},
              std::span<const float>(fields[f].data(), size_of(fields[f].size())));
        }
      });
  if (written == 0) return 0;
  write_npy(folder / "nodes.npy", {size_of(nodes.cols()), 3},
            std::span<const double>(nodes.data(), size_of(nodes.size())));
  write_npy(folder / "levels.npy", {size_of(content.levels.size())},
            std::span<const double>(content.levels.data(), size_of(content.levels.size())));
  return written;
}

}  // namespace palpable
