#include "palpable/bake/campaign/merge_stores.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace palpable {

CollectedStore merge_stores(const std::vector<std::filesystem::path>& parts,
                            const std::filesystem::path& output, const Progress& progress) {
  PALPABLE_EXPECT(!parts.empty(), "there is something to merge");
  std::vector<SnapshotStore> stores;
  for (const std::filesystem::path& part : parts) {
    SnapshotStore store = SnapshotStore::open(part);
    if (!stores.empty() && (store.content().keys != stores[0].content().keys ||
                            store.content().linear_key != stores[0].content().linear_key)) {
      throw Error(fmt::format(
          "{}: not of the same campaign as {}: mesh, material, loads, sites, levels or program "
          "version differ",
          part.string(), parts[0].string()));
    }
    stores.push_back(std::move(store));
  }
  std::optional<SetAside> set_aside = set_aside_other_campaign(output, stores[0].content());
  SnapshotStore merged = SnapshotStore::create(output, stores[0].content());
  const int units = merged.content().unit_count();
  int missing = 0, first_missing = -1;
  std::string why;
  for (int u = 0; u < units; ++u) {
    report(progress, {"merging", static_cast<double>(u), static_cast<double>(units), ""});
    if (merged.has(u)) continue;
    bool found = false;
    for (const SnapshotStore& store : stores) {
      if (!store.has(u)) continue;
      merged.copy_from(store, u);
      found = true;
      break;
    }
    if (found) continue;
    if (missing++ == 0) {
      first_missing = u;
      why = stores.back().why_not(u);
    }
  }
  const int rows = merged.content().linear_file_count();
  int lost_rows = 0;
  for (int k = 0; k < rows; ++k) {
    if (merged.has_linear(k)) continue;
    const auto part = std::find_if(stores.begin(), stores.end(),
                                   [&](const SnapshotStore& store) { return store.has_linear(k); });
    if (part == stores.end()) {
      ++lost_rows;
    } else {
      merged.copy_linear_from(*part, k);
    }
  }
  if (lost_rows > 0 && missing == 0) {
    throw Error(
        fmt::format("{} of {} files of linear responses are in none of the folders: run "
                    "the shards that did not end once more",
                    lost_rows, rows));
  }
  if (missing > 0) {
    throw Error(fmt::format(
        "{} of {} snapshot files are in none of the folders, the first is {} ({}): run the shards "
        "that did not end once more",
        missing, units, merged.unit_file(first_missing).filename().string(), why));
  }
  report(progress, {"merging", static_cast<double>(units), static_cast<double>(units), ""});
  merged.finish();
  return {std::move(merged), std::move(set_aside)};
}

}  // namespace palpable
