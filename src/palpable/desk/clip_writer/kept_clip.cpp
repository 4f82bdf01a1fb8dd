#include "palpable/desk/clip_writer/kept_clip.h"

#include "palpable/common/base/checksum.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/folder_lock.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/whole_file.h"
#include "palpable/desk/clip_writer/sequence_folder.h"

#include <fmt/core.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kSeed = 1;
constexpr std::string_view kOurs = "palpable";  // first word of made_for.txt

// The bytes of a label; empty when there is no such file, "?" for a file that is no label.
std::string bytes_of(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  constexpr std::uintmax_t kLargestLabel = 1 << 16;
  const Result<std::string> bytes = read_whole_file(path, {.most = kLargestLabel});
  return bytes ? bytes.value() : "?";
}

// Labels the folder as one that is being filmed into: if that is interrupted, it is still
// recognised as a clip's, whose earlier film, complete or not, is replaced.
// @param found  text of the present label
// @throws Error when the folder holds something else
void label_folder(const fs::path& folder, const fs::path& label_file, const std::string& found) {
  std::error_code error;
  const bool is_clip = fs::exists(label_file, error) && (found.empty() || found.starts_with(kOurs));
  if (!fs::is_empty(folder, error) && !is_clip) {
    throw Error(fmt::format("{}: is in the way of the synthetic clip; move it away or remove it",
                            folder.string()));
  }
  write_whole_file(label_file, fmt::format("{} is filming\n", kOurs));
}

}  // namespace

fs::path kept_clip(const ReducedBody& body, const KeptClipOrder& order, const Progress& progress) {
  const Result<std::uint64_t> checksum = file_checksum(order.body_file);
  if (!checksum.ok()) {
    throw Error(fmt::format("{}: {}", order.body_file.string(), checksum.problem().message));
  }
  const std::string label =
      fmt::format("{} {} {} {} frames seed {} body {:016x}\n", kOurs, order.version, order.sequence,
                  order.frames, kSeed, checksum.value());
  const fs::path label_file = order.folder / "made_for.txt";
  if (bytes_of(label_file) != label) {
    if (lies_in(order.body_file, order.folder)) {
      throw Error(
          fmt::format("{}: lies where the synthetic clip is kept; move it, or write "
                      "into another folder",
                      order.body_file.string()));
    }
    const FolderLock lock(order.folder);
    const std::string found = bytes_of(label_file);  // another run may have filmed it meanwhile
    if (found == label) return order.folder / "frames";
    label_folder(order.folder, label_file, found);
    write_sequence(body,
                   {.name = order.sequence,
                    .frames = order.frames,
                    .seed = kSeed,
                    .body_name = order.body_file.filename().string(),
                    .replaces = true},
                   order.folder, progress);
    write_whole_file(label_file, label);
  }
  return order.folder / "frames";
}

}  // namespace palpable
