"""SIFT or ORB features and a pose from their matches: baselines without weights, through OpenCV.

Keypoints of the mosaic are detected once, block by block, and keypoints of a query are matched to them by Lowe's ratio
test. As mosaic keypoints have known positions, PnP with RANSAC finds the pose (Lepetit, Moreno-Noguer, Fua, IJCV 2009).
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Bytes, Floats, Numbers
from ..dataset.dataset import open_image
from ..errors import OutputError
from ..geodesy.camera import attitude_from_axes
from ..geodesy.local import LocalFrame
from .answers import POSE, Answer, Locate, Query
from .folder import Benchmark

#: Fewest matches for a pose: twice the four that determine one.
_LEAST_MATCHES = 8


class _Detector(NamedTuple):
    """Names in OpenCV of a detector and of the norm of its descriptors."""

    make: str
    norm: str


_KINDS = {"sift": _Detector("SIFT_create", "NORM_L2"), "orb": _Detector("ORB_create", "NORM_HAMMING")}


def _opencv() -> Any:
    try:
        return importlib.import_module("cv2")
    except ImportError as missing:
        raise OutputError(
            "OpenCV, which finds and matches features, is not installed",
            remedy="get it with: pip install opencv-python-headless",
        ) from missing


def _features(kind: str, benchmark: Benchmark, gallery: Numbers) -> Locate:
    return _Features(kind, benchmark, gallery).locate


sift, orb = partial(_features, "sift"), partial(_features, "orb")


class _Features:
    def __init__(self, kind: str, benchmark: Benchmark, gallery: Numbers) -> None:
        self._cv, self._kind = _opencv(), _KINDS[kind]
        self._mosaic = benchmark.mosaic
        found = [
            self._detect(block, left, top, 20_000) for block, left, top in _blocks(benchmark.grey(self._mosaic.file))
        ]
        self._points = np.concatenate([points for points, _ in found])
        self._descriptors = np.concatenate([one for _, one in found if one is not None])
        self._matcher = self._cv.BFMatcher(getattr(self._cv, self._kind.norm))
        tiles = benchmark.references
        column, row = benchmark.mosaic.px(tiles.lat_deg[gallery], tiles.lon_deg[gallery])
        half = (tiles.east - tiles.west)[gallery] / benchmark.mosaic.pixel_width / 2.0
        self._tiles = column - half, column + half, row - half, row + half
        self._ids = [tiles.id[at] for at in gallery.tolist()]

    def _detect(self, grey: Bytes, left: int, top: int, most: int) -> tuple[Floats, Any]:
        """Positions (n, 2) of up to ``most`` keypoints in the whole image, and their descriptors (None without any)."""
        finder = getattr(self._cv, self._kind.make)(most)
        keypoints, descriptors = finder.detectAndCompute(grey, None)
        # OpenCV counts from the centre of the first pixel.
        places = np.array([one.pt for one in keypoints], np.float64).reshape(-1, 2) + 0.5
        return places + np.array([left, top]), descriptors

    def locate(self, query: Query) -> Answer:
        """Localise a query; the answer has no pose if too few matches agree on one."""
        grey = np.asarray(open_image(query.image, as_shown=True).convert("L"), np.uint8)
        points, descriptors = self._detect(grey, 0, 0, 2_000)
        if descriptors is None or len(self._descriptors) < 2:
            return Answer()
        pairs = self._matcher.knnMatch(descriptors, self._descriptors, k=2)
        # Lowe's ratio test, with the threshold of his paper (IJCV 2004).
        good = [first for first, second in pairs if first.distance < 0.8 * second.distance]
        image = points[[one.queryIdx for one in good]].reshape(-1, 2)
        ground = self._points[[one.trainIdx for one in good]].reshape(-1, 2)
        pose = self._pose(query, image, ground) if len(good) >= _LEAST_MATCHES else None
        if pose is None:
            return Answer(self._rank_tiles(ground))
        values, agree = pose
        return Answer(self._rank_tiles(ground[agree]), **values)

    def _pose(self, query: Query, image: Floats, ground: Floats) -> tuple[dict[str, float], Numbers] | None:
        """Pose of a query and indices of the matches that agree on it; None if too few agree."""
        lat, lon = self._mosaic.ground(ground[:, 0], ground[:, 1])
        frame = LocalFrame(float(np.median(lat)), float(np.median(lon)), query.ground_m)
        points = frame.enu(lat, lon, np.full(len(lat), query.ground_m))
        focal = np.array([[query.fx_px, 0.0, query.cx_px], [0.0, query.fy_px, query.cy_px], [0.0, 0.0, 1.0]])
        cv = self._cv
        # Reset for each query, so that answers do not depend on the order of queries.
        cv.setRNGSeed(0)
        found, rotation, shift, agree = cv.solvePnPRansac(
            points,
            image,
            focal,
            None,
            iterationsCount=5_000,
            reprojectionError=4.0,
            confidence=0.999,
            flags=cv.SOLVEPNP_SQPNP,
        )
        if not found or agree is None or len(agree) < _LEAST_MATCHES:
            return None
        agree = agree.ravel()
        rotation, shift = cv.solvePnPRefineLM(points[agree], image[agree], focal, None, rotation, shift)
        matrix = cv.Rodrigues(rotation)[0]
        place = -(matrix.T @ shift).ravel()
        position = tuple(float(value) for value in frame.geodetic(place))
        # Rows of the matrix are the camera's right, down and optical axis; attitudes refer to the camera's position.
        right, down, axis = matrix @ frame.rotations(*position[:2]).T
        attitude = (float(angle) for angle in attitude_from_axes(right, -down, axis))
        if position[2] <= query.ground_m:
            return None
        return dict(zip(POSE, (*position, *attitude))), agree.astype(np.int64)

    def _rank_tiles(self, ground: Floats) -> list[str]:
        """Rank tiles by their number of matches; omits tiles without any."""
        left, right, top, bottom = (side[:, np.newaxis] for side in self._tiles)
        x, y = ground[:, 0], ground[:, 1]
        count = ((x >= left) & (x < right) & (y >= top) & (y < bottom)).sum(axis=1)
        order = np.argsort(-count, kind="stable")[:100]
        return [self._ids[at] for at in order.tolist() if count[at]]


def _blocks(grey: Bytes) -> Iterator[tuple[Bytes, int, int]]:
    """Blocks of an image, and their left and top edges."""
    high, wide = grey.shape
    # Blocks overlap by more than a keypoint's neighbourhood, so that each neighbourhood is whole in some block.
    step, size = 2048, 2048 + 64
    for top in range(0, high, step):
        for left in range(0, wide, step):
            yield np.ascontiguousarray(grey[top : top + size, left : left + size]), left, top
