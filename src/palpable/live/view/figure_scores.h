/// @file
/// Scores of a frame for the three situations of the paper's Fig. 9, by which a run keeps the best
/// picture of each.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/session/session.h"

namespace palpable {

/// Larger is better; 0 means that the situation does not occur.
struct FigureScores {
  double hand_nearer = 0;  ///< a hand hides part of the body: largest when it hides half
  double body_nearer = 0;  ///< a hand passes behind the body: the share of the body in front of it
  double touch = 0;  ///< Pa, sum of the stress around the touch, weighted by facing the camera
};

/// Computes the scores; a scene with a touch scores as a touch only.
/// @param session     the one that made the scene
/// @param visible     where bodies are visible, from SceneRenderer::draw()
/// @param body_depth  Z of the bodies alone, of the same size, m, NaN beside them
[[nodiscard]] FigureScores figure_scores(const Scene& scene, const Session& session,
                                         const MaskImage& visible, const DepthImage& body_depth);

}  // namespace palpable
