#include "bench/live/bench_clips.h"

#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/desk/clip_writer/kept_clip.h"

#include <fmt/core.h>

#include <system_error>

namespace palpable::app {

namespace fs = std::filesystem;

fs::path first_there(std::initializer_list<const char*> files) {
  std::error_code ignored;
  for (const char* file : files) {
    if (fs::exists(file, ignored)) return file;
  }
  return {};
}

fs::path kept_frames(const fs::path& clip, const fs::path& body_file, const std::string& sequence,
                     int frames, const Progress& progress) {
  const ReducedBody body = value_or_throw(read_pressable_body(body_file));
  const fs::path above = clip.parent_path();
  std::error_code error;
  fs::create_directories(above, error);
  if (error) throw Error(fmt::format("{}: {}", above.string(), error.message()));
  return kept_clip(body,
                   {.folder = clip,
                    .body_file = body_file,
                    .version = PALPABLE_VERSION,
                    .frames = frames,
                    .sequence = sequence},
                   progress);
}

}  // namespace palpable::app
