#include "palpable/clip_writer/kept_clip.h"

#include "palpable/base/error.h"
#include "palpable/base/fnv1a.h"
#include "palpable/clip_writer/sequence_folder.h"

#include <fmt/core.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <system_error>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kSeed = 1;

// In pieces: a body with its inside may have hundreds of MB.
std::uint64_t hash_of_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::uint64_t hash = kFnvStart;
  std::string piece(std::size_t{1} << 20, '\0');
  while (in.read(piece.data(), std::ssize(piece)) || in.gcount() > 0) {
    hash = fnv1a({piece.data(), static_cast<std::size_t>(in.gcount())}, hash);
  }
  return hash;
}

// Empty when there is no such file.
std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace

fs::path kept_clip(const ReducedBody& body, const KeptClipOrder& order, const Progress& progress) {
  const std::string label =
      fmt::format("palpable {} demo {} frames seed {} body {:016x}\n", order.version, order.frames,
                  kSeed, hash_of_file(order.body_file));
  const fs::path label_file = order.folder / "made_for.txt";
  const std::string found = bytes_of(label_file);
  if (found != label) {
    std::error_code error;
    if (fs::exists(order.folder) && !fs::is_empty(order.folder) && found.empty()) {
      throw Error(fmt::format("{}: is in the way of the synthetic clip; move it away or remove it",
                              order.folder.string()));
    }
    fs::remove_all(order.folder, error);
    write_sequence(body, {"demo", order.frames, kSeed, order.body_file.filename().string()},
                   order.folder, progress);
    std::ofstream(label_file) << label;
  }
  return order.folder / "frames";
}

}  // namespace palpable
