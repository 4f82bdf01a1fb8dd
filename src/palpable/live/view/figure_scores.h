/// @file
/// How well a frame shows the three situations of the paper's Fig. 9, so that a run can keep the
/// best picture of each.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/session/session.h"

namespace palpable {

/// Larger is better; 0: the situation does not occur.
struct FigureScores {
  double hand_nearer = 0;  ///< a hand hides part of the body: best when it hides half
  double body_nearer = 0;  ///< a hand passes behind the body: the share of the body before it
  double touch = 0;        ///< stress (Pa) summed over what faces the camera around the site
};

/// A scene with a touch scores as a touch only.
/// @param session     that made the scene
/// @param visible     where bodies are seen, as SceneRenderer::draw() gives it
/// @param body_depth  the bodies alone, of the same size, m, NaN beside them
[[nodiscard]] FigureScores figure_scores(const Scene& scene, const Session& session,
                                         const MaskImage& visible, const DepthImage& body_depth);

}  // namespace palpable
