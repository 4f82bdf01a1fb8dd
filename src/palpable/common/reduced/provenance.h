/// @file
/// Where the numbers of a body come from.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {

/// How far the bake of a body file has come. A first bake writes its file after each stage, so that
/// the body can be pressed early. Each stage is better than the one before.
enum class BodyStage {
  kReduced,   ///< at its sites only: the tables of touch are missing
  kLinear,    ///< with the tables of small touches only
  kTables,    ///< with all tables, whose error was not measured yet
  kFinished,  ///< all that was asked for; also every file that does not state its stage
};

/// The word for a stage in files, "linear"; empty for kFinished.
[[nodiscard]] std::string_view key_of(BodyStage stage);
/// The stage of such a word; kFinished for any other, as a later program may have written it.
[[nodiscard]] BodyStage stage_of_key(std::string_view key);

/// What is missing at a stage, for people: "only small touches are right: ..."; empty when
/// finished.
[[nodiscard]] std::string_view missing_at(BodyStage stage);

/// What a body was made of and how, and how far it is from what it was made of. The texts are for
/// people. What is empty is not known, or does not apply to the body.
struct Provenance {
  std::string description = {};  ///< the file that describes the body
  std::string mesh_source = {};  ///< the surface or mesh, and what was done to it
  /// Who made the shape, where it is from, and its terms, for whoever shows it; empty: not stated.
  std::string credit = {}, credit_url = {}, terms = {};
  std::string mesh = {};                     ///< its size and quality
  std::string material = {};                 ///< laws and constants
  std::string support = {};                  ///< what is held
  std::string preload = {};                  ///< weight, pressures, supports that move
  std::optional<double> preload_moves = {};  ///< m: largest displacement of a node by the preload
  std::string loads = {};                    ///< of the snapshots: where, how large
  std::optional<int> sites_reached = {};     ///< sites that reach these loads
  std::string snapshots = {};                ///< the files they were imported from
  std::string solver = {};
  std::string series = {};                     ///< of an intrusive bake: the power series
  std::string reduction = {};                  ///< the method
  std::string displacement = {}, stress = {};  ///< their modes and errors
  std::string several_loads = {};              ///< the same, of several loads at once
  std::string between_sites = {};              ///< error between sites
  std::string modes = {};                      ///< another program's file
  std::string errors = {};                     ///< of another program's modes
  std::string touch = {};                      ///< the tables of touch
  BodyStage stage = BodyStage::kFinished;
  std::string program = {}, command_line = {};
  std::string held_out = {};  ///< error at levels in between
  /// Errors at values of a free parameter in between.
  struct HeldOutValue {
    std::string parameter;
    double value = 0;
    std::string errors;
    bool operator==(const HeldOutValue&) const = default;
  };
  std::vector<HeldOutValue> held_out_values = {};
  std::optional<double> scaled_by = {};  ///< its size as a multiple of that at which it was made
  /// (key, text) Lines of an older file that have no member here.
  std::vector<std::pair<std::string, std::string>> others = {};

  bool operator==(const Provenance&) const = default;
};

/// (key, text) lines for people, in the order of the members, without the empty ones.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> lines_of(
    const Provenance& provenance);

/// An object with the members as keys, without the empty ones.
[[nodiscard]] Json json_of(const Provenance& provenance);

/// Reads what json_of() wrote, as a text. Keys that a later program may have added are skipped.
/// The problem says that the provenance is damaged.
[[nodiscard]] Result<Provenance> provenance_of_json(std::string_view text);

/// Reads the lines of older files, which are those of lines_of().
[[nodiscard]] Provenance provenance_of_lines(
    const std::vector<std::pair<std::string, std::string>>& lines);

}  // namespace palpable
