/// @file
/// Warnings about materials that can be solved, but hardly as they were meant.
#pragma once

#include "palpable/bake/describe/body_description.h"

#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// Poisson's ratio from which 4-node elements get a warning. On the block of docs/body.md
/// they are 22 % too stiff there, 13 % at 0.45, and ten times too stiff at 0.4999.
inline constexpr double kLockingPoisson = 0.48;

/// Ratio of the largest displacement to the body's largest extent below which a body hardly moves:
/// of a body of 100 mm a ten-thousandth of a millimetre, a thousandth of what depth can tell.
inline constexpr double kHardlyMoves = 1e-6;

/// Warnings, each beginning with file and line: Poisson's ratios from kLockingPoisson on where
/// elements have four nodes, with remedy and cost; moduli above those of any material; a weight of
/// the density of air, or without acceleration. All
/// materials count: the body's, those of its parts, and what parameters vary. May read the shape's
/// file, as is_of_ten_nodes().
[[nodiscard]] std::vector<std::string> material_warnings(const BodyDescription& description);

/// The stiffness of [material] in words, as stiffness_text(), for messages about loads; with
/// Poisson's ratio from kLockingPoisson on, which stiffens a body as much.
[[nodiscard]] std::string young_words(const BodyDescription& description);

/// What acts on the body before it is pressed, with its values, and the stiffness of [material] in
/// words, for messages about bodies that cannot bear it.
[[nodiscard]] std::string preload_words(const BodyDescription& description);

/// What a full press came to.
struct FullPress {
  double force = 0;      ///< N, the largest of all sites
  double von_mises = 0;  ///< Pa, the largest
};

/// One line for people: the force at full load and the stiffness, whose unit decides about it in a
/// press by depth.
[[nodiscard]] std::string full_press_text(const BodyDescription& description,
                                          const FullPress& press);

/// A warning that names the unit of Young's modulus where a press by depth (not by force) cannot be
/// meant: a hard material (from 10 GPa on) with stress above a fiftieth of its modulus, which no
/// metal, glass or ceramic bears; or a force below 0.1 mN on a material softer than the softest
/// tissue or gel (100 Pa). Nothing otherwise.
[[nodiscard]] std::optional<std::string> absurd_press_text(const BodyDescription& description,
                                                           const FullPress& press);

/// How far the body moved under what pressed it.
struct Movement {
  double largest = 0;  ///< m, of a node
  double extent = 0;   ///< m, the body's largest
  double force = 0;    ///< N
};

/// A statement about a body that hardly moves under a force, with Young's modulus in words; nothing
/// for others. It is not a warning: steel under a small load does the same.
[[nodiscard]] std::optional<std::string> hardly_moves_text(const BodyDescription& description,
                                                           const Movement& movement);

}  // namespace palpable
