"""Baseline without weights: silhouettes of buildings fitted to the masks of queries, near their priors."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Numbers
from ..dataset.label_images import read_label_image
from ..geodesy.ellipsoid import WGS84
from .answers import Answer, Locate, Query
from .folder import Benchmark
from .silhouettes import Silhouettes, overlap

#: First and last step of the search, metres: priors of a GNSS receiver are a few metres off.
_FIRST_M, _LAST_M = 8.0, 0.25
#: Most steps at one place of the search, so that it ends.
_MOST_STEPS = 100
#: Longest side of the compared images: the figures of larger ones are the same, and take longer.
_SIDE_PX = 160


def silhouette(benchmark: Benchmark, gallery: Numbers) -> Locate:  # noqa: ARG001  as all methods
    """Method that moves the camera from its prior to where the silhouettes of buildings overlap the mask most.

    Height and attitude are those of the query, as from a barometer, a compass and an inertial unit. The search compares
    eight neighbours, goes to the best one, and halves its step where none is better.

    Raises
    ------
    InvalidInput
        The benchmark has no buildings.
    """
    silhouettes = Silhouettes.from_benchmark(benchmark)

    def locate(query: Query) -> Answer:
        if query.instances is None or not math.isfinite(query.prior_lat_deg + query.prior_lon_deg):
            return Answer()
        index = benchmark.query_rows[query.id]
        whole = read_label_image(query.instances) > 0
        height, width = whole.shape
        coarser = max(-(-max(height, width) // _SIDE_PX), 1)
        size = max(width // coarser, 1), max(height // coarser, 1)
        # Pixels of the mask at the centres of the coarser pixels.
        rows, columns = ((2 * np.arange(to) + 1) * of // (2 * to) for to, of in zip(size[::-1], whole.shape))
        mask = whole[np.ix_(rows, columns)]
        per_lat = math.degrees(1.0 / float(WGS84.meridional_radius_m(np.array(query.prior_lat_deg))))
        per_lon = math.degrees(1.0 / WGS84.a_m) / max(math.cos(math.radians(query.prior_lat_deg)), 1e-3)

        def answer(east_m: float, north_m: float) -> Answer:
            lat, lon = query.prior_lat_deg + north_m * per_lat, query.prior_lon_deg + east_m * per_lon
            return Answer((), lat, lon, query.height_m, query.yaw_deg, query.tilt_deg, query.roll_deg)

        def fit(place: tuple[float, float]) -> float:
            one = answer(*place)
            pose = one.lat_deg, one.lon_deg, one.height_m, one.yaw_deg, one.tilt_deg, one.roll_deg
            return overlap(mask, silhouettes.render(index, pose, size)) if mask.any() else 0.0

        best, step_m = (0.0, 0.0), _FIRST_M
        most = fit(best)
        for _ in range(_MOST_STEPS):
            around = [
                (best[0] + across * step_m, best[1] + up * step_m)
                for across in (-1.0, 0.0, 1.0)
                for up in (-1.0, 0.0, 1.0)
                if across or up
            ]
            found = [fit(one) for one in around]
            if max(found) > most:
                most, best = max(found), around[int(np.argmax(found))]
            elif (step_m := step_m / 2.0) < _LAST_M:
                break
        return answer(*best)

    return locate
