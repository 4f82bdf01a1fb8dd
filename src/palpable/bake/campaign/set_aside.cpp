#include "palpable/bake/campaign/set_aside.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/folder_lock.h"
#include "palpable/common/base/output_file.h"

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <string>
#include <system_error>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

fs::path aside_of(const fs::path& folder, const StoreContent& content) {
  fs::path aside = folder.has_filename() ? folder : folder.parent_path();  // "out/" is "out"
  aside += fmt::format(".{:08x}", campaign_key(content) >> 32);
  return aside;
}

// The key of each file, by the file's name.
using Keys = std::map<std::string, std::uint64_t>;

Keys keys_of_units(const SnapshotStore& store) {
  Keys keys;
  for (int u = 0; u < store.content().unit_count(); ++u) {
    keys.emplace(store.unit_file(u).filename().string(), store.content().keys[u]);
  }
  return keys;
}

Keys keys_of_linear_responses(const SnapshotStore& store) {
  Keys keys;
  for (int k = 0; k < store.content().linear_file_count(); ++k) {
    keys.emplace(store.linear_file(k).filename().string(), store.content().linear_key);
  }
  return keys;
}

Keys those_in(const fs::path& folder, Keys keys) {
  std::erase_if(keys, [&](const auto& file) {
    std::error_code error;
    return !fs::is_regular_file(folder / file.first, error);
  });
  return keys;
}

Keys those_valid(Keys keys, const Keys& wanted) {
  std::erase_if(keys, [&](const auto& file) {
    const auto same = wanted.find(file.first);
    return same == wanted.end() || same->second != file.second;
  });
  return keys;
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

// Tables of touch carry their own keys, so all of them are linked; one that is no longer valid is
// made again later and replaces its link.
void link_touch_tables(const fs::path& from, const fs::path& to) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(from, error)) {
    const fs::path name = entry.path().filename();
    if (name.string().find(".part-") != std::string::npos || fs::exists(to / name, error)) continue;
    make_folder(to);
    link_or_copy(entry.path(), to / name);
  }
}

}  // namespace

std::string set_aside_text(const fs::path& folder, const SetAside& aside) {
  return fmt::format("{} held {} sites of another description: kept in {}{}", folder.string(),
                     aside.units, aside.folder.string(),
                     aside.brought_back ? "; this description's own were brought back" : "");
}

void require_own_campaign(const fs::path& folder, const StoreContent& content) {
  if (campaign_key(SnapshotStore::open(folder).content()) == campaign_key(content)) return;
  throw Error(
      fmt::format("{}: another run began to fill it with another description at the same moment; "
                  "wait for its end, or give each its own --snapshots",
                  folder.string()));
}

std::optional<SetAside> set_aside_other_campaign(const fs::path& folder,
                                                 const StoreContent& content) {
  std::error_code error;
  if (!fs::exists(folder / "campaign.h5", error)) return std::nullopt;
  const SnapshotStore old = SnapshotStore::open(folder);
  const SnapshotStore now = SnapshotStore::attach(folder, content);
  // Otherwise a run in progress would continue to write its campaign into this campaign's folder.
  std::optional<FolderLock> lock;
  if (campaign_key(old.content()) != campaign_key(content)) lock.emplace(folder);
  const Keys units = those_in(folder, keys_of_units(old));
  const Keys linear = those_in(folder, keys_of_linear_responses(old));
  const Keys valid_units = those_valid(units, keys_of_units(now));
  const Keys valid_linear = those_valid(linear, keys_of_linear_responses(now));
  if (valid_units == units && valid_linear == linear) return std::nullopt;

  SetAside result{.folder = aside_of(folder, old.content()),
                  .units = static_cast<int>(units.size()),
                  .still_valid = static_cast<int>(valid_units.size())};
  move_folder(folder, result.folder);
  const fs::path own = aside_of(folder, content);
  if (fs::is_directory(own, error)) {
    move_folder(own, folder);
    result.brought_back = true;
  } else {
    make_folder(folder);
    fs::copy_file(result.folder / "campaign.h5", folder / "campaign.h5", error);
  }
  for (const Keys& valid : {valid_units, valid_linear}) {
    for (const auto& [name, key] : valid) {
      if (!fs::exists(folder / name, error)) link_or_copy(result.folder / name, folder / name);
    }
  }
  link_touch_tables(SnapshotStore::attach(result.folder, old.content()).touch_folder(),
                    now.touch_folder());
  return result;
}

void refuse_among_snapshots(const std::filesystem::path& body,
                            const std::filesystem::path& folder) {
  if (!lies_in(body, folder)) return;
  if (lies_in(folder, body)) {
    throw Error(
        fmt::format("{}: the body file cannot have the name of its snapshots; call it "
                    "{}.palpable",
                    body.string(), folder.stem().string()));
  }
  throw Error(
      fmt::format("{}: lies in the folder of the snapshots, {}, and could replace one of them; "
                  "name a file outside of it",
                  body.string(), folder.string()));
}

void refuse_campaign_folder(const std::filesystem::path& folder) {
  std::error_code error;
  if (!fs::exists(folder / "campaign.h5", error)) return;
  throw Error(
      fmt::format("{}: holds the snapshots of a campaign; name another folder", folder.string()));
}

}  // namespace palpable
