#include "palpable/live/page/press_page.h"

#include "palpable/common/base/base64.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/whole_file.h"
#include "palpable/common/web_file/web_file.h"
#include "palpable/live/view/stress_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <system_error>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestPart = 50'000'000;  // bytes; a bundle has some 2 MB
constexpr std::string_view kHowToBuild =
    "in the source folder, web/build.sh and then web/page/build.sh build it";

std::string read_part(const fs::path& file) {
  auto read = read_whole_file(file, {.most = kLargestPart});
  if (!read.ok()) {
    throw Error(fmt::format("{}: {}; {}", file.string(), read.problem().message, kHowToBuild));
  }
  return std::move(read).value();
}

std::string file_name_of(std::string_view name) {
  std::string file;
  for (const char c : name) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
    file += is_plain && static_cast<unsigned char>(c) < 128 ? c : '-';
  }
  return file.empty() ? "body" : file;
}

// As base64, in the byte order of this machine: little-endian, as the page reads it.
template <typename Number>
std::string base64_of(const std::vector<Number>& numbers) {
  return base64({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)});
}

Json facts_of(const PageBody& body) {
  Json facts{{"name", body.name},
             {"file", body.file},
             {"bytes", body.bytes.size()},
             {"material", body.material},
             {"stressTop", body.stress_top}};
  if (body.credit) {
    facts["credit"] = {
        {"text", body.credit->text}, {"url", body.credit->url}, {"terms", body.credit->terms}};
  }
  if (!body.vertices.empty()) {
    facts["skin"] = {{"vertices", base64_of(body.vertices)},
                     {"triangles", base64_of(body.triangles)}};
  }
  return facts;
}

// JSON within <script>: "</script>" in a name would end it.
std::string safe_in_html(const std::string& json) {
  std::string text;
  for (const char c : json) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

std::string base64_element(std::string_view id, std::string_view bytes) {
  return fmt::format("<script type=\"application/octet-stream\" id=\"{}\">{}</script>\n", id,
                     base64(bytes));
}

void replace_mark(std::string& html, std::string_view mark, std::string_view text) {
  const std::size_t at = html.find(mark);
  if (at == std::string::npos) {
    throw Error(fmt::format("the page's bundle lacks {}; {}", mark, kHowToBuild));
  }
  html.replace(at, mark.size(), text);
}

constexpr const char* kHands = "hands";  // as web/page/hand_finder.js has it

constexpr std::string_view kModuleScript = "<script type=\"module\" src=\"page.js\"></script>";

// The later mark first: a body's name may hold the other one.
std::string filled(std::string html, std::string_view scripts, const Json& facts) {
  replace_mark(html, kPageScripts, scripts);
  replace_mark(html, kPageFacts, safe_in_html(facts.dump()));
  return html;
}

}  // namespace

PageBundle read_page_bundle(const fs::path& folder) {
  PageBundle bundle{.html = read_part(folder / "index.html"),
                    .script = read_part(folder / "page.js"),
                    .classic = read_part(folder / "page-classic.js"),
                    .core = read_part(folder / "palpable.wasm"),
                    .hands = {}};
  std::error_code error;  // without them the page says what is missing
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / kHands, error)) {
    bundle.hands.emplace_back(entry.path().filename().string(), read_part(entry.path()));
  }
  return bundle;
}

std::optional<ShapeCredit> credit_of(const Provenance& provenance) {
  if (!provenance.credit.empty()) {
    // The address becomes a link, and a body file may come from anybody.
    const std::string& url = provenance.credit_url;
    const bool is_web = url.starts_with("https://") || url.starts_with("http://");
    return ShapeCredit{provenance.credit, is_web ? url : "",
                       provenance.terms.empty() ? "" : fmt::format("({})", provenance.terms)};
  }
  constexpr std::array<std::string_view, 2> kStanford{"bunny", "dragon"};
  const bool is_stanfords =
      std::any_of(kStanford.begin(), kStanford.end(), [&](std::string_view name) {
        return provenance.mesh_source.find(name) != std::string::npos;
      });
  if (!is_stanfords) return std::nullopt;
  return ShapeCredit{"Shape: Stanford Computer Graphics Laboratory",
                     "https://graphics.stanford.edu/data/3Dscanrep/",
                     "(research use, free to pass on with credit, not commercial)"};
}

PageBody page_body(const TouchableBody& body) {
  const ReducedBody& reduced = body.body;
  PageBody result{.name = reduced.name,
                  .file = file_name_of(reduced.name) + std::string(kWebFileEnding),
                  .bytes = web_file_bytes(body),
                  .material = reduced.material,
                  .stress_top = stress_scale(reduced),
                  .credit = credit_of(reduced.provenance),
                  .vertices = {},
                  .triangles = {}};
  for (const double x : reduced.surface.vertices.reshaped()) {
    result.vertices.push_back(static_cast<float>(x));
  }
  for (const int vertex : reduced.surface.triangles.reshaped()) {
    result.triangles.push_back(static_cast<std::uint32_t>(vertex));
  }
  return result;
}

void name_files_apart(std::span<PageBody> bodies) {
  std::set<std::string> taken;
  for (PageBody& body : bodies) {
    const std::string stem = fs::path(body.file).stem().string();
    for (int k = 2; !taken.insert(body.file).second; ++k) {
      body.file = fmt::format("{}-{}{}", stem, k, kWebFileEnding);
    }
  }
}

std::string page_text(const PageBundle& bundle, std::span<const PageBody> bodies, bool holds_all) {
  Json facts{{"inline", holds_all}, {"bodies", Json::array()}};
  for (const PageBody& body : bodies) facts["bodies"].push_back(facts_of(body));
  std::string scripts;
  if (holds_all) {
    scripts += base64_element("palpable.wasm", bundle.core);
    // esbuild writes "</script" in a script as "<\/script".
    scripts += fmt::format("<script>{}</script>\n", bundle.classic);
    for (const PageBody& body : bodies) scripts += base64_element(body.file, body.bytes);
  } else {
    scripts += kModuleScript;
  }
  return filled(bundle.html, scripts, facts);
}

std::string live_page_text(const PageBundle& bundle, std::string_view socket) {
  Json facts = Json::object();
  facts["live"] = Json(socket);
  return filled(bundle.html, kModuleScript, facts);
}

void write_page(const fs::path& folder, const PageBundle& bundle, std::span<const PageBody> bodies,
                bool holds_all) {
  const std::string html = page_text(bundle, bodies, holds_all);
  make_folder(folder);
  if (!holds_all) {
    write_whole_file(folder / "palpable.wasm", bundle.core);
    write_whole_file(folder / "page.js", bundle.script);
    for (const PageBody& body : bodies) write_whole_file(folder / body.file, body.bytes);
    if (!bundle.hands.empty()) make_folder(folder / kHands);
    for (const auto& [name, content] : bundle.hands) {
      write_whole_file(folder / kHands / name, content);
    }
  }
  write_whole_file(folder / "index.html", html);
}

}  // namespace palpable
