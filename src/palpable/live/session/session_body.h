/// @file
/// One of the bodies of a session: where it stands, and the part that answers for it.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/session/body_answer.h"

#include <optional>
#include <string>
#include <utility>

namespace palpable {

struct SessionBody {
  /// @param body  taken over only after all other arguments are read: the name may be its own
  SessionBody(const Rigid3& place, std::string body_name, const std::optional<Rgb>& own_color,
              TouchableBody&& body, const AnswerSettings& settings)
      : world_from_body(place),
        name(std::move(body_name)),
        color(own_color),
        answer(std::move(body), settings) {}

  Rigid3 world_from_body;    ///< the world is the first frame's camera, or that of given poses
  std::string name;          ///< in files and captions
  std::optional<Rgb> color;  ///< of its material; none: rubber
  BodyAnswer answer;         ///< what presses it, its touches and its shape

  [[nodiscard]] const ReducedBody& model() const { return answer.body(); }
};

}  // namespace palpable
