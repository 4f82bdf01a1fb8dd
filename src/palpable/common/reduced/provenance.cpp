#include "palpable/common/reduced/provenance.h"

#include "palpable/common/base/text_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace palpable {
namespace {

struct TextMember {
  std::string_view key;
  std::string Provenance::*text;
};

// All texts, in the order in which they are shown.
constexpr TextMember kTexts[] = {
    {"description", &Provenance::description},
    {"mesh_source", &Provenance::mesh_source},
    {"credit", &Provenance::credit},
    {"credit_url", &Provenance::credit_url},
    {"terms", &Provenance::terms},
    {"mesh", &Provenance::mesh},
    {"material", &Provenance::material},
    {"support", &Provenance::support},
    {"preload", &Provenance::preload},
    {"loads", &Provenance::loads},
    {"snapshots", &Provenance::snapshots},
    {"solver", &Provenance::solver},
    {"series", &Provenance::series},
    {"reduction", &Provenance::reduction},
    {"displacement", &Provenance::displacement},
    {"stress", &Provenance::stress},
    {"several_loads", &Provenance::several_loads},
    {"between_sites", &Provenance::between_sites},
    {"modes", &Provenance::modes},
    {"errors", &Provenance::errors},
    {"touch", &Provenance::touch},
    {"program", &Provenance::program},
    {"command_line", &Provenance::command_line},
    {"held_out", &Provenance::held_out},
};

struct StageName {
  BodyStage stage;
  std::string_view key;  // in files
  std::string_view missing;
};

constexpr StageName kStages[] = {
    {BodyStage::kReduced, "reduced", "it is touched at its sites only: its tables are missing"},
    {BodyStage::kLinear, "linear", "only small touches are right: further tables are missing"},
    {BodyStage::kTables, "tables", "all tables are there, but their error was not measured yet"},
};
constexpr std::string_view kStage = "stage";  // the key

// Null for kFinished.
const StageName* name_of(BodyStage stage) {
  const auto* found = std::find_if(std::begin(kStages), std::end(kStages),
                                   [&](const StageName& s) { return s.stage == stage; });
  return found != std::end(kStages) ? found : nullptr;
}

// How a line of held_out_values begins, before the parameter.
constexpr std::string_view kHeldOutAt = "held out, ";

// The key of a line for people: "mesh source".
std::string label_of(std::string_view key) {
  std::string label(key);
  std::replace(label.begin(), label.end(), '_', ' ');
  return label;
}

const TextMember* member_labelled(std::string_view label) {
  const auto* found = std::find_if(std::begin(kTexts), std::end(kTexts),
                                   [&](const TextMember& m) { return label_of(m.key) == label; });
  return found != std::end(kTexts) ? found : nullptr;
}

// "held out, stiffness = 1.5"; nothing if the key is another one.
std::optional<Provenance::HeldOutValue> held_out_value(std::string_view key,
                                                       const std::string& errors) {
  constexpr std::string_view kIs = " = ";
  const std::size_t is = key.rfind(kIs);
  if (!key.starts_with(kHeldOutAt) || is == std::string_view::npos || is < kHeldOutAt.size()) {
    return {};
  }
  const std::optional<double> value = to_number(key.substr(is + kIs.size()));
  if (!value) return {};
  return Provenance::HeldOutValue{
      std::string(key.substr(kHeldOutAt.size(), is - kHeldOutAt.size())), *value, errors};
}

// Stores a line of an older file whose key is not that of a text in kTexts: an old name of such a
// text, a value that has to be parsed, or a line that has no member.
void add_line(const std::string& key, const std::string& text, Provenance& result) {
  if (key == "body") {  // an intrusive bake's
    result.description = text;
  } else if (auto value = held_out_value(key, text)) {
    result.held_out_values.push_back(std::move(*value));
  } else if (const auto factor = to_number(text); factor && key == "scaled by") {
    result.scaled_by = factor;
  } else {
    result.others.emplace_back(key, text);
  }
}

// Sets a member that is not a text: numbers, held_out_values, others.
void set_member(std::string_view key, const Json& value, Provenance& result) {
  if (key == kStage) result.stage = stage_of_key(value.get<std::string>());
  if (key == "preload_moves") result.preload_moves = value.get<double>();
  if (key == "scaled_by") result.scaled_by = value.get<double>();
  if (key == "sites_reached") {
    const double count = value.get<double>();
    if (!(count >= 0 && count <= std::numeric_limits<int>::max())) throw Error("no count");
    result.sites_reached = static_cast<int>(count);
  }
  if (key == "held_out_values") {
    for (const Json& at : value) {
      result.held_out_values.push_back({at["parameter"].get<std::string>(),
                                        at["value"].get<double>(),
                                        at["errors"].get<std::string>()});
    }
  }
  if (key == "others") {
    for (const Json& line : value) {
      result.others.emplace_back(line[0].get<std::string>(), line[1].get<std::string>());
    }
  }
}

}  // namespace

std::string_view key_of(BodyStage stage) {
  const StageName* named = name_of(stage);
  return named != nullptr ? named->key : std::string_view();
}

BodyStage stage_of_key(std::string_view key) {
  const auto* found = std::find_if(std::begin(kStages), std::end(kStages),
                                   [&](const StageName& s) { return s.key == key; });
  return found != std::end(kStages) ? found->stage : BodyStage::kFinished;
}

std::string_view missing_at(BodyStage stage) {
  const StageName* named = name_of(stage);
  return named != nullptr ? named->missing : std::string_view();
}

std::vector<std::pair<std::string, std::string>> lines_of(const Provenance& provenance) {
  std::vector<std::pair<std::string, std::string>> lines;
  for (const auto& [key, member] : kTexts) {
    std::string text = provenance.*member;
    if (text.empty()) continue;
    if (member == &Provenance::preload && provenance.preload_moves) {
      text += fmt::format(
          ": nodes move by up to {:.4g} m. The surface is that of the body so loaded; displacement "
          "and stress are what a press adds",
          *provenance.preload_moves);
    }
    if (member == &Provenance::loads && provenance.sites_reached) {
      text += fmt::format("; {} sites reach it", *provenance.sites_reached);
    }
    lines.emplace_back(label_of(key), std::move(text));
  }
  for (const auto& [parameter, value, errors] : provenance.held_out_values) {
    lines.emplace_back(fmt::format("{}{} = {}", kHeldOutAt, parameter, number_text(value)), errors);
  }
  if (provenance.stage != BodyStage::kFinished) {
    lines.emplace_back(kStage,
                       fmt::format("the bake has not ended: {}", missing_at(provenance.stage)));
  }
  if (provenance.scaled_by)
    lines.emplace_back("scaled by", fmt::format("{}", *provenance.scaled_by));
  lines.insert(lines.end(), provenance.others.begin(), provenance.others.end());
  return lines;
}

Json json_of(const Provenance& provenance) {
  Json result = Json::object();
  for (const auto& [key, member] : kTexts) {
    const std::string& text = provenance.*member;
    if (!text.empty()) result[key] = text;
  }
  if (provenance.stage != BodyStage::kFinished) result[kStage] = key_of(provenance.stage);
  if (provenance.preload_moves) result["preload_moves"] = *provenance.preload_moves;
  if (provenance.sites_reached) result["sites_reached"] = *provenance.sites_reached;
  for (const auto& [parameter, value, errors] : provenance.held_out_values) {
    result["held_out_values"].push_back(
        {{"parameter", parameter}, {"value", value}, {"errors", errors}});
  }
  if (provenance.scaled_by) result["scaled_by"] = *provenance.scaled_by;
  for (const auto& [key, text] : provenance.others) {
    result["others"].push_back(Json::array({key, text}));
  }
  return result;
}

Result<Provenance> provenance_of_json(std::string_view text) {
  try {
    const Json json = value_or_throw(Json::parse(text));
    Provenance result;
    for (const auto& [key, value] : json.items()) {
      const auto* member = std::find_if(std::begin(kTexts), std::end(kTexts),
                                        [&key = key](const TextMember& m) { return m.key == key; });
      if (member != std::end(kTexts)) {
        result.*member->text = value.get<std::string>();
      } else {
        set_member(key, value, result);
      }
    }
    return result;
  } catch (const Error&) { return Problem{"the provenance is damaged"}; }
}

Provenance provenance_of_lines(const std::vector<std::pair<std::string, std::string>>& lines) {
  Provenance result;
  for (const auto& [key, text] : lines) {
    if (const TextMember* member = member_labelled(key); member != nullptr && !text.empty()) {
      result.*member->text = text;
    } else {
      add_line(key, text, result);
    }
  }
  return result;
}

}  // namespace palpable
