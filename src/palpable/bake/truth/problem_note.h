/// @file
/// What the results in a folder were solved for: a hash of the whole problem, by which a run that
/// goes on refuses to mix the solutions of two. Internal to this module.
#pragma once

#include "palpable/bake/solid/solid_model.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace palpable {

class ProblemNote {
 public:
  ProblemNote();

  void add(const void* data, std::size_t bytes);
  template <typename Numbers>
  void add_numbers(const Numbers& numbers) {
    add(numbers.data(), sizeof(*numbers.data()) * static_cast<std::size_t>(numbers.size()));
  }
  /// The mesh and what is held.
  void add_mesh(const SolidModel& model);
  /// The laws, their constants, and which element has which.
  void add_materials(const SolidModel& model);
  /// Coulomb's coefficient, and how friction is solved. Nothing without friction: results of
  /// versions that knew none stay valid.
  void add_friction(double coefficient);
  /// The content of a file; nothing if it does not exist.
  void add_file(const std::filesystem::path& file);

  /// Writes problem.txt into the folder.
  /// @param may_lack  results without a problem.txt, of versions that wrote none, are accepted
  /// @throws Error if the folder holds results of another problem
  void check(const std::filesystem::path& folder, bool may_lack) const;

 private:
  std::uint64_t hash_;
  std::string laws_;
};

}  // namespace palpable
