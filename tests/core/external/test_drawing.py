"""Names of others in diagrams: one line of a few characters each, whatever they are made of."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image
from terrainav.core.benchmark.page import _recall
from terrainav.core.external.drawing import short_label


@pytest.mark.parametrize("name", ["a\n" * 2000, "x" * 100_000, r"$\frac{a$", "\r\x0b\u2028b"])
def test_a_foreign_name_leaves_a_diagram_its_size(name):
    pytest.importorskip("matplotlib")
    label = short_label(name)
    assert label.isprintable()
    assert len(label) <= 61
    sizes = [Image.open(io.BytesIO(_recall({one: np.ones(3)}, "t"))).size for one in ("plain", name)]
    assert sizes[0] == sizes[1]
