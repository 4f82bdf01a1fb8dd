#include "palpable/desk/clip_files/json_lines.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/text_file.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>

namespace palpable {
namespace {

using nlohmann::json;

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

}  // namespace

bool JsonObject::has(const char* key) const { return object_.contains(key); }

int JsonObject::frame() const { return frame_number(object_.at("frame")); }

int JsonObject::frame_after(int last) const {
  const int number = frame();
  if (number <= last) throw Error(fmt::format("frame {} comes after frame {}", number, last));
  return number;
}

bool JsonObject::flag(const char* key) const { return object_.at(key).get<bool>(); }

bool JsonObject::flag_or(const char* key, bool fallback) const {
  return object_.value(key, fallback);
}

std::string JsonObject::text(const char* key) const { return object_.at(key).get<std::string>(); }

int JsonObject::whole(const char* key) const {
  const json& value = object_.at(key);
  if (!value.is_number_integer()) throw Error(fmt::format("{} is no whole number", key));
  return value.get<int>();
}

int JsonObject::whole_or(const char* key, int fallback) const {
  return object_.value(key, fallback);
}

double JsonObject::number(const char* key) const { return object_.at(key).get<double>(); }

std::optional<double> JsonObject::number_if_any(const char* key) const {
  const auto found = object_.find(key);
  if (found == object_.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

std::vector<double> JsonObject::numbers(const char* key, std::size_t count) const {
  return first_numbers(object_.at(key), key, count);
}

std::optional<std::vector<double>> JsonObject::numbers_if_any(const char* key,
                                                              std::size_t count) const {
  const auto found = object_.find(key);
  if (found == object_.end() || !found->is_array() || found->size() < count) return std::nullopt;
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(*found)[i].is_number()) return std::nullopt;
    numbers.push_back((*found)[i].get<double>());
  }
  return numbers;
}

std::vector<std::vector<double>> JsonObject::rows(const char* key, std::size_t count) const {
  std::vector<std::vector<double>> rows;
  for (const json& row : object_.at(key)) {
    rows.push_back(first_numbers(row, fmt::format("an entry of {}", key), count));
  }
  return rows;
}

void JsonObject::for_each_in(const char* key,
                             const std::function<void(const JsonObject&)>& read_entry) const {
  const json& list = object_.at(key);
  if (!list.is_array()) throw Error(fmt::format("{} is no list", key));
  for (const json& entry : list) {
    if (!entry.is_object()) throw Error(fmt::format("an entry of {} is no object", key));
    read_entry(JsonObject(entry));
  }
}

Rigid3 JsonObject::rigid(const char* key) const {
  const std::vector<double> n = numbers(key, 16);
  const Eigen::Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(n.data());
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const double skew = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  const bool last_row = matrix.row(3) == Eigen::RowVector4d(0, 0, 0, 1);
  if (!(skew <= kSkew) || R.determinant() < 0 || !last_row || !matrix.allFinite()) {
    throw Error(fmt::format("the 16 numbers of {} are no rigid motion, row by row", key));
  }
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return pose;
}

void for_each_object(const std::filesystem::path& path,
                     const std::function<void(const JsonObject&)>& read_object) {
  for_each_line(path, [&](const std::string& line) {
    if (const auto unparsable = why_not_parsed(line, Notation::kJson)) {
      throw Error(unparsable->what);
    }
    try {
      const json object = json::parse(line);
      read_object(JsonObject(object));
    } catch (const json::parse_error& error) {
      throw Error(fmt::format("no JSON at character {}", error.byte));
    } catch (const json::exception& error) { throw Error(without_brackets(error.what())); }
  });
}

bool is_of_another(const JsonObject& line, const std::string& body) {
  return line.has("body") && line.text("body") != body;
}

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

std::string without_brackets(const std::string& message) {
  const auto end = message.find("] ");
  return end == std::string::npos ? message : message.substr(end + 2);
}

std::string quoted_text(const std::string& text) {
  std::string quoted = json(text).dump(-1, ' ', false, json::error_handler_t::replace);
  std::replace(quoted.begin(), quoted.end(), '\x7f',
               '?');  // JSON allows this character, TOML does not
  return quoted;
}

std::string rows_text(const Rigid3& transform, int digits) {
  std::string text = "[";
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      text += fmt::format("{}{:.{}g}", row + column > 0 ? "," : "", transform.matrix()(row, column),
                          digits);
    }
  }
  return text + "]";
}

}  // namespace palpable
