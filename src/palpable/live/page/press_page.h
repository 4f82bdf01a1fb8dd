/// @file
/// The page in which bodies are pressed (palpable export --to page): the bundle of web/page, which
/// web/page/build.mjs makes, with bodies.
///
/// A page for a server is a folder:
///
///     index.html      words, style, and the facts about the bodies as JSON
///     page.js         the script, a module
///     palpable.wasm   the core
///     NAME.palpweb    each body, fetched when it is chosen
///
/// A page that holds everything is index.html alone, with core and bodies as base64 and a classic
/// script: browsers neither fetch nor load modules from a disk (file://). The script comes before
/// the bodies: a browser runs it while it still reads them, and it shows the skin at rest.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/reduced/provenance.h"
#include "palpable/common/response/touchable_body.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {

/// The bundle without bodies.
struct PageBundle {
  std::string html;     ///< index.html, with kPageFacts and kPageScripts where these go
  std::string script;   ///< page.js, a module
  std::string classic;  ///< page-classic.js
  std::string core;     ///< palpable.wasm
  /// Name and content of what the page fetches to find hands in a webcam's picture
  /// (docs/webcam.md); empty where the bundle was built without it. Only pages of several files
  /// have them.
  std::vector<std::pair<std::string, std::string>> hands;
};

inline constexpr std::string_view kPageFacts = "/*palpable:page*/";
inline constexpr std::string_view kPageScripts = "<!-- palpable:scripts -->";

/// Largest total size of the bodies, bytes, at which a page is one file by default. As base64 they
/// are a third larger, and the browser holds them twice in memory while it loads. In exchange the
/// file opens from a disk and from a mail.
inline constexpr std::size_t kMostInline = 16'000'000;

/// Reads a bundle from the folder where it was built or installed.
/// @throws Error "FILE: REASON; HOW TO BUILD IT"
[[nodiscard]] PageBundle read_page_bundle(const std::filesystem::path& folder);

/// What a page must say about a shape that is not ours.
struct ShapeCredit {
  std::string text, url, terms;
};
/// The credit that the body's description states ([shape] credit). Bodies of before that key have
/// none: those of a file whose name holds "bunny" or "dragon" are Stanford's then. Nothing for
/// other shapes.
[[nodiscard]] std::optional<ShapeCredit> credit_of(const Provenance& provenance);

/// A body as a page has it.
struct PageBody {
  std::string name;   ///< for people
  std::string file;   ///< NAME.palpweb: letters, digits, '-' and '_'; in a page no two are the same
  std::string bytes;  ///< of the delivery file
  std::string material;
  double stress_top = 1;  ///< Pa, top of the colours' scale: stress_scale()
  std::optional<ShapeCredit> credit;
  /// The skin at rest, which the page shows while the body arrives; empty: it shows none.
  std::vector<float> vertices;           ///< m, x0 y0 z0 x1 ...
  std::vector<std::uint32_t> triangles;  ///< three vertices for each
};

/// @param body  settled, with tables of touch
/// @throws Error as web_file_bytes()
[[nodiscard]] PageBody page_body(const TouchableBody& body);
/// Makes the files' names differ: "bunny.palpweb", "bunny-2.palpweb".
void name_files_apart(std::span<PageBody> bodies);

/// The text of index.html. @param holds_all  with core, bodies and script in it
/// @throws Error if the bundle's index.html has not both marks
[[nodiscard]] std::string page_text(const PageBundle& bundle, std::span<const PageBody> bodies,
                                    bool holds_all);

/// The text of index.html for a running session, which a server of its own sends with page.js
/// (live_page/live_page.h). @param socket  where the page finds the session, relative to its own
/// address. @throws Error as page_text()
[[nodiscard]] std::string live_page_text(const PageBundle& bundle, std::string_view socket);

/// Writes a page into a folder, which is made if it is missing. index.html comes last, so that a
/// reader never finds one whose files are not there. @throws Error
void write_page(const std::filesystem::path& folder, const PageBundle& bundle,
                std::span<const PageBody> bodies, bool holds_all);

}  // namespace palpable
