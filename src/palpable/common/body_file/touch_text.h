/// @file
/// Describes a body's touch tables, for users and for other programs.
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

/// "anywhere, several at a time, 3rd order; 140 regions; 52 MB", or for a body without tables "at
/// its sites, one at a time"; with held_out_text() if there are held-out touches.
[[nodiscard]] std::string touch_text(const std::optional<TouchTables>& tables);

/// The same for a body with an energy in modes.
[[nodiscard]] std::string touch_text(const ModalTables& tables, const ReducedBody& body);
[[nodiscard]] Json touch_json(const ModalTables& tables, const ReducedBody& body);

/// The same for tables that may be damaged; then the text is their error.
[[nodiscard]] std::string touch_text(const Result<std::optional<TouchTables>>& tables);

/// The same as a JSON object; null without tables.
[[nodiscard]] Json touch_json(const std::optional<TouchTables>& tables);

/// Held-out touches as an array of objects: the obstacle that presses, its depth, and each
/// difference.
[[nodiscard]] Json touches_json(const std::vector<HeldOutTouch>& touches);

/// "no mass: it follows what presses it, and does not swing back", or "29 vibration modes from 8.1
/// to 58.9 Hz, damping ratio 0.05; 0.47 kg of 1070 kg/m^3".
[[nodiscard]] std::string vibration_text(const std::optional<VibrationTable>& table);
/// The same as a JSON object; null without modes.
[[nodiscard]] Json vibration_json(const std::optional<VibrationTable>& table);

/// A line for the provenance: the numbers of modes, regions and neighbours.
[[nodiscard]] std::string touch_line(const TouchTables& tables);

}  // namespace palpable
