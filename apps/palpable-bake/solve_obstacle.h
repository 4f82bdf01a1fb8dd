/// @file
/// palpable solve BODY.toml --obstacle "sphere 8mm at ... to ...": solves contact
/// instead of a load.
#pragma once

#include "palpable/bake/campaign/press_solver.h"
#include "palpable/bake/describe/body_problem.h"

#include <string>
#include <vector>

namespace palpable::app {

struct ObstacleOptions {
  std::vector<std::string> obstacles;
  std::string pose_file;
  int steps = 10;
  double spacing = 0;  // m; 0: default of ContactSettings
};

/// Moves the obstacles along their paths, prints a table of the steps and writes the last state.
/// @param json  print the last state as JSON
/// @throws Error when not even the first step converges
void solve_obstacle(const ObstacleOptions& options, const std::string& output,
                    const BodyProblem& problem, const PressSolver& presses, bool json);

}  // namespace palpable::app
