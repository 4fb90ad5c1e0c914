"""Entropies a second beside scikit-image's `shannon_entropy`, and what they say of a dataset.

    python benchmarks/entropy.py --dataset agricenter    # writes docs/entropy.md and docs/images/entropy-*.png

Each runs in a process and an environment of its own (`tools/setup.sh` makes the peer's, `.venv/peers`). They take turns
on the same image, so that whatever else the machine does meets both alike; what counts is the ratio of each pair. The
dataset is the published mission's, captured from the embedded world (the page says how).
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
PEER = ROOT / ".venv" / "peers" / "bin" / "python"
PAGE, PICTURES = ROOT / "docs" / "entropy.md", ROOT / "docs" / "images"
#: Ordinary sizes: of networks, of captures, of screens, of cameras.
SIZES = ((224, 224), (640, 480), (1280, 960), (4000, 3000))
PAIRS = 41
#: Seconds of one turn, at least, which the clock and the change of turns are nothing against.
TURN_S = 0.02
#: In the middle of the published mission; its satellite picture has much to see.
PLACE = "35.1375_-89.8615_120"
#: Above rounding of the sum's terms in another order, below what any threshold is stated to.
SAME_BITS = 1e-12
OURS, SKIMAGE, SKIMAGE_OWN = "ours", "scikit-image", "scikit-image, its own grey"


def grey(image):
    """Pillow's grey of an RGB array."""
    return np.asarray(Image.fromarray(image).convert("L"))


def measures(who: str):
    """Entropy of an array, grey or RGB, as somebody works it out."""
    if who == OURS:
        from terrainav.core.dataset.entropy import entropy

        return entropy
    from skimage.measure import shannon_entropy

    if who == SKIMAGE:
        return lambda image: float(shannon_entropy(image if image.ndim == 2 else grey(image)))
    # Its own grey is for colours only.
    from skimage.color import rgb2gray
    from skimage.util import img_as_ubyte

    return lambda image: float(shannon_entropy(img_as_ubyte(rgb2gray(image))))


def work(who: str) -> None:
    """Answer each line (file, calls) with the seconds of that many calls, and the entropy."""
    measure, images = measures(who), {}
    for line in sys.stdin:
        path, calls = json.loads(line)
        image = images.setdefault(path, np.load(path))
        began = time.perf_counter()
        for _ in range(calls):
            bits = measure(image)
        print(json.dumps([time.perf_counter() - began, bits]), flush=True)


class Worker:
    """Somebody in a process of their own."""

    def __init__(self, who: str) -> None:
        python = sys.executable if who == OURS else str(PEER)
        self.process = subprocess.Popen(
            [python, __file__, "--worker", who], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def ask(self, path: Path, calls: int) -> tuple[float, float]:
        """Seconds of some calls, and the entropy."""
        print(json.dumps([str(path), calls]), file=self.process.stdin, flush=True)
        seconds, bits = json.loads(self.process.stdout.readline())
        return seconds, bits


@contextmanager
def workers(names: tuple[str, ...]) -> Iterator[dict[str, Worker]]:
    """Start them, and end them afterwards."""
    started = {name: Worker(name) for name in names}
    try:
        yield started
    finally:
        for worker in started.values():
            worker.process.stdin.close()
            worker.process.wait()


class Row(NamedTuple):
    """A kind of image: images a second of ours and a peer's, quartiles of the pairs' ratios, difference in bits."""

    kind: str
    size: tuple[int, int]
    peer: str
    ours_per_s: float
    peer_per_s: float
    ratios: tuple[float, float, float]
    difference: float


def compare(ours: Worker, peer: Worker, path: Path) -> tuple[float, float, tuple[float, float, float], float]:
    """Take turns on an image."""
    for worker in (ours, peer):
        worker.ask(path, 2)
    calls = [max(int(TURN_S / worker.ask(path, 1)[0]), 1) for worker in (ours, peer)]
    each: list[list[float]] = [[], []]
    for pair in range(PAIRS):
        for at in (0, 1) if pair % 2 else (1, 0):
            each[at].append((ours, peer)[at].ask(path, calls[at])[0] / calls[at])
    own_s, peer_s = map(np.array, each)
    quartiles = np.quantile(peer_s / own_s, [0.25, 0.5, 0.75])
    difference = abs(ours.ask(path, 1)[1] - peer.ask(path, 1)[1])
    return 1.0 / np.median(own_s), 1.0 / np.median(peer_s), tuple(quartiles.tolist()), difference


def picture(folder: Path) -> Image.Image:
    """A capture of the embedded world."""
    from terrainav.core.cli import main as command

    arguments = ["capture", "--coords", PLACE, "--map-type", "satellite", "--zoom", "18", "--format", "png"]
    if command([*arguments, "--quiet", "--data-dir", str(folder / "one")]) != 0:
        raise SystemExit("no image to measure on")
    (path,) = (folder / "one" / "satellite").glob("*.png")
    return Image.open(path).convert("RGB")


def measured() -> list[Row]:
    """All sizes, in colour and grey."""
    rows = []
    with tempfile.TemporaryDirectory() as name, workers((OURS, SKIMAGE, SKIMAGE_OWN)) as all_of_them:
        folder = Path(name)
        origin = picture(folder)
        for size in SIZES:
            colour = origin.resize(size, Image.Resampling.BICUBIC)
            kinds = {
                "grey": (colour.convert("L"), (SKIMAGE,)),
                "RGB": (colour, (SKIMAGE, SKIMAGE_OWN)),
            }
            for kind, (image, peers) in kinds.items():
                path = folder / f"{kind}-{size[0]}.npy"
                np.save(path, np.asarray(image))
                for peer in peers:
                    found = compare(all_of_them[OURS], all_of_them[peer], path)
                    rows.append(Row(kind, size, peer, *found))
                    print(rows[-1], flush=True)
    for row in rows:
        if row.peer == SKIMAGE and row.difference > SAME_BITS:
            raise SystemExit(f"{row.kind} of {row.size}: entropies differ by {row.difference} bits")
    return rows


def peer_versions() -> str:
    """What the peer is, in its environment."""
    code = "import skimage, numpy, PIL; print(skimage.__version__, numpy.__version__, PIL.__version__)"
    found = subprocess.run([PEER, "-Ic", code], check=True, capture_output=True, text=True).stdout.split()
    return "scikit-image {}, numpy {}, Pillow {}".format(*found)


def drawn(rows: list[Row]) -> bytes:
    """Images a second, by size."""
    from terrainav.core.external.drawing import BLUE, FONT, ORANGE, PURPLE, dress, new_figure, png

    figure = new_figure(10.0, 4.2)
    for axes, kind in zip(figure.subplots(1, 2), ("grey", "RGB")):
        dress(axes, kind, "image, px", "images a second, one core")
        axes.set_yscale("log")
        axes.set_ylim(1.0, None)
        mine = [row for row in rows if row.kind == kind]
        bars = [(OURS, BLUE, [row.ours_per_s for row in mine if row.peer == SKIMAGE])]
        for peer, colour in ((SKIMAGE, ORANGE), (SKIMAGE_OWN, PURPLE)):
            values = [row.peer_per_s for row in mine if row.peer == peer]
            bars += [(peer, colour, values)] if values else []
        width = 0.8 / len(bars)
        for at, (label, colour, values) in enumerate(bars):
            x = np.arange(len(SIZES)) + (at - (len(bars) - 1) / 2.0) * width
            axes.bar(x, values, width=0.92 * width, color=colour, label=label)
        axes.set_xticks(range(len(SIZES)), [f"{w} x {h}" for w, h in SIZES])
        axes.yaxis.set_major_formatter(lambda value, _position: f"{value:,.0f}")
        axes.legend(fontsize=FONT["note"], frameon=False)
    return png(figure)


def rate(per_s: float) -> str:
    """Images a second, with a decimal where there are few."""
    return f"{per_s:,.0f}" if per_s >= 10.0 else f"{per_s:.1f}"


def rate_lines(rows: list[Row]) -> list[str]:
    """Table of the rates."""
    lines = [
        "| image | px | peer | ours, images/s | peer, images/s | ratio (quartiles of the pairs) | difference, bits |",
        "| --- | ---: | --- | ---: | ---: | ---: | ---: |",
    ]
    for row in rows:
        low, middle, high = row.ratios
        lines.append(
            f"| {row.kind} | {row.size[0]} x {row.size[1]} | {row.peer} | {rate(row.ours_per_s)} | "
            f"{rate(row.peer_per_s)} | {middle:.1f} ({low:.1f} to {high:.1f}) | {row.difference:.1g} |"
        )
    return lines


def dataset_lines(folder: Path, threshold: float) -> list[str]:
    """What thresholds do to a dataset; writes its figures."""
    from terrainav.core.dataset.entropy import image_entropies, otsu
    from terrainav.core.dataset.figures import save_figures

    paths = save_figures(folder, PICTURES, threshold)
    for path in paths:
        # Those of other map types show the roadmap's entropies once more.
        if "roadmap" not in path.name:
            path.unlink()
    own = image_entropies(folder)
    lines = [
        f"| entropies of | images | 5 %, median, 95 % | Otsu's | below it | below {threshold:g} | between |",
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for map_type, entropies in own.items():
        there = entropies[~np.isnan(entropies)]
        suggested = otsu(there)
        five, middle, most = np.quantile(there, [0.05, 0.5, 0.95])
        at_otsu, at_threshold = int((there < suggested).sum()), int((there < threshold).sum())
        lines.append(
            f"| {map_type} | {len(there):,} | {five:.2f}, {middle:.2f}, {most:.2f} | {suggested:.2f} | "
            f"{at_otsu:,} ({at_otsu / len(there):.1%}) | {at_threshold:,} ({at_threshold / len(there):.1%}) | "
            f"{abs(at_threshold - at_otsu):,} |"
        )
    return lines


TEXT = """# Entropy

Made by `python benchmarks/entropy.py --dataset agricenter`; all figures are from one run on one machine.

Machine: {cores} cores, {system}; {own}; peer: {peer}; load average {load:.1f}.

The entropy of an image is equation 10 of the paper: −Σ p log₂ p over the histogram of 256 grey levels, in bits, from 0
(one level) to 8 (all equally often). Colours are converted to grey by ITU-R 601, as in Pillow's mode `L`. A capture
writes the entropy of each image to the table; `terrainav clean` computes it for images whose table has none.

## Comparison with scikit-image

`skimage.measure.shannon_entropy` of the same 8-bit grey gives the same number, up to rounding of its sum (a test
compares them). Two processes take turns on one image, {pairs} pairs; the ratio is that of TerrAInav's rate to
scikit-image's. Colour images are given to scikit-image in Pillow's grey, which is the same work, and in grey from its
`rgb2gray`, which has different weights and therefore a different entropy.

{rates}

![Images a second, by size](images/entropy-rate.png)

Most of TerrAInav's time is spent in Pillow: for an RGB image of 640 x 480 px, three quarters for unpacking and
conversion to grey, and a fifth for the histogram. Counting in numpy takes longer (`bincount` two to four times as long
as Pillow's histogram), and the weighted sum of the channels in numpy is no faster than Pillow's conversion, in bands of
any size.

For an RGB array, `shannon_entropy` pools the values of all channels. The paper's program does that, so the entropies in
its published tables are not those of equation 10, and mostly higher. `terrainav clean` uses the entropies in a table
unchanged; if the column is missing, it computes them from the images.

## The threshold, on the published mission over the embedded world

    terrainav capture --coords "35.16_-89.90_35.115_-89.823_120" --map-type satellite roadmap --zoom 18 \\
        --data-dir agricenter
    terrainav clean agricenter --dry-run --plot figures

The paper uses zoom 18 for this height, by its equation 8 and its limit of 640 px. Finer images have different
entropies.

{dataset}

![Histogram of the roadmap's entropies](images/entropy-histogram-roadmap.png)

![Entropy of each roadmap image](images/entropy-bars-roadmap.png)

The roadmap's entropies form two groups, with few images from about 1.5 to 2.2 bits between them: fields with at most a
road or a track, and settlements. The paper's 2.1 is at the upper end of this gap, Otsu's threshold near its lower end.
The few images in between show the edge of a settlement, half field and half buildings, or a wood with a road through
it. Either threshold is sound here: 2.1 keeps built-up areas, Otsu's also their edges. Both reject most of this mission,
which is mostly fields.

The satellite's entropies form one group, and Otsu's method divides it in its middle: it always finds a threshold, even
for a single group. That is why the roadmap, if there is one, decides, and why you should look at the histogram before
you accept a suggestion.
"""


def main() -> None:
    """Measure and write the page and its pictures."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--worker", help=argparse.SUPPRESS)
    parser.add_argument("--dataset", type=Path, help="captured as the page says")
    parser.add_argument("--entropy", type=float, default=2.1, help="threshold (default %(default)s)")
    asked = parser.parse_args()
    if asked.worker:
        work(asked.worker)
        return
    rows = measured()
    if asked.dataset is None:
        print("\n".join(rate_lines(rows)))
        return
    from terrainav.core.report.machine import versions
    from terrainav.core.storage.files import write_whole

    text = TEXT.format(
        cores=os.cpu_count(),
        system=platform.system(),
        own=", ".join(f"{name} {value}" for name, value in versions() if name in ("Python", "numpy", "Pillow")),
        peer=peer_versions(),
        load=os.getloadavg()[0],
        pairs=PAIRS,
        rates="\n".join(rate_lines(rows)),
        dataset="\n".join(dataset_lines(asked.dataset, asked.entropy)),
    )
    write_whole(PICTURES / "entropy-rate.png", drawn(rows))
    write_whole(PAGE, text.encode())


if __name__ == "__main__":
    main()
