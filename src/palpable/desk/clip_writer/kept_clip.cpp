#include "palpable/desk/clip_writer/kept_clip.h"

#include "palpable/common/base/checksum.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/desk/clip_writer/sequence_folder.h"

#include <fmt/core.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kSeed = 1;
constexpr std::string_view kOurs = "palpable";  // first word of made_for.txt

// The bytes of a file; empty when there is no such file.
std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// Removes an earlier clip, complete or not, from the folder and writes a label that says that it is
// being filmed: if this or the filming is interrupted, the folder is still recognised as a clip's.
// @param found  text of the present label
// @throws Error when the folder holds something else
void clear(const fs::path& folder, const fs::path& label_file, const std::string& found) {
  std::error_code error;
  const bool is_clip = fs::exists(label_file, error) && (found.empty() || found.starts_with(kOurs));
  if (fs::exists(folder, error) && !fs::is_empty(folder, error) && !is_clip) {
    throw Error(fmt::format("{}: is in the way of the synthetic clip; move it away or remove it",
                            folder.string()));
  }
  make_folder(folder);
  write_whole_file(label_file, fmt::format("{} is filming\n", kOurs));
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path() != label_file) fs::remove_all(entry.path(), error);
  }
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
  const std::string found = bytes_of(label_file);
  if (found != label) {
    if (lies_in(order.body_file, order.folder)) {
      throw Error(
          fmt::format("{}: lies where the synthetic clip is kept; move it, or write "
                      "into another folder",
                      order.body_file.string()));
    }
    clear(order.folder, label_file, found);
    write_sequence(body, {order.sequence, order.frames, kSeed, order.body_file.filename().string()},
                   order.folder, progress);
    write_whole_file(label_file, label);
  }
  return order.folder / "frames";
}

}  // namespace palpable
