/// @file
/// Tables of touch in a body file: its groups /touch and /touch_modes (docs/body_file.md).
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

/// Version of the group's layout; provisional: tables of another one are refused, the body is read.
inline constexpr int kTouchLayout = 2;

/// Reads and checks a body file with its tables. Whatever the bytes, the tables keep every promise
/// of their headers and are of the body's skin, or the result is a problem that names the file and
/// what is wrong.
[[nodiscard]] Result<TouchableBody> read_touchable_body(const std::filesystem::path& path);

/// A body and its tables apart.
struct BodyAndTouch {
  ReducedBody body;
  Result<std::optional<TouchTables>> touch;
  std::optional<ModalTables> modal = {};
};

/// The same where damaged tables are no reason to refuse the body: they are the problem alone.
[[nodiscard]] Result<BodyAndTouch> read_body_and_touch(const std::filesystem::path& path);

/// The same, settled: what the live half presses. The tables of a body with further parameters
/// would be those of other values, so it has none. @param values see settled()
[[nodiscard]] Result<TouchableBody> read_pressable_touchable_body(
    const std::filesystem::path& path, const std::map<std::string, double>& values = {});

/// write_body_file() with tables. @throws Error as that, and if the tables are not consistent or of
/// another skin
ReductionError write_touchable_body(const std::filesystem::path& path, const ReducedBody& body,
                                    const TouchTables& tables,
                                    ModeStorage storage = ModeStorage::kFloat32);
/// The same with what a body with an energy in modes needs.
ReductionError write_touchable_body(const std::filesystem::path& path, const ReducedBody& body,
                                    const ModalTables& tables,
                                    ModeStorage storage = ModeStorage::kFloat32);

}  // namespace palpable
