"""Aircraft of JSBSim, a flight dynamics model, as tracks: a script is flown with its autopilot and its events."""

from __future__ import annotations

import importlib
import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from ..errors import InvalidInput, OutputError
from ..geodesy.camera import attitude_from_axes
from ..geodesy.quaternions import quaternions_from_angles, rotation_matrices
from ..poses.track import Progress, Track, report, unwatched
from ..poses.trajectories import BODIES, WORLDS
from ..units import M_PER_FT

#: Time between positions of a track, s, or the model's step if that is longer.
SAMPLES_S = 0.01
#: Longest flight, s.
LONGEST_S = 6.0 * 3600.0
_PLACE = ("position/lat-geod-deg", "position/long-gc-deg", "position/h-agl-ft")
_ATTITUDE = ("attitude/psi-rad", "attitude/theta-rad", "attitude/phi-rad")


def fly_script(
    script: str | os.PathLike[str],
    root: str | os.PathLike[str] | None = None,
    place_deg: tuple[float, float] | None = None,
    progress: Progress = unwatched,
) -> Track:
    """Fly a script of JSBSim; heights are those above its level terrain, times those after its start.

    The camera is fixed to the aircraft and looks down, the top of its image ahead.

    Parameters
    ----------
    script : path
        A file, or one relative to the root, such as ``scripts/Test_F450_Launch.xml`` of the package.
    root : path or None
        Folder with ``aircraft``, ``engine`` and ``systems``; None for the package's.
    place_deg : latitude and longitude, or None
        Where the flight begins; None for where the script says.
    progress : callable

    Raises
    ------
    InvalidInput
        JSBSim cannot read the script, or it does not fly.
    OutputError
        JSBSim is not installed.
    Cancelled
        ``progress`` returned False.
    """
    try:
        jsbsim = importlib.import_module("jsbsim")
    except ImportError as missing:
        raise OutputError(
            "{0}, which flies aircraft, is not installed",
            "jsbsim",
            remedy="get it with: pip install 'terrainav[jsbsim]'",
        ) from missing
    file = Path(script).resolve() if Path(script).is_file() else Path(script)
    if not (Path(root or jsbsim.get_default_root_dir()) / file).is_file():
        raise InvalidInput("JSBSim script {0}: no such file", script)
    # Scripts and aircraft write tables, of which nothing is needed, into the working folder unless told another.
    with _silent(), TemporaryDirectory() as tables:
        try:
            model = jsbsim.FGFDMExec(None if root is None else str(root))
            model.set_output_path(tables)
            is_read = model.load_script(str(file))
            if is_read and place_deg is not None:
                model["ic/lat-geod-deg"], model["ic/long-gc-deg"] = place_deg
            is_read = is_read and model.run_ic()
        except Exception as wrong:
            raise InvalidInput("JSBSim script {0}: cannot be flown ({1})", script, wrong) from wrong
        if not is_read:
            raise InvalidInput("JSBSim script {0}: cannot be flown", script)
        rows = np.array(_flown(model, progress))
    if len(rows) < 2 or not np.isfinite(rows).all():
        raise InvalidInput("JSBSim script {0}: its aircraft does not fly", script)
    time_s, lat, lon, height_ft, yaw, pitch, roll = rows.T
    turned = rotation_matrices(quaternions_from_angles(*(np.degrees(angle) for angle in (yaw, pitch, roll))))
    vectors = (WORLDS["ned"] @ turned) @ BODIES["frd"].T
    attitude = attitude_from_axes(vectors[..., 0], vectors[..., 1], vectors[..., 2])
    return Track(lat, lon, height_ft * M_PER_FT, 0.0, np.round(time_s - time_s[0], 6), attitude)


def _flown(model: Any, progress: Progress) -> list[list[float]]:
    """Times and states until the script ends."""
    every = max(round(SAMPLES_S / model.get_delta_t()), 1)
    rows: list[list[float]] = []
    steps = math.ceil(LONGEST_S / model.get_delta_t())
    # A script's first step may trim the aircraft, which puts it elsewhere.
    is_flying = model.run()
    for step in range(steps):
        is_flying = is_flying and model.run()
        if not is_flying:
            break
        if step % every == 0:
            rows.append([model.get_sim_time(), *(model[name] for name in (*_PLACE, *_ATTITUDE))])
            report(progress, 0.0)
    return rows


@contextmanager
def _silent() -> Iterator[None]:
    """Discard what JSBSim prints to the descriptor of the standard output."""
    standard_output = 1
    with open(os.devnull, "wb") as discarded:  # noqa: PTH123 (a device)
        kept = os.dup(standard_output)
        os.dup2(discarded.fileno(), standard_output)
        try:
            yield
        finally:
            os.dup2(kept, standard_output)
            os.close(kept)
