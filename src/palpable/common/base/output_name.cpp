#include "palpable/common/base/output_name.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// Endings of files that this program or those around it write. Others, as of "run.2" and
// "bunny.snapshots", are parts of a folder's name.
constexpr std::array<std::string_view, 41> kEndingsOfFiles{
    ".palpable", ".palprec", ".msh",  ".inp",  ".vtu",   ".vtk", ".pvd",  ".stl", ".ply",
    ".obj",      ".off",     ".3ds",  ".glb",  ".gltf",  ".npy", ".npz",  ".csv", ".json",
    ".html",     ".htm",     ".xdmf", ".xmf",  ".pxdmf", ".h5",  ".mp4",  ".avi", ".mkv",
    ".mov",      ".png",     ".jpg",  ".jpeg", ".toml",  ".yml", ".yaml", ".txt", ".zip",
    ".jsonl",    ".xml",     ".conf", ".pdf",  ".step"};

bool is_one_of(std::string_view ending, const auto& endings) {
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

}  // namespace

void require_ending(const fs::path& output, const std::vector<std::string_view>& endings,
                    std::string_view what) {
  PALPABLE_EXPECT(!endings.empty(), "a file has an ending");
  if (output.empty()) throw Error("the name of the output is empty");
  if (is_one_of(output.extension().string(), endings)) return;
  // "bunny" becomes "bunny.palpable"; of "x.stl" the ending is replaced, of "x.2" it is kept.
  fs::path better = output;
  if (is_one_of(better.extension().string(), kEndingsOfFiles)) better.replace_extension();
  better += endings.front();
  throw Error(fmt::format("{}: what is written is {}, whose name ends in {}; call it {}",
                          output.string(), what, fmt::join(endings, " or "), better.string()));
}

void require_folder_name(const fs::path& output) {
  const fs::path named = output.has_filename() ? output : output.parent_path();  // "out/"
  std::error_code ignored;
  const std::string ending = named.extension().string();
  if (!is_one_of(ending, kEndingsOfFiles) || fs::is_directory(named, ignored)) return;
  throw Error(fmt::format("{}: is the name of a file ({}), and a folder is written; call it {}",
                          output.string(), ending, fs::path(named).replace_extension().string()));
}

}  // namespace palpable
