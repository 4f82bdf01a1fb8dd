#include "palpable/bake/truth/problem_note.h"

#include "palpable/bake/campaign/solid_file.h"
#include "palpable/bake/truth/hand_walks.h"
#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/checksum.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/whole_file.h"

#include <fmt/core.h>

#include <system_error>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// Raise it when friction is solved in another way.
constexpr int kFrictionVersion = 3;

// The content of a text file of the clip; empty if the file does not exist.
std::string file_text(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  Result<std::string> bytes = read_whole_file(path, {.most = longest_text(Notation::kJson)});
  if (!bytes) throw Error(fmt::format("{}: {}", path.string(), bytes.problem().message));
  return std::move(bytes).value();
}

}  // namespace

ProblemNote::ProblemNote() : hash_(kFnvStart) {}

void ProblemNote::add(const void* data, std::size_t bytes) {
  hash_ = fnv1a({static_cast<const char*>(data), bytes}, hash_);
}

void ProblemNote::add_mesh(const SolidModel& model) {
  add_numbers(model.mesh.nodes);
  add_numbers(model.mesh.tets);
  add_numbers(model.fixed_nodes);
}

void ProblemNote::add_materials(const SolidModel& model) {
  laws_ = law_name(model.material);
  add_numbers(constants_of(model.material));
  add_numbers(material_groups(model));
  for (const MaterialGroup& group : model.groups) {
    laws_ += ' ';
    laws_ += law_name(group.material);
    add_numbers(constants_of(group.material));
  }
}

void ProblemNote::add_friction(double coefficient) {
  if (!(coefficient > 0.0)) return;
  add(&coefficient, sizeof coefficient);
  add(&kFrictionVersion, sizeof kFrictionVersion);
  add(&kFrictionStep, sizeof kFrictionStep);
}

void ProblemNote::add_file(const fs::path& file) {
  const std::string text = file_text(file);
  add(text.data(), text.size());
}

void ProblemNote::check(const fs::path& folder, bool may_lack) const {
  const fs::path note = folder / "problem.txt";
  const std::string here = fmt::format("{} {:016x}\n", laws_, hash_);
  std::error_code error;
  if (fs::exists(folder / "deformed.jsonl", error)) {
    const bool has_note = fs::exists(note, error);
    if (!has_note && may_lack) return;
    if (!has_note || file_text(note) != here) {
      throw Error(
          fmt::format("{}: holds answers of another material, support, load, friction or hand, or "
                      "of another version of friction; remove it to solve anew",
                      folder.string()));
    }
  }
  write_whole_file(note, here);
}

}  // namespace palpable
