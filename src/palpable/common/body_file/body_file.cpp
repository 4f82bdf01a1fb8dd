#include "palpable/common/body_file/body_file.h"

#include "palpable/common/base/file_format.h"
#include "palpable/common/body_file/body_file_groups.h"
#include "palpable/common/body_file/hdf5_tools.h"

#include <fmt/format.h>

#include <mutex>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

namespace palpable {
namespace {

using hdf5::Trouble;

constexpr hdf5::ImageKind kBody{kBodyMark, kBodyFileVersion, "a body file of Palpable",
                                "bake the body again"};

ReducedBody from_bytes(const std::string& bytes, const ReadGroups& further = {}) {
  const hdf5::Image image(bytes, kBody);
  ReducedBody body = body_file::read_content(image.file());
  if (further) further(image.file(), body);
  return body;
}

}  // namespace

Result<ReducedBody> read_body_file(const std::filesystem::path& path) {
  return read_body_file(path, ReadGroups{});
}

Result<ReducedBody> read_body_file(const std::filesystem::path& path, const ReadGroups& further) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) {
    return Problem{
        fmt::format("{}: no such body file; make one with 'palpable bake'", path.string())};
  }
  const std::lock_guard turn(hdf5::turn());
  const hdf5::Quiet quiet;
  try {
    return from_bytes(hdf5::image_bytes(path, kBody), further);
  } catch (const Trouble& trouble) {
    return Problem{fmt::format("{}: {}", path.string(), trouble.what)};
  } catch (const std::bad_alloc&) {
    return Problem{fmt::format("{}: needs more memory than there is", path.string())};
  }
}

Result<ReducedBody> read_pressable_body(const std::filesystem::path& path,
                                        const std::map<std::string, double>& values) {
  Result<ReducedBody> body = read_body_file(path);
  if (!body.ok()) return body;
  Result<ReducedBody> result = settled(body.value(), values);
  if (result.ok()) return result;
  return Problem{fmt::format("{}: {}", path.string(), result.problem().message)};
}

ReductionError write_body_file(const std::filesystem::path& path, const ReducedBody& body,
                               ModeStorage storage) {
  return write_body_file(path, body, storage, WriteGroups{});
}

ReductionError write_body_file(const std::filesystem::path& path, const ReducedBody& body,
                               ModeStorage storage, const WriteGroups& further) {
  if (body.level_slope.size() == 0 && body.press_depth.size() > 0) {
    ReducedBody tabulated = body;
    tabulate_press(tabulated);
    return write_body_file(path, tabulated, storage, further);
  }
  const std::lock_guard turn(hdf5::turn());
  const hdf5::Quiet quiet;
  try {
    const std::string bytes = hdf5::image_of(kBody.kind, kBody.layout, [&](hid_t file) {
      body_file::write_content(file, body, storage);
      if (further) further(file);
    });
    // Reading the bytes back ensures that a body which breaks a rule of reduced_body.h is not
    // written.
    const ReductionError error = from_bytes(bytes).error;
    hdf5::write_durably(path, bytes);
    return error;
  } catch (const Trouble& trouble) {
    throw Error(fmt::format("{}: {}", path.string(), trouble.what));
  }
}

}  // namespace palpable
