#include "palpable/bake/mesh/field_files.h"
#include "palpable/bake/mesh/field_text.h"
#include "palpable/common/base/text_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using namespace field_text;

// The numbers of a word that is several numbers of one digit before the point: "1.0E+00-2.0E+00".
// Where exponents have three digits, as CalculiX for Windows writes them, a positive number has no
// blank before it, "-5.28012E-0033.06745E-003"; the digit before the point is then its own. Empty
// for anything else.
std::vector<double> glued_numbers(std::string_view word) {
  std::vector<double> values;
  while (!word.empty()) {
    const std::size_t exponent = word.find_first_of("Ee");
    if (exponent == std::string_view::npos || exponent + 2 >= word.size()) return {};
    std::size_t end = std::min(word.find_first_not_of("0123456789", exponent + 2), word.size());
    if (end < word.size() && word[end] == '.') --end;
    const std::optional<double> value = to_any_number(word.substr(0, end));
    if (!value) return {};
    values.push_back(*value);
    word.remove_prefix(end);
  }
  return values;
}

// CalculiX' results as text. Records by their first columns: "    2C" nodes follow, " -4" a
// result's name, " -1" a node of it in (1X,"-1",I10,6E12.5), or I5 in the short form, " -2" its
// continuation, " -3" the end of a block.
class FrdReader {
 public:
  explicit FrdReader(const std::string& name) : name_(name) {}

  NodalFile read(const std::string& bytes) {
    for (const Line& line : lines_of(bytes)) read_line(line);
    if (file_.numbers.empty()) bad(name_, "has no nodes: not an ASCII .frd file");
    file_.points = as_columns(points_, 3);
    for (const std::string& title : order_) add_field(title);
    return std::move(file_);
  }

 private:
  struct Block {
    std::map<std::int64_t, std::vector<double>> at;
    std::size_t components = 0;
    std::size_t line = 0;
  };
  enum class Inside { kNothing, kNodes, kResult };

  void read_line(const Line& line) {
    const std::string_view text = line.text;
    const std::string_view key = text.substr(0, std::min<std::size_t>(text.size(), 3));
    if (text.starts_with("    2C") || text.starts_with("  100C")) read_form(line);
    if (text.starts_with("    2C")) {
      inside_ = Inside::kNodes;
    } else if (key == " -3" || text.starts_with("    3C") || text.starts_with("  100C")) {
      inside_ = Inside::kNothing;
    } else if (key == " -4") {
      result_ = std::string(first_word(text.substr(std::min<std::size_t>(text.size(), 3))));
      if (!blocks_.contains(result_)) order_.push_back(result_);
      blocks_[result_] = Block{{}, 0, line.number};  // a later step replaces an earlier one
      inside_ = Inside::kResult;
    } else if (key == " -5" && inside_ == Inside::kResult) {
      // Columns computed by readers (ALL, such as a vector's length) are not in the file.
      const std::vector<std::string_view> words = words_of(text, " \t");
      if (words.size() < 2 || words[1] != "ALL") ++blocks_[result_].components;
    } else if (inside_ != Inside::kNothing && (key == " -1" || key == " -2")) {
      read_values(line, key == " -1");
    }
  }

  // The last figure of a block's record: 0, the short form; 1, the long one; above, binary.
  void read_form(const Line& line) {
    constexpr std::size_t kForm = 73;
    if (line.text.size() <= kForm) return;
    const std::string_view form = first_word(line.text.substr(kForm, 2));
    if (form == "2" || form == "3") {
      bad(name_, fmt::format("line {}: binary; only ASCII .frd is read", line.number));
    }
    label_width_ = form == "0" ? 5 : 10;
  }

  // A node and its values, or their continuation.
  void read_values(const Line& line, bool begins) {
    const auto complain = [&](const std::string& what) {
      bad(name_, fmt::format("line {}: {}", line.number, what));
    };
    const auto field = [&](std::size_t begin, std::size_t width) {
      return begin < line.text.size() ? first_word(line.text.substr(begin, width))
                                      : std::string_view();
    };
    std::int64_t node = 0;
    if (begins) {
      const std::optional<double> label = to_any_number(field(3, label_width_));
      if (!label || *label < 1) complain("a node without its number (only ASCII .frd is read)");
      node = static_cast<std::int64_t>(*label);
    }
    std::vector<double> values;
    const std::size_t begin = std::min(3 + label_width_, line.text.size());
    for (const std::string_view word : words_of(line.text.substr(begin), " \t")) {
      const std::optional<double> value = to_any_number(word);
      const std::vector<double> found = value ? std::vector{*value} : glued_numbers(word);
      if (found.empty()) complain(fmt::format("'{}' is not a number", word));
      values.insert(values.end(), found.begin(), found.end());
    }
    if (inside_ == Inside::kNodes) {
      if (values.size() != 3) complain("a node does not have three coordinates");
      if (!row_.try_emplace(node, row_.size()).second) complain("a node that was there already");
      file_.numbers.push_back(node);
      points_.insert(points_.end(), values.begin(), values.end());
    } else if (begins) {
      blocks_[result_].at[node] = std::move(values);
    } else if (!blocks_[result_].at.empty()) {
      complain("results of more than six components are not read");
    }
  }

  void add_field(const std::string& title) {
    const Block& block = blocks_[title];
    const auto c = static_cast<Index>(block.components);
    if (c == 0) return;
    MatrixXd values(c, static_cast<Index>(file_.numbers.size()));
    for (std::size_t i = 0; i < file_.numbers.size(); ++i) {
      const auto at = block.at.find(file_.numbers[i]);
      if (at == block.at.end() || static_cast<Index>(at->second.size()) != c) {
        bad(name_, fmt::format("line {}: '{}' does not have {} values for node {}", block.line,
                               title, c, file_.numbers[i]));
      }
      values.col(static_cast<Index>(i)) = Eigen::Map<const Eigen::VectorXd>(at->second.data(), c);
    }
    file_.fields.push_back({title, std::move(values)});
  }

  const std::string& name_;
  NodalFile file_;
  std::map<std::int64_t, std::size_t> row_;
  std::vector<double> points_;
  std::map<std::string, Block> blocks_;
  std::vector<std::string> order_;
  Inside inside_ = Inside::kNothing;
  std::size_t label_width_ = 10;  // columns of a node's number
  std::string result_;
};

}  // namespace

NodalFile parse_frd(const std::string& bytes, const std::string& name) {
  return FrdReader(name).read(bytes);
}

}  // namespace palpable
