// The page that compares the paper's figures with ours: pictures, tables, films and the commands that
// made them. Its files are in the folder of the page.
"use strict";

function numbers(rows) {
  const head = make("tr", {}, ...["", "paper", "here", ""].map((text) => make("th", {}, text)));
  const body = make("tbody", {});
  for (const [what, paper, here, remark] of rows) {
    body.append(make("tr", {}, make("td", {}, what), make("td", {}, paper), make("td", {}, here), make("td", { class: "dim" }, remark)));
  }
  return make("div", { class: "scroll" }, make("table", { class: "sides" }, make("thead", {}, head), body));
}

function links(files) {
  const list = make("p", { class: "note" });
  for (const file of files) list.append(make("a", { href: file }, file), " ");
  return list;
}

function paperFigure(figure) {
  const pictures = make("div", { class: "shots" });
  for (const picture of figure.pictures) {
    pictures.append(make("figure", { class: "card" }, make("a", { href: picture.file }, make("img", { src: picture.file, alt: picture.caption, loading: "lazy" })), make("figcaption", {}, picture.caption)));
  }
  const place = make("section", { id: `figure-${figure.number}` },
    make("h2", {}, `Figure ${figure.number}: ${figure.title}`),
    make("p", {}, make("strong", {}, "The paper: "), figure.paper),
    make("p", {}, make("strong", {}, "Here: "), figure.differs), pictures);
  if (figure.films.length) {
    const films = make("div", { class: "shots films" });
    for (const film of figure.films) films.append(make("figure", { class: "card" }, make("video", { src: film, controls: "", preload: "metadata" }), make("figcaption", {}, film)));
    place.append(films);
  }
  if (figure.tables.length) place.append(links(figure.tables));
  place.append(make("pre", { class: "commands" }, figure.commands.join("\n")));
  return place;
}

byId("numbers").append(numbers(DATA.numbers));
const contents = make("p", { class: "note" }, "Figures: ");
for (const figure of DATA.figures) contents.append(make("a", { href: `#figure-${figure.number}` }, figure.number), " ");
byId("paper").append(contents, ...DATA.figures.map(paperFigure));
byId("provenance").append(facts(DATA.provenance));
