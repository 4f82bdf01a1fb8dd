"""Tables of the films that tools/run_benchmark.py scores, for tools/write_results.py; errors pooled over films.

An entry is one film: its key is the sequence, or "press/4711" for one of several seeds. Targets are those of
src/palpable/desk/scorecard/figures.cpp, where `palpable score` has them.
"""
import re
import statistics
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# The sequences over which errors relative to the full-order solution are pooled: those with a touch, except thin things,
# darkness, and a desk without texture.
POOLED = ("press", "cup", "slide", "palm", "two-hands", "squeeze", "rest", "press-axial", "press-behind")
# Those over which the errors of touches that the camera does not see are pooled.
POOLED_UNSEEN = (*POOLED, "cup-turn")
ERRORS = ("displacement_error", "max_vertex_error_mm", "von_mises_error", "force_error")
DISTANCES = ("0.2", "0.3", "0.5", "1", "2", "5", "10", "15")
HARD = ("dark", "textureless")  # left out of medians of depth, shown beside them

# Figures with a target: name and unit. Shares without a unit stay shares.
NAMES = {
    "touch_recall_3mm": ("recall of touches deeper than 3 mm", "%"),
    "touch_false_discovery_5mm": ("touches reported more than 5 mm beside the body", "%"),
    "penetration_median_mm": ("penetration, median", "mm"),
    "penetration_p99_mm": ("penetration, 99th percentile", "mm"),
    "largest_jump_mm": ("largest jump of the skin", "mm"),
    "displacement_error.median": ("displacement, median", "%"),
    "displacement_error.p90": ("displacement, 90th percentile", "%"),
    "max_vertex_error_mm.median": ("worst vertex, median", "mm"),
    "max_vertex_error_mm.p90": ("worst vertex, 90th percentile", "mm"),
    "force_error.median": ("force, median", "%"),
    "force_error.p90": ("force, 90th percentile", "%"),
    "excess_indentation_mm.p99": ("excess indentation, 99th percentile", "mm"),
    "occlusion_iou": ("visible body, IoU", ""),
    "occlusion_iou_where_hidden": ("visible body, IoU where a part is hidden", ""),
    "edge_error_crossing_px": ("edge of a hand before the body", "px"),
    "flicker": ("flicker", "%"),
    "hand_within_1pct": ("depth of near hands within 1 %", "%"),
    "too_close_called_far": ("too close, but reported as far", "%"),
    "jitter_mm": ("jitter of the camera", "mm"),
    "ate_mm": ("path of the camera (ATE)", "mm"),
}


def sequence_of(key):
    """The sequence of an entry: keys are "press", or "press/4711" for one of several seeds."""
    return key.partition("/")[0]


def errors_by_frame(entry, unseen=False):
    """Errors of each counted frame: of touches that a camera sees, or of those that it does not see. Older scores lack the latter."""
    scores = entry["scores"]
    return ((scores.get("unseen") or {}) if unseen else scores).get("errors_by_frame") or []


def pooled(scored, names, unseen=False):
    """Median and p90 of each error, as in palpable score, over all frames of the sequences; None without any."""
    films = {key: errors_by_frame(entry, unseen) for key, entry in scored.items() if sequence_of(key) in names}
    frames = [frame for film in films.values() for frame in film]
    frames = [frame for frame in frames if all(frame[key] is not None for key in ERRORS)]
    if len(frames) < 2:
        return None
    of = {key: [frame[key] for frame in frames] for key in ERRORS}
    return {"frames": len(frames), "seeds": sum(1 for film in films.values() if film),
            **{key: {"median": statistics.median(values),
                     "p90": statistics.quantiles(values, n=10, method="inclusive")[-1]} for key, values in of.items()}}


def pools(entries):
    """{what: pooled errors} of each touched sequence and of all of POOLED; "..., unseen": of touches that the camera does not see."""
    scored = {name: entry for name, entry in entries.items() if "scores" in entry}
    groups = {name: [name] for name in dict.fromkeys(map(sequence_of, scored))}
    unseen = {f"{name}, unseen": [name] for name in groups} | {"pooled, unseen": POOLED_UNSEEN}
    groups |= {"pooled": POOLED, "pooled without squeeze": [name for name in POOLED if name != "squeeze"],
               "pooled without squeeze, palm, axial": [name for name in POOLED if name not in ("squeeze", "palm", "press-axial")]}
    found = {what: pooled(scored, names) for what, names in groups.items()}
    found |= {what: pooled(scored, names, unseen=True) for what, names in unseen.items()}
    return {what: errors for what, errors in found.items() if errors}


def is_older(entry):
    """Whether a program measured it that touched bodies at their sites only, one at a time."""
    return "frames_touch_unseen" not in entry["scores"]


def marked(name, entry):
    return f"{name} †" if is_older(entry) else name


def number(value, unit="", factor=1):
    """Three significant digits and a unit."""
    if value is None:
        return None
    return f"{float(f'{factor * value:.3g}'):g}{unit and ' ' + unit}"


def percent(value):
    return number(value, "%", 100)


def both(value, unit="", factor=1):
    """[median, high percentile] of a figure that has both."""
    return [number(value.get(key), unit, factor) for key in list(value)[:2]] if value else [None, None]


def value_of(scores, figure):
    name, _, part = figure.partition(".")
    value = scores.get(name)
    if part == "p99" and value and "p99" not in value:
        return None
    return value.get(part) if part and value else value


def targets():
    """(figure, whether it is a lower bound, value, film or "" for all or "usual"), and the films that are not usual."""
    source = (ROOT / "src/palpable/desk/scorecard/figures.cpp").read_text()
    unusual = re.findall(r'"([\w-]+)"', re.search(r"kUnusualFilms\{(.*?)\}", source, re.DOTALL)[1])
    rows = re.findall(r'^    {"([a-z0-9_.]+)", k(AtMost|AtLeast), ([0-9.]+), (\S+)}', source, re.MULTILINE)
    kind = {"kEveryFilm": "", "kUsualFilms": "usual"}
    return [(figure, bound == "AtLeast", float(value), kind.get(film, film.strip('"'))) for figure, bound, value, film in rows], unusual


def target_rows(scored):
    """One row for each target: how many films meet it, and the film in the middle and the worst one."""
    stated, unusual = targets()
    for figure, at_least, target, film in stated:
        if figure not in NAMES:
            continue
        names = {key: entry for key, entry in scored.items()
                 if film in ("", sequence_of(key)) or (film == "usual" and sequence_of(key) not in unusual)}
        if film in ("", "usual"):  # what older programs measured of touches is not comparable
            names = {key: entry for key, entry in names.items() if not is_older(entry)}
        values = {marked(f"`{key}`", entry): value_of(entry["scores"], figure) for key, entry in names.items()}
        values = sorted(((value, key) for key, value in values.items() if value is not None), reverse=at_least)
        if not values:
            continue
        what, unit = NAMES[figure]
        factor = 100 if unit == "%" else 1
        met = sum(value >= target if at_least else value <= target for value, _ in values)
        yield [what, f"at {'least' if at_least else 'most'} {number(target, unit, factor)}", f"{met} of {len(values)}",
               number(statistics.median(value for value, _ in values), unit, factor) if len(values) > 2 else None,
               f"{number(values[-1][0], unit, factor)}, {values[-1][1]}"]


def pooled_table(entries, each=False):
    """The errors pooled over films. each: also those of each sequence, of which there are several films."""
    names = {"pooled without squeeze": "pooled without `squeeze`", "pooled": "pooled", "squeeze": "`squeeze`",
             "pencil": "`pencil` (not pooled: thin)", "demo": "`demo` (not pooled: mostly unseen)", "pooled, unseen": "pooled, unseen"}
    found = pools(entries)
    if each:
        names = {"pooled without squeeze, palm, axial": "pooled without `squeeze`, `palm`, `press-axial`", **names}
        sequences = [name for name in found if name not in names]
        names |= {name: f"`{name}`" for name in sequences if not name.endswith(", unseen")}
        names |= {name: f"`{name.removesuffix(', unseen')}`, unseen" for name in sequences if name.endswith(", unseen")}
    return {"columns": ["sequences", "films", "frames", "displacement, median", "90th percentile", "worst vertex, median",
                        "90th percentile", "von Mises, median", "90th percentile", "force, median", "90th percentile"],
            "rows": [[shown, found[name]["seeds"], found[name]["frames"], *both(found[name]["displacement_error"], "%", 100),
                      *both(found[name]["max_vertex_error_mm"], "mm"), *both(found[name]["von_mises_error"], "%", 100),
                      *both(found[name]["force_error"], "%", 100)] for name, shown in names.items() if name in found]}


def not_scored(entries):
    rows = [[name, entry["refused"]] for name, entry in entries.items() if "refused" in entry]
    if rows:
        yield {"text": "Not scored:", "columns": ["film", "why"], "rows": rows}


def origins(entries):
    """Where and when each entry was measured."""
    found = {}
    for name, entry in entries.items():
        found.setdefault((entry.get("date"), entry.get("machine"), entry.get("commit")), []).append(name)
    return {"folded": "Where and when each film was measured", "columns": ["date", "machine", "commit", "films"],
            "rows": [[*origin, ", ".join(names)] for origin, names in sorted(found.items(), key=str)]}


def error_rows(scored):
    for key, entry in scored.items():
        s = entry["scores"]
        if any(s.get(f"reference_frames{kind}") for kind in ("", "_shallow", "_unseen")):
            yield [key, s["reference_frames"], *both(s["displacement_error"], "%", 100), *both(s["max_vertex_error_mm"], "mm"),
                   *both(s["von_mises_error"], "%", 100), *both(s["force_error"], "%", 100),
                   *both(s["excess_indentation_mm"], "mm"), s.get("reference_frames_unseen"),
                   number((s.get("max_vertex_error_mm_unseen") or {}).get("median"), "mm")]


def unseen_tables(scored):
    """The table of touches that the camera does not see, if any were scored."""
    rows = []
    for key, entry in scored.items():
        unseen = entry["scores"].get("unseen")
        if unseen and unseen["frames"]:
            rows.append([key, unseen["frames"], *both(unseen["displacement_error"], "%", 100), *both(unseen["max_vertex_error_mm"], "mm"),
                         *both(unseen["von_mises_error"], "%", 100), *both(unseen["force_error"], "%", 100)])
    if rows:
        yield {"folded": "Touches that the camera does not see, each film",
               "text": "The rows `..., unseen` above pool these frames: the hand is at least 4 mm deep, and the camera sees less than half of the "
                       "contact. The other rows leave them out.",
               "columns": ERROR_COLUMNS[:10], "rows": rows}


def touch_rows(scored):
    for key, entry in scored.items():
        s = entry["scores"]
        if s["frames_touching"]:
            yield [key, s["frames_touching"], s.get("frames_touch_unseen"), percent(s["touch_precision"]), percent(s["touch_recall"]),
                   percent(s["touch_recall_3mm"]), percent(s["touch_false_discovery_5mm"]), s["first_touch_delay_frames"],
                   s["penetration_median_mm"], s["penetration_p99_mm"], s["largest_jump_mm"]]


def occlusion_rows(scored):
    for key, entry in scored.items():
        s = entry["scores"]
        if s["occlusion_iou"] is not None:
            yield [key, s["occlusion_iou"], s["occlusion_iou_where_hidden"], s["crossing_frames"],
                   s["edge_error_crossing_px"] if s["crossing_frames"] else None, percent(s["flicker"])]


def camera_rows(scored):
    for key, entry in scored.items():
        s = entry["scores"]
        stands = s["ate_mm"] == 0  # the pose of the first frame is kept, which is the true one
        yield [marked(key, entry), *([None] * 3 if stands else [s["ate_mm"], s["rpe_mm"], s["jitter_mm"]]), s["moving_iou"],
               percent(s["moving_recall"]), percent(s["moving_false_positives"]), s["row_error_px"]]


def distances(entry, key):
    values = entry["scores"].get(key) or {}
    return [values.get(distance) for distance in DISTANCES]


def depth_summary(scored):
    usual = [entry for key, entry in scored.items() if sequence_of(key) not in HARD]

    def middle(key):
        columns = zip(*(distances(entry, key) for entry in usual))
        found = [[value for value in column if value is not None] for column in columns]
        return [percent(statistics.median(column)) if column else None for column in found]

    for name, key in (("median error", "depth_error_median"), ("pixels within 1 %", "depth_within_1pct")):
        yield [f"{name}: median of {len(usual)} films", *middle(key)]
        for film in HARD:
            for entry in [entry for one, entry in scored.items() if sequence_of(one) == film][:1]:
                yield [f"{name}: `{film}`", *map(percent, distances(entry, key))]


ERROR_COLUMNS = ["film", "frames", "displacement, median", "90th percentile", "worst vertex, median", "90th percentile",
                 "von Mises, median", "90th percentile", "force, median", "90th percentile", "excess indentation, median",
                 "99th percentile", "unseen frames", "worst vertex in those, median"]
TARGET_COLUMNS = ["figure", "target", "films that meet it", "median film", "worst film"]
TOUCH_COLUMNS = ["film", "frames with touch", "of these seen by no camera", "precision", "recall", "recall deeper than 3 mm",
                 "false beyond 5 mm", "delay (frames)", "penetration, median (mm)", "99th percentile (mm)", "largest jump (mm)"]
OCCLUSION_COLUMNS = ["film", "IoU", "IoU where hidden", "frames with a hand across the outline", "edge error in those (px)", "flicker"]


def none_seen(scored):
    names = [f"`{key}`" for key, entry in scored.items() if sequence_of(key) in POOLED and not entry["scores"]["reference_frames"]]
    return f" Of {' and '.join(names)} a camera sees too little: no frame is left." if names else ""


def held_out_tables(entries):
    """The tables of films with held-out seeds: only what a touch is scored for."""
    scored = {key: entry for key, entry in entries.items() if "scores" in entry}
    yield {"heading": "Errors relative to the full-order solution, held-out seeds", **pooled_table(entries, each=True)}
    yield {"folded": "Each film", "columns": ERROR_COLUMNS, "rows": list(error_rows(scored))}
    yield from unseen_tables(scored)
    yield {"heading": "Targets, held-out seeds", "columns": TARGET_COLUMNS, "rows": list(target_rows(scored))}
    yield {"folded": "Touch, each film", "columns": TOUCH_COLUMNS, "rows": list(touch_rows(scored))}
    yield from not_scored(entries)
    yield origins(entries)


def tables(entries, real):
    """All tables of the films, as tools/write_results.py takes them."""
    scored = {key: entry for key, entry in entries.items() if "scores" in entry}
    present = {key: entry for key, entry in scored.items() if not is_older(entry)}
    older = {key: entry for key, entry in scored.items() if is_older(entry)}
    touched_older = [key for key, entry in older.items() if entry["scores"]["frames_touching"]]
    yield {"heading": "Errors relative to the full-order solution",
           "text": "The reference is `palpable truth`: finite elements on the same mesh, without friction, pressed by the true hand. The "
                   "scores cover frames in which the hand is at least 4 mm deep and a camera sees at least half of the contact. Errors of "
                   "displacement and stress are relative to the norm of the true field, those of force to the true force. Pooled are "
                   f"the frames of {', '.join(f'`{name}`' for name in POOLED)}.{none_seen(present)}",
           **pooled_table(entries)}
    yield {"folded": f"Each of the {len(list(error_rows(present)))} films with a touch", "columns": ERROR_COLUMNS,
           "rows": list(error_rows(present))}
    yield from unseen_tables(present)
    yield {"heading": "Targets", "text": "`palpable score` states the targets. Here each film counts once.",
           "columns": TARGET_COLUMNS, "rows": list(target_rows(scored))}
    yield {"folded": "Touch, each film", "columns": TOUCH_COLUMNS, "rows": list(touch_rows(present))}
    yield {"folded": "Occlusion, each film",
           "text": "An edge error of `-`: in this film no hand crosses the outline. Each border pixel that is not drawn counts 50 px.",
           "columns": OCCLUSION_COLUMNS, "rows": list(occlusion_rows(present))}
    if older:
        yield {"text": f"Left out above and marked † below: {', '.join(f'`{key}`' for key in older)}. They were measured "
                       f"on {', '.join(sorted({entry['date'] for entry in older.values()}))} by a program that touched bodies at their sites "
                       "only. [lab/results.md](lab/results.md#films-of-an-older-program) has their touches and edges."}
    yield {"heading": "Depth", "text": "Rendered images, matched with the calibration that rendered them.",
           "columns": ["pixels at", *(f"{distance} m" for distance in DISTANCES)], "rows": list(depth_summary(scored))}
    for name, key in (("Median error of depth", "depth_error_median"), ("Share of pixels within 1 % of their true depth", "depth_within_1pct")):
        yield {"folded": f"{name}, each film", "columns": ["film", *(f"{distance} m" for distance in DISTANCES)],
               "rows": [[marked(film, entry), *map(percent, distances(entry, key))] for film, entry in scored.items()]}
    near = [[marked(film, entry), entry["scores"]["hand_near_frames"], percent(entry["scores"]["hand_within_1pct"]),
             percent(entry["scores"]["too_close_called_far"])] for film, entry in scored.items() if entry["scores"]["hand_near_frames"]]
    yield {"folded": "Near hands, each film", "columns": ["film", "near frames", "hand within 1 %", "too close, reported as far"], "rows": near}
    yield {"heading": "Camera, anchor, what moves, rectification",
           "text": "In most films the camera stands and is recognised as standing. Its pose is then that of the first frame, which has no "
                   "error by definition: `-`.",
           "folded": "Each film", "rows": list(camera_rows(scored)),
           "columns": ["film", "ATE (mm)", "RPE in 1 s (mm)", "jitter (mm)", "moving pixels, IoU", "recall", "false, of all pixels", "row error (px)"]}
    yield from not_scored(entries)
    if real:
        yield {"heading": "Real recordings",
               "text": "`palpable live` plays them with its defaults; the positions of the body are made up. Two of them have a true path of the "
                       "camera. The figures are older than those of [`bench track`](#tracking-mask-and-map), which plays the same kitchen.",
               "columns": ["recording", "frames", "first touch in frame", "ATE (mm)", "RPE in 1 s (mm)", "measured", "remark"],
               "rows": [[name, entry.get("frames"), entry.get("first_touch_frame"), entry.get("scores", {}).get("ate_mm"),
                         entry.get("scores", {}).get("rpe_mm"), entry.get("date"), entry.get("refused") or entry.get("remark") or ""]
                        for name, entry in real.items()]}
    yield origins({**entries, **real})
    if touched_older:
        lab = {"lab": True, "heading": "Films of an older program"}
        yield {**lab, "text": "Measured when bodies were touched at their sites only, one at a time. Response, contact, occlusion and some scores "
                              "have changed since: do not compare these figures with the others.",
               "columns": TOUCH_COLUMNS, "rows": list(touch_rows(older))}
        yield {"lab": True, "columns": ERROR_COLUMNS, "rows": list(error_rows(older))}
        yield {"lab": True, "columns": OCCLUSION_COLUMNS, "rows": list(occlusion_rows(older))}
    yield {"lab": True, "heading": "Time",
           "text": "Seconds of wall time; of filming also seconds of user CPU. Other work shared the two cores, so these figures give an idea "
                   "of the wait and are no comparison. [The live loop](../results.md#the-live-loop) was measured on an idle machine.",
           "columns": ["film", "frames", "synth, CPU", "synth", "live", "truth", "score"],
           "rows": [[name, entry["frames"], (entry.get("film") or {}).get("user_s"), (entry.get("film") or {}).get("wall_s"),
                     entry["play_s"], entry.get("truth_s"), entry["score_s"]] for name, entry in scored.items()]}
