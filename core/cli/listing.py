"""List, add and remove sources, cameras and cached tiles on the command line."""

from __future__ import annotations

import argparse
import json
import sys
from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput, Message, SourceError
from ..storage.stores import is_address
from ..text.plain import printable
from .exits import DONE

if TYPE_CHECKING:
    from ..imagery.cache.tile_cache import TileCache
    from ..imagery.entry import CatalogueEntry

#: Width of the first column of lists.
_COLUMN = 22
#: Options of ``sources add`` that are saved unchanged.
_SAVED = (
    "title",
    "attribution",
    "licence",
    "terms_url",
    "min_zoom",
    "max_zoom",
    "native_zoom",
    "max_connections",
    "requests_per_s",
    "key_env",
)


def run_sources(arguments: argparse.Namespace) -> int:
    """List, show, add or remove sources."""
    actions = {"show": _show_source, "add": _add_source, "remove": _remove_source}
    return actions.get(arguments.action or "", _list_sources)(arguments)


def _list_sources(arguments: argparse.Namespace) -> int:
    from ..imagery.catalogue import shelf
    from ..imagery.entry import shipped

    user_sources = shelf()
    entries = (*shipped(), *user_sources.entries)
    for problem in user_sources.problems.values():
        print(f"terrainav: {printable(problem)}", file=sys.stderr)
    if arguments.json:
        print(json.dumps([entry.to_dict() for entry in entries], indent=1))
        return DONE
    for entry in entries:
        mark = " (your own)" if entry.user else ""
        dates = f"; dates: {entry.dates.text()}" if entry.dates else ""
        print(f"{entry.name:{_COLUMN}s}{entry.title}{mark}")
        print(
            f"{'':{_COLUMN}s}zoom {entry.min_zoom} to {entry.native_zoom}, bulk download: {entry.bulk_allowed}; "
            f"{entry.licence or 'licence not stated'}{dates}"
        )
    print(
        "\nName a source by its name or its title. A URL template with {z} {x} {y}, wmts:URL, wms:URL, arcgis:URL, "
        "ogcapi:URL and a file work as sources too; see terrainav sources --help."
    )
    return DONE


def _show_source(arguments: argparse.Namespace) -> int:
    from ..imagery.opening import SourceOptions, named_source
    from ..imagery.services.detecting import found_service, is_service_address

    options = SourceOptions(crs=arguments.crs, named_by_user=True)
    source, offered = named_source(arguments.source, options), None
    if is_service_address(arguments.source):
        found = found_service(arguments.source, options)
        source, offered = found.source, found.layers
    if offered is not None:
        if arguments.json:
            print(json.dumps([{"name": layer.name, "title": layer.title} for layer in offered], indent=1))
            return DONE
        if not offered:
            raise SourceError("{0}: offers no layers", arguments.source)
        if source.text != arguments.source:
            print(printable(f"{source.text}#{found.layer_choice}=NAME, where NAME is one of"))
        for layer in offered:
            print(printable(f"{layer.name:{_COLUMN}s} {layer.title}"))
        return DONE
    entry = source.entry
    # A source may offer more systems than the one in its catalogue entry; it refuses any others.
    crs = source.grid.plane.crs if arguments.crs else ""
    if arguments.json:
        print(json.dumps(entry.to_dict(), indent=1))
        return DONE
    for label, text in _described(entry, crs):
        if text:
            print(printable(f"{label:{_COLUMN}s}{text}"))
    if entry.dates is not None and entry.dates.values:
        import textwrap

        margin = " " * _COLUMN
        listed = ", ".join(sorted(entry.dates.values))
        wrapped = textwrap.fill(
            printable(listed), 110, initial_indent=margin, subsequent_indent=margin, break_on_hyphens=False
        )
        print(f"{'each of the dates':{_COLUMN}s}{wrapped.strip()}")
    return DONE


def _described(entry: CatalogueEntry, crs: str) -> list[tuple[str, str]]:
    from ..imagery.systems import MAP

    policy = entry.policy
    placeholders = entry.placeholder
    marks = len(placeholders.sha256) + len(placeholders.header) + len(placeholders.flat_rgb)
    urls = [(f"URL{f' ({map_type})' if map_type else ''}", url) for map_type, url in entry.urls.items()]
    return [
        ("name", entry.name + (" (your own)" if entry.user else "")),
        ("title", entry.title),
        ("area", entry.area),
        ("map types", ", ".join(entry.map_types) or "one kind of image"),
        ("reference system", crs or (MAP if entry.plane is None else entry.plane.crs)),
        ("zooms", f"{entry.min_zoom} to {entry.max_zoom}, detail to {entry.native_zoom}"),
        ("tiles", f"{' or '.join(map(str, entry.tile_px))} px"),
        ("dates", entry.dates.text() if entry.dates else "none to choose from"),
        ("attribution", entry.attribution or "not stated"),
        ("licence", policy.licence or "not stated"),
        ("bulk download", f"{policy.bulk_allowed}: {policy.text()}"),
        ("terms", policy.terms),
        ("terms page", policy.terms_url),
        ("placeholders", f"{marks} known" if marks else "none known"),
        ("key", f"environment variable {entry.key_env}" if entry.key_env else "none needed"),
        *urls,
    ]


def _add_source(arguments: argparse.Namespace) -> int:
    from ..imagery.catalogue import add, described
    from ..imagery.opening import SourceOptions
    from ..imagery.placeholder import Placeholder
    from ..imagery.services.detecting import found_service, is_service_address
    from ..imagery.systems import MAP, refused

    given = {name: getattr(arguments, name) for name in _SAVED if getattr(arguments, name) is not None}
    if arguments.no_storing:
        given["cache_allowed"] = False
    placeholders = arguments.placeholder or ()
    if is_service_address(arguments.url):
        if arguments.default_date is not None:
            raise InvalidInput("--default-date: the dates of a service are those of its capabilities")
        asked = SourceOptions(tile_px=arguments.tile_size, crs=arguments.crs, named_by_user=True)
        entry = found_service(arguments.url, asked).source.entry
        files = list(Placeholder().extended(placeholders).sha256)
        data = {**entry.to_data(), **given, **({"placeholder": {"sha256": files}} if files else {})}
    else:
        if arguments.crs not in ("", MAP):
            raise refused(arguments.crs, Message("a URL template"), [MAP])
        if arguments.tile_size is not None:
            given["tile_px"] = arguments.tile_size
        data = described(arguments.url, **given, default_date=arguments.default_date or "", placeholders=placeholders)
    added = add(arguments.name, data)
    print(f"{added.name} added: {added.title}")
    print(f"{added.bulk_allowed}: {added.policy.text()}")
    return DONE


def _remove_source(arguments: argparse.Namespace) -> int:
    from ..imagery.catalogue import remove

    remove(arguments.name)
    print(f"{arguments.name} removed")
    return DONE


def run_cameras(arguments: argparse.Namespace) -> int:
    """List, add or remove cameras."""
    actions = {"add": _add_camera, "remove": _remove_camera, "sensors": _list_sensors}
    return actions.get(arguments.action or "", _list_cameras)(arguments)


def _list_cameras(arguments: argparse.Namespace) -> int:
    from ..geodesy.lens import LENS_FIELDS
    from ..mission.cameras import camera_shelf, shipped_cameras

    user_cameras = camera_shelf()
    presets = (*shipped_cameras(), *user_cameras.entries)
    for problem in user_cameras.problems.values():
        print(f"terrainav: {printable(problem)}", file=sys.stderr)
    if arguments.json:
        rows = [
            {
                "name": preset.name,
                "fov_deg": preset.camera.fov_deg,
                "horizontal_fov_deg": preset.camera.horizontal_fov_deg,
                "vertical_fov_deg": preset.camera.vertical_fov_deg,
                "aspect_ratio": preset.camera.aspect_ratio,
                "sensor_mm": preset.sensor_mm,
                "focal_length_mm": preset.focal_length_mm,
                "size_px": None if preset.width_px is None else [preset.width_px, preset.height_px],
                "image_px": preset.image_px,
                "lens": None if preset.camera.is_ideal else {one: getattr(preset.camera, one) for one in LENS_FIELDS},
                "source": preset.source,
                "user": preset.user,
            }
            for preset in presets
        ]
        print(json.dumps(rows, indent=1, ensure_ascii=False))
        return DONE
    for preset in presets:
        camera, mark = preset.camera, " (your own)" if preset.user else ""
        print(f"{preset.name:26s}{camera.fov_deg:6.1f} deg diagonal, {camera.aspect_ratio:.3f} : 1{mark}")
    return DONE


def _list_sensors(arguments: argparse.Namespace) -> int:
    from ..mission.sensors import shipped_sensors

    presets = shipped_sensors()
    if arguments.json:
        rows = [{"name": one.name, **one.figures, "source": one.source} for one in presets]
        print(json.dumps(rows, indent=1, ensure_ascii=False))
        return DONE
    for one in presets:
        figures = one.figures
        print(
            f"{one.name:34s}{figures['pixel_um']:5g} µm, {figures['quantum_efficiency']:.0%}, "
            f"{figures['full_well_e']:,.0f} e-, read noise {figures['read_noise_e']:g} e-"
        )
    return DONE


def _add_camera(arguments: argparse.Namespace) -> int:
    from ..mission.cameras import FACTS, add_camera

    given = vars(arguments)
    facts = {fact: given[fact] for fact in FACTS if given.get(fact) is not None}
    camera = add_camera(arguments.name, facts).camera
    print(
        f"{arguments.name} added: {camera.fov_deg:.2f} deg diagonal, {camera.horizontal_fov_deg:.2f} by "
        f"{camera.vertical_fov_deg:.2f} deg"
    )
    return DONE


def _remove_camera(arguments: argparse.Namespace) -> int:
    from ..mission.cameras import remove_camera

    print(f"{remove_camera(arguments.name)} removed")
    return DONE


def open_cache(values: dict[str, Any]) -> TileCache | None:
    """Open the cache that the options of a run name; None with --no-cache."""
    limit_mb = values["cache_limit"]
    if limit_mb is not None and limit_mb < 1:
        raise InvalidInput("cache limit {0} MB: must be 1 or more; --no-cache keeps nothing", limit_mb)
    if values["no_cache"]:
        return None
    _check_folder(values["cache_dir"])
    from ..imagery.cache.tile_cache import LIMIT_BYTES, TileCache

    return TileCache(values["cache_dir"], LIMIT_BYTES if limit_mb is None else limit_mb * 1_000_000)


def _check_folder(folder: str | None) -> None:
    # Probably an unset variable of the shell, which must not mean the current folder.
    if folder == "":
        raise InvalidInput("cache folder '': must be the name of a folder, or left out for the usual one")
    if folder is not None and is_address(folder):
        raise InvalidInput("cache folder {0}: must be on this machine", folder)


def run_cache(arguments: argparse.Namespace) -> int:
    """List or clear the cache."""
    _check_folder(arguments.cache_dir)
    from ..imagery.cache.tile_cache import TileCache
    from ..mission.estimate import size_text

    cache = TileCache(arguments.cache_dir)
    if arguments.action == "clear":
        freed = cache.clear(arguments.names or None)
        if arguments.json:
            print(json.dumps({"folder": str(cache.folder), "freed_bytes": freed}, indent=1))
        else:
            print(printable(f"{size_text(freed)} freed in {cache.folder}"))
        return DONE
    files = cache.list()
    if arguments.json:
        rows = [{**vars(file), "path": str(file.path)} for file in files]
        print(json.dumps({"folder": str(cache.folder), "files": rows}, indent=1))
        return DONE
    for file in files:
        what = ", ".join(filter(None, (file.title, file.map_type, file.date)))
        print(printable(f"{file.source:22s}{what}: {file.tiles:,} tiles of {file.tile_px} px, {size_text(file.bytes)}"))
        print(printable(f"{'':22s}{file.path.name}"))
    total = sum(file.bytes for file in files)
    where = f"{cache.folder} (limit {size_text(cache.limit_bytes)})"
    print(printable(f"{len(files)} files, {size_text(total)} in {where}"))
    return DONE
