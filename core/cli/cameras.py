"""Cameras on the command line: listed, added, removed."""

from __future__ import annotations

import argparse
import json
import sys

from .exits import DONE


def run_cameras(arguments: argparse.Namespace) -> int:
    """List, add or remove cameras."""
    actions = {"add": _add, "remove": _remove}
    return actions.get(arguments.action or "", _list)(arguments)


def _list(arguments: argparse.Namespace) -> int:
    from ..mission.cameras import camera_shelf, shipped_cameras

    own = camera_shelf()
    presets = (*shipped_cameras(), *own.presets)
    for problem in own.problems.values():
        print(f"terrainav: {problem}", file=sys.stderr)
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


def _add(arguments: argparse.Namespace) -> int:
    from ..mission.cameras import FACTS, add_camera

    given = vars(arguments)
    facts = {fact: given[fact] for fact in FACTS if given[fact] is not None}
    camera = add_camera(arguments.name, facts).camera
    print(
        f"{arguments.name} added: {camera.fov_deg:.2f} deg diagonal, {camera.horizontal_fov_deg:.2f} by "
        f"{camera.vertical_fov_deg:.2f} deg"
    )
    return DONE


def _remove(arguments: argparse.Namespace) -> int:
    from ..mission.cameras import remove_camera

    print(f"{remove_camera(arguments.name)} removed")
    return DONE
