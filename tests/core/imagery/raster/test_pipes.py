"""Pipes beside a raster: refused before GDAL opens one, which waits for good and is deaf to SIGTERM."""

from __future__ import annotations

import os

import pytest
from PIL import Image
from terrainav.core.errors import InvalidInput
from terrainav.core.imagery.raster.trust import allowed_drivers

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes that have a name in a folder")


@pytest.mark.parametrize("name", ["a.tif.ovr", "a.tif.msk", "a.tif.aux.xml", "a.tif.hdr", "a.prj", "a.AUX", "a.xml"])
def test_a_pipe_beside_a_raster_is_refused(tmp_path, name):
    Image.new("L", (8, 8)).save(tmp_path / "a.tif")
    allowed_drivers(str(tmp_path / "a.tif"))
    os.mkfifo(tmp_path / name)
    with pytest.raises(InvalidInput, match=rf"{name}: is not a regular file"):
        allowed_drivers(str(tmp_path / "a.tif"))
