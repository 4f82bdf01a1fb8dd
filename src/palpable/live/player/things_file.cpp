#include "palpable/live/player/things_file.h"

#include "palpable/common/base/error.h"

#include <utility>

namespace palpable {

bool ThingsFile::next(ThingsLine& line) {
  if (!lines_.next(text_)) return false;
  Result<ThingsLine> read = read_things_line(text_, time_);
  if (!read.ok()) throw Error(lines_.where() + read.problem().message);
  line = std::move(read).value();
  time_ = line.time;
  return true;
}

}  // namespace palpable
