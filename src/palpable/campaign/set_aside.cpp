#include "palpable/campaign/set_aside.h"

#include "palpable/base/error.h"
#include "palpable/base/output_file.h"

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <string>
#include <system_error>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// Of all that the campaign's units are computed from.
std::uint64_t hash_of(const StoreContent& content) {
  Digest digest;
  for (const std::uint64_t key : content.keys) digest.add(&key, sizeof key);
  return digest.value();
}

fs::path aside_of(const fs::path& folder, const StoreContent& content) {
  fs::path aside = folder.has_filename() ? folder : folder.parent_path();  // "out/" is "out"
  aside += fmt::format(".{:08x}", hash_of(content) >> 32);
  return aside;
}

// By the names of their files, keys of the units that are there.
std::map<std::string, std::uint64_t> units_there(const SnapshotStore& store) {
  std::map<std::string, std::uint64_t> units;
  for (int u = 0; u < store.content().unit_count(); ++u) {
    const fs::path file = store.unit_file(u);
    std::error_code error;
    if (fs::is_regular_file(file, error)) {
      units.emplace(file.filename().string(), store.content().keys[u]);
    }
  }
  return units;
}

void move_folder(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) {
    throw Error(
        fmt::format("{}: holds snapshots of another description and cannot be moved to {}: "
                    "{}",
                    from.string(), to.string(), error.message()));
  }
}

void link_or_copy(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_hard_link(from, to, error);
  if (error) fs::copy_file(from, to, error);
  if (error) throw Error(fmt::format("{}: cannot be made: {}", to.string(), error.message()));
}

}  // namespace

std::optional<SetAside> set_aside_other_campaign(const fs::path& folder,
                                                 const StoreContent& content) {
  std::error_code error;
  if (!fs::exists(folder / "campaign.h5", error)) return std::nullopt;
  const SnapshotStore old = SnapshotStore::open(folder);
  const SnapshotStore now = SnapshotStore::attach(folder, content);
  const std::map<std::string, std::uint64_t> there = units_there(old);
  std::map<std::string, std::uint64_t> valid;
  for (int u = 0; u < content.unit_count(); ++u) {
    const auto unit = there.find(now.unit_file(u).filename().string());
    if (unit != there.end() && unit->second == content.keys[u]) valid.insert(*unit);
  }
  if (valid.size() == there.size()) return std::nullopt;

  SetAside result{.folder = aside_of(folder, old.content()),
                  .units = static_cast<int>(there.size()),
                  .still_valid = static_cast<int>(valid.size())};
  move_folder(folder, result.folder);
  const fs::path own = aside_of(folder, content);
  if (fs::is_directory(own, error)) {
    move_folder(own, folder);
    result.brought_back = true;
  } else {
    make_folder(folder);
    fs::copy_file(result.folder / "campaign.h5", folder / "campaign.h5", error);
  }
  for (const auto& [name, key] : valid) {
    if (!fs::exists(folder / name, error)) link_or_copy(result.folder / name, folder / name);
  }
  return result;
}

}  // namespace palpable
