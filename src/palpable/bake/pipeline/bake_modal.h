/// @file
/// Tables with which a body of an intrusive bake can be touched anywhere, by its energy in modal
/// coordinates (response/modal_body.h).
#pragma once

#include "palpable/bake/intrusive/intrusive_bake.h"
#include "palpable/common/response/modal_tables.h"

namespace palpable {

/// @pre made.body.several  @throws Error as SkinResponse
[[nodiscard]] ModalTables modal_tables(const IntrusiveBake& made);

}  // namespace palpable
