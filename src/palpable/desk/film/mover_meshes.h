/// @file
/// All moving things as painted triangles: hands with their sleeves, pencils, cups.
/// Desk frame (script/desk_body.h).
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/film/painted_mesh.h"
#include "palpable/desk/script/desk_look.h"
#include "palpable/desk/script/hand.h"

#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// The images with which movers are painted; PaintedMesh::image in mover_meshes() is an index in
/// this list.
[[nodiscard]] std::vector<ColorImage> mover_images(const DeskLook& look);

/// The surfaces of the movers, one mesh for each of mover_images().
///
/// * Vertices lie on the capsules, and triangles within 0.09 mm of them.
/// * Normals of skin and sleeve are those of a smooth union of the capsules, so that the capsules
///   of a hand are shaded as one surface.
/// * Triangles inside another capsule are left out, since they are not visible.
/// * If the frame of a cup is given, its wall is one surface of revolution instead of the capsules.
///
/// @param also  the same movers at another instant, or empty. With it, only triangles that are
///              inside at both instants are left out, so that the meshes of both have the same
///              triangles.
[[nodiscard]] std::vector<PaintedMesh> mover_meshes(std::span<const HandCapsule> capsules,
                                                    const std::optional<Rigid3>& desk_from_cup,
                                                    const DeskLook& look,
                                                    std::span<const HandCapsule> also = {});

}  // namespace palpable
