"""Sequences for other programs: EuRoC's layout (ASL), and ROS 2 bags as SQLite or MCAP.

Positions are in metres east, north and up of an origin, which ``origin.json`` describes. The body is the inertial unit.
"""

from __future__ import annotations

import heapq
import importlib
import io
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from ..arrays import Floats, NDArray, Numbers
from ..dataset.dataset import ImageSet, open_bands, read_dataset
from ..dataset.entropy import Report
from ..errors import InvalidInput, OutputError
from ..geodesy.contract import CAMERA_FILE, CameraContract
from ..geodesy.lens import FISHEYE
from ..geodesy.quaternions import quaternions_from_matrices, rotation_matrices
from ..sequences.files import (
    BAROMETER_FILE,
    GNSS_FILE,
    INERTIAL_FILE,
    MAGNETOMETER_FILE,
    TRAJECTORY_FILE,
    SequenceRecord,
)
from ..storage.files import csv_bytes, json_bytes, link_or_copy, make_folder, partial_folder, write_whole
from .huggingface import report_share
from .views import ORIGIN_FILE, Views, origin_record

#: Folder of a bag.
BAG_FOLDER = "bag"
#: Frames of the ROS messages.
_MAP, _IMU, _CAMERA = "map", "imu", "camera_optical"


@dataclass(frozen=True, eq=False)
class RecordedSequence:
    """A sequence with its frames of one map type.

    Parameters
    ----------
    record : SequenceRecord
    images : ImageSet
    views : Views
        Frames that were made.
    contract : CameraContract
    """

    record: SequenceRecord
    images: ImageSet
    views: Views
    contract: CameraContract

    @classmethod
    def read(cls, folder: str | os.PathLike[str], map_type: str | None = None) -> RecordedSequence:
        """Read the sequence of a folder; the first map type if ``map_type`` is None.

        Raises
        ------
        InvalidInput
            The folder holds no sequence or no frames, or frames of several cameras.
        """
        record = SequenceRecord.read(folder)
        dataset = read_dataset(folder)
        images = dataset.image_set(map_type or next(iter(dataset.image_sets)))
        views = Views.read(folder, images.map_type)
        if views.times_s is None:
            raise InvalidInput("folder {0}: its frames have no times", images.folder)
        if len({*views.contracts}) > 1:
            raise InvalidInput("folder {0}: its frames have several cameras, and a sequence has one", images.folder)
        return cls(record, images, views, views.contracts[0])

    @cached_property
    def stamps_ns(self) -> Numbers:
        """Times of the frames (n,)."""
        # Tables state whole milliseconds.
        stamps: Numbers = np.rint(np.asarray(self.views.times_s) * 1e3).astype(np.int64) * 1_000_000
        return stamps

    @cached_property
    def rows(self) -> list[int]:
        """Rows of the frames in the table."""
        at = {name: row for row, name in enumerate(self.images.table.img_names)}
        return [at[name] for name in self.views.names]

    @cached_property
    def truth(self) -> tuple[Numbers, Floats, Floats, Floats, Floats]:
        """Times, places, rotations from the body, velocities, all in the frame, and biases (n, 6)."""
        stamps, values = self.record.table(TRAJECTORY_FILE)
        frame = self.views.frame
        lat, lon, height = values[:, 0], values[:, 1], values[:, 2]
        to_frame = np.swapaxes(frame.rotations(lat, lon), -1, -2)
        rotations = to_frame @ rotation_matrices(values[:, 6:10])
        velocities = np.einsum("nij,nj->ni", to_frame, values[:, 3:6])
        return stamps, frame.enu(lat, lon, height), rotations, velocities, values[:, 10:16]

    def depth(self, row: int) -> NDArray[np.float32] | None:
        """Depth along the view (h, w) of a frame in metres, NaN without ground; None if it was not captured."""
        path = self.images.folder.parent / "depth" / f"{Path(self.images.table.img_names[row]).stem}.tif"
        if not path.is_file():
            return None
        stored = open_bands(path)
        return None if stored is None else np.asarray(stored.values(), np.float32).reshape(stored.size[::-1])


def write_sequence(
    folder: str | os.PathLike[str],
    target: str | os.PathLike[str],
    kind: str,
    map_type: str | None = None,
    progress: Report | None = None,
) -> int:
    """Write a sequence in a format; return the number of frames.

    Parameters
    ----------
    target : path
        A new or empty folder, whose name ends in ``.part`` until the export is complete.
    kind : str
        One of `WRITERS`.
    map_type : str or None
        Map type of the frames; None for the first.
    progress : callable
        Called with the share done, 0 to 1; returning False cancels, and removes the export.

    Raises
    ------
    Cancelled
        ``progress`` returned False.
    InvalidInput
        The folder holds no sequence, or one that the format cannot state.
    OutputError
        The folder cannot be written or is not empty, or a package is missing.
    """
    found = RecordedSequence.read(folder, map_type)
    with partial_folder(target) as root:
        WRITERS[kind](found, root, progress)
        write_whole(root / ORIGIN_FILE, json_bytes(origin_record(found.views.frame)))
        write_whole(root / CAMERA_FILE, json_bytes(found.contract.to_json()))
    return len(found.views)


# --- EuRoC


def _euroc(found: RecordedSequence, root: Path, progress: Report | None) -> None:
    """The layout of EuRoC's ASL files: ``mav0`` with camera, inertial unit and ground truth."""
    mav = root / "mav0"
    contract, record = found.contract, found.record
    fisheye, coefficients = contract.lens == FISHEYE, contract.coefficients
    if not fisheye and any(coefficients[4:]):
        raise InvalidInput(
            "lens with {0} coefficients: EuRoC's files state four", len(coefficients), remedy="write a bag (rosbag2)"
        )
    names = [f"{stamp}.png" for stamp in found.stamps_ns.tolist()]
    make_folder(mav / "cam0" / "data")
    for done, (row, name) in enumerate(zip(found.rows, names), 1):
        _write_png(found.images, row, mav / "cam0" / "data" / name)
        report_share(progress, done / len(names))
    rows = zip(found.stamps_ns.tolist(), names)
    write_whole(mav / "cam0" / "data.csv", csv_bytes([("#timestamp [ns]", "filename"), *rows]))
    k = contract.k
    distortion = (*coefficients, 0.0, 0.0, 0.0, 0.0)[:4]
    camera = {
        "sensor_type": "camera",
        "T_BS": record.camera_to_imu,
        "rate_hz": record.rate_hz,
        "resolution": [contract.width_px, contract.height_px],
        "camera_model": "pinhole",
        "intrinsics": [k[0, 0], k[1, 1], k[0, 2], k[1, 2]],
        "distortion_model": "equidistant" if fisheye else "radial-tangential",
        "distortion_coefficients": list(distortion),
    }
    _write_sensor(mav / "cam0", camera)
    stamps, values = record.table(INERTIAL_FILE)
    head = [f"w_RS_S_{axis} [rad s^-1]" for axis in "xyz"] + [f"a_RS_S_{axis} [m s^-2]" for axis in "xyz"]
    _write_asl(mav / "imu0", head, stamps, values)
    figures = {
        "gyroscope_noise_density": "gyro_noise",
        "gyroscope_random_walk": "gyro_walk",
        "accelerometer_noise_density": "accelerometer_noise",
        "accelerometer_random_walk": "accelerometer_walk",
    }
    imu = {
        "sensor_type": "imu",
        "T_BS": np.eye(4),
        "rate_hz": record.imu_rate_hz,
        **{name: record.imu_errors[field] for name, field in figures.items()},
    }
    _write_sensor(mav / "imu0", imu)
    stamps, places, rotations, velocities, biases = found.truth
    head = [
        *(f"p_RS_R_{axis} [m]" for axis in "xyz"),
        *(f"q_RS_{axis} []" for axis in "wxyz"),
        *(f"v_RS_R_{axis} [m s^-1]" for axis in "xyz"),
        *(f"b_w_RS_S_{axis} [rad s^-1]" for axis in "xyz"),
        *(f"b_a_RS_S_{axis} [m s^-2]" for axis in "xyz"),
    ]
    quaternions = quaternions_from_matrices(rotations)
    truth = np.concatenate([places, quaternions, velocities, biases], axis=1)
    _write_asl(mav / "state_groundtruth_estimate0", head, stamps, np.round(truth, 9) + 0.0)
    _write_sensor(mav / "state_groundtruth_estimate0", {"sensor_type": "visual-inertial", "T_BS": np.eye(4)})


def _write_png(images: ImageSet, row: int, path: Path) -> None:
    origin = images.path(row)
    if origin.suffix == ".png":
        link_or_copy(origin, path)
        return
    data = io.BytesIO()
    Image.fromarray(images.pixels(row, 3)).save(data, "PNG")
    write_whole(path, data.getvalue())


def _write_asl(folder: Path, head: list[str], stamps_ns: Numbers, values: Floats) -> None:
    make_folder(folder)
    rows = ([stamp, *row] for stamp, row in zip(stamps_ns.tolist(), values.tolist()))
    write_whole(folder / "data.csv", csv_bytes([("#timestamp [ns]", *head), *rows]))


def _write_sensor(folder: Path, values: Mapping[str, Any]) -> None:
    """Write ``sensor.yaml``, with matrices as EuRoC has them."""
    lines = []
    for name, value in values.items():
        if isinstance(value, np.ndarray):
            numbers = ", ".join(repr(float(one) + 0.0) for one in value.ravel())
            lines.append(f"{name}:\n  cols: {value.shape[1]}\n  rows: {value.shape[0]}\n  data: [{numbers}]\n")
        elif isinstance(value, list):
            lines.append(f"{name}: [{', '.join(repr(one + 0) for one in map(_plain, value))}]\n")
        else:
            lines.append(f"{name}: {value}\n")
    write_whole(folder / "sensor.yaml", "".join(lines).encode())


def _plain(number: Any) -> float | int:
    return number if isinstance(number, int) else float(number)


# --- ROS 2


class _Messages:
    """ROS 2 messages of a sequence in the order of their times."""

    def __init__(self, found: RecordedSequence, types: Mapping[str, Any], progress: Report | None) -> None:
        self._found, self._types, self._progress = found, types, progress

    def merged(self) -> Iterator[tuple[int, str, Any]]:
        """Yield time in nanoseconds, topic and message."""
        streams: list[Iterable[tuple[int, str, Any]]] = [
            self._static(),
            self._truth(),
            self._inertial(),
            self._places(),
            self._pressures(),
            self._fields(),
            self._frames(),
        ]
        yield from heapq.merge(*streams, key=lambda one: one[0])

    def make(self, kind: str, *values: Any) -> Any:
        """Message of a type such as ``sensor_msgs/Imu``."""
        package, _, name = kind.partition("/")
        return self._types[f"{package}/msg/{name}"](*values)

    def _header(self, stamp_ns: int, frame: str) -> Any:
        seconds, rest = divmod(stamp_ns, 1_000_000_000)
        return self.make("std_msgs/Header", self.make("builtin_interfaces/Time", seconds, rest), frame)

    def _vector(self, values: Floats) -> Any:
        return self.make("geometry_msgs/Vector3", *map(float, values))

    def _quaternion(self, rotation: Floats) -> Any:
        w, x, y, z = map(float, quaternions_from_matrices(rotation[np.newaxis])[0])
        return self.make("geometry_msgs/Quaternion", x, y, z, w)

    def _static(self) -> Iterator[tuple[int, str, Any]]:
        stamp = int(self._found.truth[0][0])
        mount = self._found.record.camera_to_imu
        transform = self.make("geometry_msgs/Transform", self._vector(mount[:3, 3]), self._quaternion(mount[:3, :3]))
        stamped = self.make("geometry_msgs/TransformStamped", self._header(stamp, _IMU), _CAMERA, transform)
        yield stamp, "/tf_static", self.make("tf2_msgs/TFMessage", [stamped])

    def _truth(self) -> Iterator[tuple[int, str, Any]]:
        stamps, places, rotations, velocities, _ = self._found.truth
        unknown = np.zeros(36)
        still = self._vector(np.zeros(3))
        for stamp, place, rotation, velocity in zip(stamps.tolist(), places, rotations, velocities):
            point = self.make("geometry_msgs/Point", *map(float, place))
            pose = self.make("geometry_msgs/Pose", point, self._quaternion(rotation))
            # Velocities are in the axes of the child frame.
            twist = self.make("geometry_msgs/Twist", self._vector(rotation.T @ velocity), still)
            yield (
                stamp,
                "/ground_truth",
                self.make(
                    "nav_msgs/Odometry",
                    self._header(stamp, _MAP),
                    _IMU,
                    self.make("geometry_msgs/PoseWithCovariance", pose, unknown),
                    self.make("geometry_msgs/TwistWithCovariance", twist, unknown),
                ),
            )

    def _inertial(self) -> Iterator[tuple[int, str, Any]]:
        record = self._found.record
        stamps, values = record.table(INERTIAL_FILE)
        unknown = np.array([-1.0, *np.zeros(8)])
        spread = [
            np.diag(np.full(3, record.imu_errors[name] ** 2 * record.imu_rate_hz)).ravel()
            for name in ("gyro_noise", "accelerometer_noise")
        ]
        level = self.make("geometry_msgs/Quaternion", 0.0, 0.0, 0.0, 1.0)
        for stamp, row in zip(stamps.tolist(), values):
            header, rate, force = self._header(stamp, _IMU), self._vector(row[:3]), self._vector(row[3:])
            message = self.make("sensor_msgs/Imu", header, level, unknown, rate, spread[0], force, spread[1])
            yield stamp, "/imu/data_raw", message

    def _places(self) -> Iterator[tuple[int, str, Any]]:
        stamps, values = self._found.record.table(GNSS_FILE)
        spread = np.diag(np.full(3, self._found.record.gnss_m**2)).ravel()
        no_fix, fix, gps, diagonal = -1, 0, 1, 2
        for stamp, (lat, lon, height) in zip(stamps.tolist(), values.tolist()):
            status = self.make("sensor_msgs/NavSatStatus", no_fix if np.isnan(lat) else fix, gps)
            header = self._header(stamp, _IMU)
            yield (
                stamp,
                "/gnss/fix",
                self.make("sensor_msgs/NavSatFix", header, status, lat, lon, height, spread, diagonal),
            )

    def _pressures(self) -> Iterator[tuple[int, str, Any]]:
        stamps, values = self._found.record.table(BAROMETER_FILE)
        for stamp, pressure in zip(stamps.tolist(), values[:, 0].tolist()):
            yield stamp, "/pressure", self.make("sensor_msgs/FluidPressure", self._header(stamp, _IMU), pressure, 0.0)

    def _fields(self) -> Iterator[tuple[int, str, Any]]:
        stamps, values = self._found.record.table(MAGNETOMETER_FILE)
        for stamp, field in zip(stamps.tolist(), values * 1e-9):
            header = self._header(stamp, _IMU)
            yield stamp, "/imu/mag", self.make("sensor_msgs/MagneticField", header, self._vector(field), np.zeros(9))

    def _frames(self) -> Iterator[tuple[int, str, Any]]:
        found, info = self._found, self._found.contract.ros
        d, k, r, p = (np.array(info[name]) for name in "dkrp")
        window = self.make("sensor_msgs/RegionOfInterest", 0, 0, 0, 0, False)
        size = info["height"], info["width"]
        for done, (stamp, row) in enumerate(zip(found.stamps_ns.tolist(), found.rows), 1):
            header = self._header(stamp, _CAMERA)
            shown = (header, *size, info["distortion_model"], d, k, r, p, 0, 0, window)
            yield stamp, "/camera/camera_info", self.make("sensor_msgs/CameraInfo", *shown)
            yield stamp, "/camera/image_raw", self._image(header, "rgb8", found.images.pixels(row, 3))
            depth = found.depth(row)
            if depth is not None:
                yield stamp, "/camera/depth", self._image(header, "32FC1", depth)
            report_share(self._progress, done / len(found.views))

    def _image(self, header: Any, encoding: str, pixels: NDArray[Any]) -> Any:
        height, width = pixels.shape[:2]
        data = np.ascontiguousarray(pixels).view(np.uint8).ravel()
        return self.make("sensor_msgs/Image", header, height, width, encoding, 0, data.size // height, data)


def _bag(found: RecordedSequence, root: Path, progress: Report | None, storage: str) -> None:
    """A ROS 2 bag with a storage of rosbags."""
    try:
        rosbag2, typesys = (importlib.import_module(f"rosbags.{name}") for name in ("rosbag2", "typesys"))
    except ImportError as missing:
        raise OutputError(
            "{0}, which writes bags, is not installed", "rosbags", remedy="get it with: pip install 'terrainav[ros]'"
        ) from missing
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    messages = _Messages(found, store.types, progress)
    plugin = rosbag2.StoragePlugin[storage]
    with rosbag2.Writer(root / BAG_FOLDER, version=9, storage_plugin=plugin) as writer:
        connections: dict[str, Any] = {}
        for stamp, topic, message in messages.merged():
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            writer.write(connections[topic], stamp, store.serialize_cdr(message, kind))


#: Writers by format.
WRITERS: Mapping[str, Callable[[RecordedSequence, Path, Report | None], None]] = {
    "euroc": _euroc,
    "rosbag2": lambda found, root, progress: _bag(found, root, progress, "SQLITE3"),
    "mcap": lambda found, root, progress: _bag(found, root, progress, "MCAP"),
}
