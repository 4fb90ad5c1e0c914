"""Plans at addresses of object stores."""

from __future__ import annotations

from uuid import uuid4

import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.storage.stores import get, store_path

pytest.importorskip("upath", reason="needs universal_pathlib")
PLAN = plan(Mission(Box(35.16, -89.90, 35.158, -89.898), 120.0), PixelGrid())


@pytest.mark.parametrize("ending", [".csv", ".geojson"])
def test_a_plan_at_an_address_is_what_a_file_holds(tmp_path, ending):
    address = f"memory://{uuid4().hex}/plan{ending}"
    write_plan(PLAN, address)
    write_plan(PLAN, tmp_path / f"plan{ending}")
    assert get(store_path(address)) == (tmp_path / f"plan{ending}").read_bytes()


@pytest.mark.parametrize("ending", [".gpkg", ".kmz"])
def test_a_format_of_several_files_is_refused_there(ending):
    with pytest.raises(InvalidInput, match=rf"must be on this machine, as all {ending} files$"):
        write_plan(PLAN, f"memory://x/plan{ending}")
