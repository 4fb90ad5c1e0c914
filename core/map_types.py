"""Map types: kinds of imagery, named alike in missions, sources and folders of datasets."""

from __future__ import annotations

SATELLITE, ROADMAP, TERRAIN = MAP_TYPES = ("satellite", "roadmap", "terrain")
#: Kinds of twins, images of the same name beside an image: without effects on light; of a lens that does not distort.
TWINS = CLEAN, UNDISTORTED = ("clean", "undistorted")


def twin_type(map_type: str, kind: str) -> str:
    """Map type, and folder, of the twins of a map type's images."""
    return f"{map_type}_{kind}"


def without_twin(map_type: str) -> tuple[str, str]:
    """Map type of the images whose twins another one has, and their kind; itself and an empty text if it has none."""
    base, _, kind = map_type.rpartition("_")
    return (base, kind) if base and kind in TWINS else (map_type, "")


def is_undistorted(map_type: str) -> bool:
    """Whether images are undistorted twins, which show other ground than the images of their names."""
    return without_twin(map_type)[1] == UNDISTORTED
