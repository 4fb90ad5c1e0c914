"""Camera frames of a dataset for photogrammetry: intrinsics, and poses in one local frame in metres."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Floats, NDArray, Numbers
from ..dataset.dataset import read_dataset
from ..dataset.folder import MISSION_FILE
from ..dataset.ground import are_camera_frames, check_poses
from ..dataset.labels import middle_position
from ..dataset.table import Table, unix_seconds, usable_rows
from ..errors import InvalidInput, Message, OptionName
from ..geodesy.camera import Poses, image_axes
from ..geodesy.contract import CONVENTIONS, SCHEMA, CameraContract
from ..geodesy.local import LocalFrame
from ..mission.flight.rates import Rates
from ..mission.lenses import CaptureCameras
from ..mission.mission import Mission
from ..mission.takes import RATE_COLUMNS

ORIGIN_FILE = "origin.json"


class ViewMotion(NamedTuple):
    """Motion of cameras (n,) while their images are taken.

    Attributes
    ----------
    exposure_s, readout_s : array
        Exposure times that blur the images, and times in which all their rows are read; 0 for none.
    rates : Rates
    """

    exposure_s: Floats
    readout_s: Floats
    rates: Rates

    @classmethod
    def of_table(cls, table: Table, rows: NDArray[np.int64]) -> ViewMotion | None:
        """Motion that a table states of some of its rows; None if it states none."""
        stated = {
            name: np.array([float(column[row]) for row in rows.tolist()])
            for name, column in table.other.items()
            if name in _STATED and all(column[row] for row in rows.tolist())
        }
        if not {"row_time_us", *RATE_COLUMNS} <= set(stated):
            return None
        blur_s = stated["exposure_ms"] * 1e-3 if "exposure_instants" in stated else np.zeros(len(rows))
        read_s = stated["row_time_us"] * 1e-6 * table.image_height_px[rows]
        return cls(blur_s, read_s, Rates(*(stated[name] for name in RATE_COLUMNS)))


#: Columns that state motion.
_STATED = {"row_time_us", "exposure_ms", "exposure_instants", *RATE_COLUMNS}


@dataclass(frozen=True, eq=False)
class Views:
    """The n camera frames of a map type that neither failed nor are rejected.

    Parameters
    ----------
    folder : Path
        Folder of the images.
    names : tuple of str
        File names.
    cameras : CaptureCameras
        Cameras of the images, whose lenses may distort.
    width_px, height_px, fx_px, fy_px, cx_px, cy_px : array (n,)
        Sizes, focal lengths and principal points; (0.5, 0.5) is the centre of the first pixel.
    lat_deg, lon_deg, height_m : array (n,)
        Positions of the cameras; heights are above the WGS 84 ellipsoid.
    yaw_deg, tilt_deg, roll_deg : array (n,)
        As for `Camera.rays_enu`.
    times_s : array (n,) or None
        Unix seconds; None if any image has no time.
    motion : ViewMotion or None
        Motion that blurs or skews images; None for images without.
    """

    folder: Path
    names: tuple[str, ...]
    cameras: CaptureCameras
    width_px: Numbers
    height_px: Numbers
    fx_px: Floats
    fy_px: Floats
    cx_px: Floats
    cy_px: Floats
    lat_deg: Floats
    lon_deg: Floats
    height_m: Floats
    yaw_deg: Floats
    tilt_deg: Floats
    roll_deg: Floats
    times_s: Floats | None = None
    motion: ViewMotion | None = None

    def __len__(self) -> int:
        return len(self.names)

    @property
    def pinholes(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Focal lengths and principal points, (n,) each."""
        return self.fx_px, self.fy_px, self.cx_px, self.cy_px

    def contract(self, index: int) -> CameraContract:
        """What the pixels of an image mean."""
        size_px = int(self.width_px[index]), int(self.height_px[index])
        fx, fy, cx, cy = (float(lengths[index]) for lengths in self.pinholes)
        return CameraContract.of_lens(self.cameras.of(index), size_px, (fx, fy), (cx, cy))

    @cached_property
    def contracts(self) -> tuple[CameraContract, ...]:
        """Contracts of all images as files state them."""
        return tuple(self.contract(index).rounded for index in range(len(self)))

    def camera_record(self) -> dict[str, Any]:
        """Content of `CAMERA_FILE` for an export, JSON-ready: intrinsics of all images or, if they differ, of each."""
        if len({*self.contracts}) == 1:
            return self.contracts[0].to_json()
        images = {name: one.intrinsics for name, one in zip(self.names, self.contracts)}
        return {"schema": SCHEMA, **CONVENTIONS, "images": images}

    @cached_property
    def frame(self) -> LocalFrame:
        """Local frame in metres, with its origin on the ellipsoid in the middle of the cameras."""
        lat, lon = middle_position(self.lat_deg, self.lon_deg)
        return LocalFrame(round(lat, 6), round(lon, 6))

    @cached_property
    def centres_m(self) -> Floats:
        """Positions of the cameras in the frame, (n, 3)."""
        return self.frame.enu(self.lat_deg, self.lon_deg, self.height_m)

    @cached_property
    def rotations(self) -> Floats:
        """Rotations (n, 3, 3) from the frame to the camera's right, down and view (OpenCV's axes)."""
        attitude = self.yaw_deg, self.tilt_deg, self.roll_deg
        return camera_rotations(self.frame, self.lat_deg, self.lon_deg, *attitude)

    def velocities(self, rates: Rates) -> tuple[Floats, Floats]:
        """Velocities in m/s and turn rates in rad/s of the cameras, along and about their axes (OpenCV's), (n, 3) each.

        Turns are right-handed: about the axis to the right, the camera turns from down to its view.
        """
        after_s = 1e-3
        poses = Poses(self.lat_deg, self.lon_deg, self.height_m, self.yaw_deg, self.tilt_deg, self.roll_deg)
        lat, lon, height_m, *attitude = rates.moved(poses, after_s)
        way = (self.frame.enu(lat, lon, height_m) - self.centres_m) / after_s
        turned = self.rotations @ np.swapaxes(camera_rotations(self.frame, lat, lon, *attitude), 1, 2)
        skew = (turned - np.swapaxes(turned, 1, 2)) / (2.0 * after_s)
        turns = np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)
        return np.einsum("nij,nj->ni", self.rotations, way), turns

    @classmethod
    def read(cls, folder: str | os.PathLike[str], map_type: str | None = None) -> Views:
        """Views of one map type of a dataset; of the first if ``map_type`` is None.

        Raises
        ------
        InvalidInput
            The folder is not a capture, lacks the map type, has no image, or has map frames only.
        """
        path = Path(folder)
        dataset = read_dataset(path)
        images = dataset.image_set(map_type or next(iter(dataset.image_sets)))
        if not (path / MISSION_FILE).is_file():
            raise InvalidInput("folder {0}: has no {1}, which describes the camera", folder, MISSION_FILE)
        mission = Mission.load(path / MISSION_FILE)
        table = images.table
        rows = np.flatnonzero(usable_rows(table))
        if not len(rows):
            raise InvalidInput("folder {0}: has no image to export", images.folder)
        if not are_camera_frames(images, rows, path):
            raise InvalidInput(
                "folder {0}: its images are windows of the map, which no camera takes",
                images.folder,
                remedy=Message("capture camera frames ({0} camera)", OptionName("frame")),
            )
        check_poses(images, rows, needed=True)
        heights = table.height_m[rows]
        level = table.agl_m[rows] + mission.flight.ground_height_m
        times = unix_seconds([table.time_utc[row] for row in rows.tolist()])
        width, height = (size[rows] for size in (table.image_width_px, table.image_height_px))
        cameras = CaptureCameras.drawn(mission, table.columns[rows], table.rows[rows], images.map_type)
        tan_x, tan_y, right, down = cameras.each(
            lambda camera: (*camera.half_tangents, camera.principal_x, camera.principal_y)
        )
        return cls(
            images.image_folder,
            tuple(table.img_names[row] for row in rows.tolist()),
            cameras,
            width.astype(np.int64),
            height.astype(np.int64),
            width / 2.0 / tan_x,
            height / 2.0 / tan_y,
            width * (0.5 + right),
            height * (0.5 + down),
            table.pose_lat_deg[rows],
            table.pose_lon_deg[rows],
            np.where(np.isnan(heights), level, heights),
            table.yaw_deg[rows],
            table.tilt_deg[rows],
            table.roll_deg[rows],
            times if np.isfinite(times).all() else None,
            ViewMotion.of_table(table, rows),
        )


def camera_rotations(
    frame: LocalFrame, lat_deg: Floats, lon_deg: Floats, yaw_deg: Floats, tilt_deg: Floats, roll_deg: Floats
) -> Floats:
    """Rotations (n, 3, 3) from a frame's east, north and up to the right, down and view of cameras (n,)."""
    right, image_up, axis = image_axes(yaw_deg, tilt_deg, roll_deg)
    local = np.stack([right, -image_up, axis], axis=1)
    # Attitudes refer to north and up at each camera.
    turns = [frame.rotations(lat, lon) for lat, lon in zip(lat_deg.tolist(), lon_deg.tolist())]
    found: Floats = local @ np.array(turns).reshape(-1, 3, 3)
    return found


def origin_record(frame: LocalFrame) -> dict[str, object]:
    """Content of `ORIGIN_FILE` for a frame, JSON-ready."""
    return {
        "lat_deg": frame.lat_deg,
        "lon_deg": frame.lon_deg,
        "height_m": frame.height_m,
        "datum": "WGS 84 ellipsoid",
        "axes": ["east", "north", "up"],
        "unit": "m",
    }
