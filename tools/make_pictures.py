#!/usr/bin/env python3
"""Makes the pictures of docs/gallery.md and README's first one again, from films of the synthetic desk.

usage: tools/make_pictures.py [--work DIR] [--bunny FILE] [--dragon FILE]

Films and runs that are in the work folder already are taken as they are. Figure 19 needs a dragon and Figure 12 the beam
(out/bodies/beam.palpable); what is not baked is left out, and said. Needs Debian's python3-opencv and python3-pil, which
the project itself does not: apt-get install python3-opencv python3-pil
"""
import argparse
import subprocess
import sys
from pathlib import Path

try:
    import cv2
    import numpy
    from PIL import Image
except ImportError as missing:
    sys.exit(f"{missing}: apt-get install python3-opencv python3-pil, and run it with /usr/bin/python3")

ROOT = Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs" / "pictures"
PALPABLE = ROOT / "build" / "release" / "bin" / "palpable"


def run(*words):
    print("palpable", *words)
    subprocess.run([PALPABLE, *map(str, words)], check=True, cwd=ROOT, stdout=subprocess.DEVNULL)


def frames_of(film, wanted):
    """{number: picture (rows x columns x 3, blue first)} of a film's frames."""
    video, found, number = cv2.VideoCapture(str(film)), {}, 0
    while True:
        there, picture = video.read()
        if not there:
            return found
        if number in wanted:
            found[number] = picture
        number += 1


def write_row(name, film, numbers, box=(0, 0, 1280, 720), width=640):
    """Writes frames of a film side by side as a JPEG. `box`: x0 y0 x1 y1 of the part to cut out, px."""
    x0, y0, x1, y1 = box
    found = frames_of(film, numbers)
    height = round(width * (y1 - y0) / (x1 - x0))
    row = [cv2.resize(found[n][y0:y1, x0:x1], (width, height), interpolation=cv2.INTER_AREA) for n in numbers]
    cv2.imwrite(str(PICTURES / name), numpy.hstack(row), [cv2.IMWRITE_JPEG_QUALITY, 86])
    print(PICTURES / name)


def write_webp(name, pictures, step, box, width, quality):
    """Writes pictures, every `step`-th of a film of 30 frames a second, as an animated picture in full colours."""
    x0, y0, x1, y1 = box
    size = (width, round(width * (y1 - y0) / (x1 - x0)))
    small = [Image.fromarray(cv2.resize(p[y0:y1, x0:x1], size, interpolation=cv2.INTER_AREA)[:, :, ::-1]) for p in pictures]
    small[0].save(PICTURES / name, save_all=True, append_images=small[1:], duration=1000 * step // 30, loop=0,
                  quality=quality, method=6)
    print(PICTURES / name, f"{(PICTURES / name).stat().st_size / 1e6:.1f} MB")


# Of hands_desk: where the mouse pad's maker is named, x0 y0 x1 y1 in px of its 720 x 720 pictures.
NAMES_ON_PAD = ((376, 338, 452, 362), (608, 552, 668, 612))


def without_names(picture):
    """A picture of hands_desk whose bright letters on the dark pad are painted over."""
    letters = numpy.zeros(picture.shape[:2], numpy.uint8)
    for x0, y0, x1, y1 in NAMES_ON_PAD:
        bright = 255 * (picture[y0:y1, x0:x1].max(2) > 55).astype(numpy.uint8)
        letters[y0:y1, x0:x1] = cv2.dilate(bright, numpy.ones((5, 5)))
    return cv2.inpaint(picture, letters, 4, cv2.INPAINT_TELEA)


def write_hands(film):
    """A press by a recorded hand (hands_desk): the frame that shows it best for README, the film for the gallery."""
    found = {number: without_names(picture) for number, picture in frames_of(film, range(117, 153, 2)).items()}
    x0, y0, x1, y1 = 225, 255, 545, 495
    still = cv2.resize(found[139][y0:y1, x0:x1], (896, 672), interpolation=cv2.INTER_CUBIC)
    cv2.imwrite(str(PICTURES / "hands_desk.jpg"), still, [cv2.IMWRITE_JPEG_QUALITY, 88])
    print(PICTURES / "hands_desk.jpg")
    write_webp("hands_desk.webp", list(found.values()), 2, (0, 140, 720, 560), 720, 75)


def write_pressure(body, work):
    """A press at the neck, painted with pressure and with a component of stress, side by side."""
    row = []
    for paint in ("pressure", "szz"):
        run("view", body, "--site", 4, "--paint", paint, "-o", work / paint)
        whole = cv2.imread(str(work / paint / "5_press_site_4_level_100.png"))
        row.append(cv2.resize(whole[60:720, 400:1280], (800, 600), interpolation=cv2.INTER_AREA))
    cv2.imwrite(str(PICTURES / "pressure.jpg"), numpy.hstack(row), [cv2.IMWRITE_JPEG_QUALITY, 88])
    print(PICTURES / "pressure.jpg")


def write_rubbing(body, work):
    """A finger dragged along the back, an ear between finger and thumb: without friction, and with it."""
    hands = work / "rub.jsonl"
    hands.write_text(subprocess.run([sys.executable, ROOT / "tools/rubbing_hands.py"], check=True, capture_output=True,
                                    text=True).stdout)
    films = []
    for friction in (0, 0.6):
        out = work / f"rub-{friction}"
        if not (out / "touch.mp4").exists():
            run("live", body, "--source", hands, "--friction", friction, "--out", out)
        films.append(frames_of(out / "touch.mp4", range(15, 324, 3)))
    pairs = [numpy.hstack([film[n][90:580, 400:900] for film in films]) for n in sorted(films[0])]
    write_webp("rubbing.webp", pairs, 3, (0, 0, 1000, 490), 900, 70)


def write_flick(body, work):
    """An ear that is bent and let go, then flicked: without inertia, and with it."""
    hands = work / "flick.jsonl"
    hands.write_text(subprocess.run([sys.executable, ROOT / "tools/flicking_hands.py"], check=True, capture_output=True,
                                    text=True).stdout)
    films = []
    for dynamics in ("off", "on"):
        out = work / f"flick-{dynamics}"
        if not (out / "touch.mp4").exists():
            run("live", body, "--source", hands, "--dynamics", dynamics, "--out", out)
        films.append(frames_of(out / "touch.mp4", range(70, 235)))
    pairs = [numpy.hstack([film[n][20:380, 420:860] for film in films]) for n in sorted(films[0])]
    write_webp("flick.webp", pairs, 1, (0, 0, 880, 360), 880, 70)


def played(work, name, film_words, live_words):
    """The film that `palpable live` writes of a synthetic clip; both are made if they do not exist."""
    clip, out = work / name, work / (name + "-live")
    if not (clip / "truth" / "script.toml").exists():
        run("synth", *film_words, "-o", clip)
    if not (out / "touch.mp4").exists():
        run("live", *live_words, "--source", clip / "frames", "--out", out, "--every-frame")
    return out / "touch.mp4"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--work", type=Path, default=ROOT / "out" / "pictures", help="films and runs are kept here")
    parser.add_argument("--bunny", type=Path, default=ROOT / "out" / "demo" / "bunny.palpable")
    parser.add_argument("--dragon", type=Path, default=ROOT / "out" / "bodies" / "dragon.palpable")
    options = parser.parse_args()
    beam = ROOT / "out" / "bodies" / "beam.palpable"
    if options.bunny.exists():
        film = played(options.work, "demo", ["demo", "--body", options.bunny, "--seed", 1], [options.bunny])
        write_webp("demo.webp", list(frames_of(film, range(78, 360, 3)).values()), 3, (0, 0, 1280, 720), 800, 72)
        write_row("figure_9.jpg", film, [174, 248], width=720)
        write_row("figure_16.jpg", film, [98, 142], (330, 110, 1280, 644), 800)
        write_pressure(options.bunny, options.work)
        write_rubbing(options.bunny, options.work)
        write_flick(options.bunny, options.work)
        hands = ROOT / "../shared/data/hands_desk"
        if hands.is_dir():
            out = options.work / "hands_desk"
            if not (out / "touch.mp4").exists():
                run("live", options.bunny, "--source", hands, "--anchor", "plane", "--at-pixel", "340,425", "--scale", 0.5,
                    "--forces", "--out", out, "--every-frame")
            write_hands(out / "touch.mp4")
        else:
            print(f"no {hands}: the picture of a recorded hand is left out")
    else:
        print(f"no {options.bunny}: ./demo bakes it; Figures 9 and 16 are left out")
    if options.dragon.exists():
        film = played(options.work, "dragon", ["demo", "--body", options.dragon, "--seed", 1], [options.dragon])
        write_row("figure_19.jpg", film, [98, 142], (330, 110, 1280, 644), 800)
    else:
        print(f"no {options.dragon}: palpable bake bodies/dragon.toml -o {options.dragon}; Figure 19 is left out")
    if beam.exists():
        scene = ROOT / "scenes" / "crossed-beams.toml"
        film = played(options.work, "beams", ["beams", "--scene", scene, "--frames", 240, "--seed", 5], [scene])
        write_row("figure_12.jpg", film, [118, 150], (445, 140, 1165, 545), 720)
    else:
        print(f"no {beam}: scenes/crossed-beams.toml says how it is baked; Figure 12 is left out")


if __name__ == "__main__":
    main()
