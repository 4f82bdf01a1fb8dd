/// @file
/// Skins as binary messages to a page. All numbers have four bytes, little-endian, so that a page
/// reads them in place (docs/web.md#the-live-desk):
///
///     "MESH"  B   then of each of the B bodies   T  triangles (3T)
///     "SKIN"  F  B   then of each body   V  vertices (3V)  normals (3V)  stress (V)
///
///   B, T, V  uint32, bodies, triangles, vertices     F  uint32, number of the frame
///   triangles  int32, indices of vertices; counter-clockwise seen from outside
///   vertices  float32, m, body frame     normals  float32, unit     stress  float32, Pa, von Mises
#pragma once

#include "palpable/live/things/scene_body.h"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <string>

namespace palpable {

[[nodiscard]] std::string mesh_message(std::span<const Eigen::Matrix3Xi> triangles);

/// @param bytes  overwritten; its memory is reused
void write_skin_message(int frame, std::span<const SceneBody> bodies, std::string& bytes);

/// Where the skins begin in a message, behind its frame's number: two messages with the same bytes
/// from here on show the same.
inline constexpr std::size_t kSkinsBegin = 8;

}  // namespace palpable
