#include "palpable/desk/clip_files/json_lines.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/text_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

namespace palpable {
namespace {

using nlohmann::json;
using RowMajor4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

constexpr int kMostFrames = 10'000'000;
constexpr double kSkew = 1e-3;  // largest entry of R R^T - 1 of a pose

std::vector<double> first_numbers(const json& list, const std::string& what, std::size_t count) {
  if (!list.is_array() || list.size() < count) {
    throw Error(fmt::format("{} is no list of {} numbers", what, count));
  }
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) numbers.push_back(list[i].get<double>());
  return numbers;
}

std::string numbers_text(std::span<const double> numbers, int digits) {
  std::vector<std::string> texts;
  for (const double number : numbers) texts.push_back(fmt::format("{:.{}f}", number, digits));
  return fmt::format("[{}]", fmt::join(texts, ","));
}

// The number of a frame, from 0 to 10 million.
int frame_number(const json& value) {
  // get<int>() would silently truncate a number that is not whole.
  if (!value.is_number_integer()) {
    throw Error(fmt::format("{} is no frame's number",
                            value.dump(-1, ' ', false, json::error_handler_t::replace)));
  }
  const auto frame = value.get<std::int64_t>();
  if (frame < 0 || frame >= kMostFrames) throw Error(fmt::format("frame {} is no frame", frame));
  return static_cast<int>(frame);
}

void parse_and_read(const std::string& text, const std::function<void(JsonFields&)>& read,
                    bool only_objects = false) {
  try {
    const json value = json::parse(text);
    if (only_objects && !value.is_object()) throw Error("is no JSON object");
    JsonFields fields(value);
    read(fields);
  } catch (const json::parse_error& error) {
    throw Error(fmt::format("no JSON at character {}", error.byte));
  } catch (const json::exception& error) {
    // Without the exception's name in brackets in front, which means nothing to users.
    const std::string message = error.what();
    const auto end = message.find("] ");
    throw Error(end == std::string::npos ? message : message.substr(end + 2));
  }
}

}  // namespace

bool JsonFields::has(const char* key) const { return read_->contains(key); }

bool JsonFields::is_null(const char* key) const { return read_->at(key).is_null(); }

void JsonFields::object_if_there(const char* key,
                                 const std::function<void(JsonFields&)>& read) const {
  if (!has(key) || !read_->at(key).is_object()) return;
  JsonFields object(read_->at(key));
  read(object);
}

std::vector<int> JsonFields::frames(const char* key) const {
  if (!read_->at(key).is_array()) throw Error(fmt::format("{} is no list of frames", key));
  std::vector<int> frames;
  for (const json& frame : read_->at(key)) frames.push_back(frame_number(frame));
  return frames;
}

void JsonFields::frame(int& value) {
  if (!reads()) return whole("frame", value);
  value = frame_number(read_->at("frame"));
}

void JsonFields::flag(const char* key, bool& value) {
  if (!reads()) return add(key, value ? "true" : "false");
  read_->at(key).get_to(value);
}

void JsonFields::flag_if_set(const char* key, bool& value) {
  if (reads()) {
    value = read_->value(key, false);
  } else if (value) {
    flag(key, value);
  }
}

void JsonFields::text(const char* key, std::string& value) {
  if (reads()) {
    if (has(key)) read_->at(key).get_to(value);
  } else if (!value.empty()) {
    add(key, quoted_text(value));
  }
}

void JsonFields::whole(const char* key, int& value) {
  if (!reads()) return add(key, std::to_string(value));
  value = read_->value(key, value);
}

void JsonFields::index(const char* key, int& value) {
  if (reads() ? !has(key) : value < 0) return;
  if (reads() && !read_->at(key).is_number_integer()) {
    throw Error(fmt::format("{} is no whole number", key));
  }
  whole(key, value);
}

void JsonFields::id(const char* key, std::optional<std::int64_t>& value) {
  if (!reads() && value) return add(key, std::to_string(*value));
  if (!reads() || !has(key)) return;
  const json& id = read_->at(key);
  // get() would wrap a larger number silently.
  const bool fits =
      !id.is_number_unsigned() || std::in_range<std::int64_t>(id.get<std::uint64_t>());
  if (id.is_number_integer() && fits) value = id.get<std::int64_t>();
}

void JsonFields::number(const char* key, double& value, int digits) {
  if (!reads()) return add(key, fmt::format("{:.{}f}", value, digits));
  read_->at(key).get_to(value);
}

void JsonFields::number(const char* key, std::optional<double>& value, int digits,
                        Invalid invalid) {
  if (reads() ? !has(key) : !value) return;
  if (!reads() || read_->at(key).is_number())
    return number(key, value ? *value : value.emplace(), digits);
  if (invalid == Invalid::kRefused) throw Error(fmt::format("{} is no number", key));
  value.reset();
}

void JsonFields::number_or_null(const char* key, std::optional<double>& value, int digits) {
  if (!reads() && !value) return add(key, "null");
  number(key, value, digits, Invalid::kIgnored);
}

void JsonFields::number_up_to(double largest, const char* key, std::optional<double>& value,
                              int digits) {
  if (!reads()) return number(key, value, digits);
  if (!has(key)) return;
  number(key, value.emplace(), digits);
  if (!(*value >= 0 && *value <= largest)) {
    throw Error(fmt::format("{} is {}: it lies between 0 and {}", key, *value, largest));
  }
}

void JsonFields::vector(const char* key, Eigen::Vector3d& value, int digits) {
  if (!reads()) return add(key, numbers_text({value.data(), 3}, digits));
  value = Eigen::Map<const Eigen::Vector3d>(first_numbers(read_->at(key), key, 3).data());
}

void JsonFields::vector(const char* key, std::optional<Eigen::Vector3d>& value, int digits,
                        Invalid invalid) {
  if (!reads() && value) return vector(key, *value, digits);
  if (!reads() || !has(key)) return;
  const json& list = read_->at(key);
  const auto is_number = [](const json& entry) { return entry.is_number(); };
  if (invalid == Invalid::kRefused || (list.is_array() && list.size() >= 3 &&
                                       std::all_of(list.begin(), list.begin() + 3, is_number))) {
    vector(key, value.emplace(), digits);
  }
}

void JsonFields::rigid(const char* key, Rigid3& value) {
  if (!reads()) return add(key, fmt::format("[{:.9g}]", fmt::join(row_major(value), ",")));
  const RigidRows rows = rigid_of_rows(first_numbers(read_->at(key), key, 16));
  if (!rows.is_rigid) {
    throw Error(fmt::format("the 16 numbers of {} are no rigid motion, row by row", key));
  }
  value = rows.pose;
}

void JsonFields::rows_of_eight(const char* key, std::vector<std::vector<double>>& rows,
                               int digits) {
  std::vector<std::string> texts;
  for (const std::vector<double>& row : rows) texts.push_back(numbers_text(row, digits));
  if (!reads()) return add_list(key, texts);
  for (const json& row : read_->at(key)) {
    rows.push_back(first_numbers(row, fmt::format("an entry of {}", key), 8));
  }
}

void JsonFields::for_each_in(const char* key,
                             const std::function<void(JsonFields&)>& read_entry) const {
  const json& list = read_->at(key);
  if (!list.is_array()) throw Error(fmt::format("{} is no list", key));
  for (const json& entry : list) {
    if (!entry.is_object()) throw Error(fmt::format("an entry of {} is no object", key));
    JsonFields fields(entry);
    read_entry(fields);
  }
}

void JsonFields::add(const char* key, const std::string& json) {
  written_ += fmt::format("{}\"{}\":{}", written_.empty() ? "" : ",", key, json);
}

void JsonFields::add_list(const char* key, const std::vector<std::string>& entries) {
  add(key, fmt::format("[{}]", fmt::join(entries, ",")));
}

void for_each_object(const std::filesystem::path& path,
                     const std::function<void(JsonFields&)>& read_object) {
  for_each_line(path, [&](const std::string& line) {
    if (const auto unparsable = why_not_parsed(line, Notation::kJson)) {
      throw Error(unparsable->what);
    }
    parse_and_read(line, read_object);
  });
}

void read_object_file(const std::filesystem::path& path,
                      const std::function<void(JsonFields&)>& read_object) {
  const std::string text = value_or_throw(read_bounded_text(path, Notation::kJson));
  try {
    parse_and_read(text, read_object, true);
  } catch (const Error& error) { throw Error(fmt::format("{}: {}", path.string(), error.what())); }
}

std::string quoted_text(const std::string& text) {
  std::string quoted = json(text).dump(-1, ' ', false, json::error_handler_t::replace);
  std::replace(quoted.begin(), quoted.end(), '\x7f',
               '?');  // JSON allows this character, TOML does not
  return quoted;
}

std::array<double, 16> row_major(const Rigid3& transform) {
  std::array<double, 16> rows;
  Eigen::Map<RowMajor4>{rows.data()} = transform.matrix();
  return rows;
}

RigidRows rigid_of_rows(const std::vector<double>& numbers) {
  const Eigen::Matrix4d matrix = Eigen::Map<const RowMajor4>(numbers.data());
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const double skew = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  const bool last_row = (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < 1e-9;
  RigidRows rows{Rigid3::Identity(), skew, R.determinant(),
                 skew <= kSkew && R.determinant() >= 0 && last_row && matrix.allFinite()};
  rows.pose.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  rows.pose.translation() = matrix.topRightCorner<3, 1>();
  return rows;
}

}  // namespace palpable
