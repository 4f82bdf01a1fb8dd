/// @file
/// One body of a session: as it is given to Session::make(), and as the session keeps it.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/session/body_response.h"

#include <optional>
#include <string>
#include <utility>

namespace palpable {

/// A body and its pose in the world.
struct PlacedBody {
  TouchableBody body;
  Rigid3 world_from_body = Rigid3::Identity();  ///< the world is the first frame's camera
  std::string name = {};                        ///< in files and captions; empty: the body's own
  std::optional<Rgb> color = {};                ///< of its material; none: that of rubber

  /// The given name, else the one in the body file.
  [[nodiscard]] const std::string& shown_name() const {
    return name.empty() ? body.body.name : name;
  }
};

/// A body of a running session.
struct SessionBody {
  /// @param twin  as that of BodyResponse
  SessionBody(PlacedBody placed, const ResponseSettings& settings, const BodyResponse* twin)
      : world_from_body(placed.world_from_body),
        name(placed.shown_name()),
        color(placed.color),
        response(std::move(placed.body), settings, twin) {}

  Rigid3 world_from_body;    ///< as PlacedBody's
  std::string name;          ///< PlacedBody::shown_name()
  std::optional<Rgb> color;  ///< as PlacedBody's
  BodyResponse response;     ///< the body's obstacles, touches and shape

  /// The body at rest, as it was baked.
  [[nodiscard]] const ReducedBody& model() const { return response.body(); }
};

}  // namespace palpable
