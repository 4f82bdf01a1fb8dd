/// @file
/// Judges what another solver has computed against the description that it is imported with: nodes
/// that the support holds, the range of displacements, stress against the law. They find a wrong
/// unit and a wrong order of nodes or components, which no file states.
///
///   N  nodes
#pragma once

#include "palpable/bake/solid/solid_model.h"
#include "palpable/bake/solid/stress.h"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <string>

namespace palpable {

/// @param held     of the model; components that the support moves are not judged
/// @param u        (3 x N) m
/// @param numbers  (N) of the nodes in the mesh's file
/// @param place    how messages begin
/// @throws Error when a node that the support holds moves by more than a twentieth of the largest
///         displacement: with its number and the likely causes
void refuse_moved_support(std::span<const HeldComponent> held, const Eigen::Matrix3Xd& u,
                          std::span<const std::int64_t> numbers, const std::string& place);

/// @param range  m
/// @throws Error when a node moves by more than the range
void refuse_far_displacement(std::span<const HeldComponent> held, const Eigen::Matrix3Xd& u,
                             double range, const std::string& place);

/// What imported stress is, against the stress of the law at the imported displacement.
struct StressJudgement {
  std::string text;         ///< one line for people
  bool is_warning = false;  ///< a unit or an order is probably wrong
};

/// Compares deviators, whose norm is the von Mises stress, over the whole volume. The pressure of
/// nearly incompressible bodies is left out: 4-node elements do not have it.
/// @param stress  (6 x N) Pa as imported
[[nodiscard]] StressJudgement judge_stress(const SolidModel& model, const Eigen::Matrix3Xd& u,
                                           const StressField& stress);

}  // namespace palpable
