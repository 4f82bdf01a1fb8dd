/// @file
/// Reads and writes the touch tables in a body file: its groups /touch and /touch_modes
/// (docs/body_file.md).
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/common/response/touch_tables.h"
#include "palpable/common/response/touchable_body.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace palpable {

/// Version of the group's layout. It is provisional: tables of another version are refused; the
/// body itself can still be read.
inline constexpr int kTouchLayout = 2;

/// Reads and checks a body file with its tables. For any bytes, the result has tables that satisfy
/// every rule of their headers and belong to the body's skin, or it is a problem that names the
/// file and its error.
[[nodiscard]] Result<TouchableBody> read_touchable_body(const std::filesystem::path& path);

/// A body and, separately, its tables or why they cannot be used.
struct BodyAndTouch {
  ReducedBody body;
  Result<std::optional<TouchTables>> touch;
  std::optional<ModalTables> modal = {};
};

/// The same, but damaged tables do not prevent reading the body: then only `touch` is a problem.
[[nodiscard]] Result<BodyAndTouch> read_body_and_touch(const std::filesystem::path& path);

/// The same, settled, as the live half needs it. A body with further parameters gets no tables,
/// since its tables hold for the defaults of these parameters only. @param values see settled()
[[nodiscard]] Result<TouchableBody> read_pressable_touchable_body(
    const std::filesystem::path& path, const std::map<std::string, double>& values = {});

/// write_body_file() with tables. @throws Error as that, and if the tables are not consistent or of
/// another skin
ReductionError write_touchable_body(const std::filesystem::path& path, const ReducedBody& body,
                                    const TouchTables& tables,
                                    ModeStorage storage = ModeStorage::kFloat32);
/// The same for a body with an energy in modes and its tables.
ReductionError write_touchable_body(const std::filesystem::path& path, const ReducedBody& body,
                                    const ModalTables& tables,
                                    ModeStorage storage = ModeStorage::kFloat32);

}  // namespace palpable
