/// @file
/// What a body's tables of touch can do, told to people and to other programs.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/modal_tables.h"
#include "palpable/common/response/touch_tables.h"

#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// "anywhere, several at a time, 3rd order; 140 regions; 52 MB", or of a body without tables "at
/// its sites, one at a time"; with held_out_text() where that is known.
[[nodiscard]] std::string touch_text(const std::optional<TouchTables>& tables);

/// Of a body with an energy in modes.
[[nodiscard]] std::string touch_text(const ModalTables& tables, const ReducedBody& body);
[[nodiscard]] Json touch_json(const ModalTables& tables, const ReducedBody& body);

/// The same of tables that may be damaged: then what is wrong with them.
[[nodiscard]] std::string touch_text(const Result<std::optional<TouchTables>>& tables);

/// The same as an object; null without tables.
[[nodiscard]] Json touch_json(const std::optional<TouchTables>& tables);

/// Held-out touches as an array of objects: what presses, how deep, and each difference.
[[nodiscard]] Json touches_json(const std::vector<HeldOutTouch>& touches);

/// For the provenance: how many modes, regions and neighbours there are.
[[nodiscard]] std::string touch_line(const TouchTables& tables);

}  // namespace palpable
