"""Missions of every kind, for tests of properties that all missions have."""

from __future__ import annotations

from dataclasses import asdict

from hypothesis import strategies as st
from terrainav.core.fields import field_named
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.areas.area import Box, Points, Polygon, Polygons
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.parts import FLAT_PARTS, Imagery

TRIANGLE = Polygon(
    (((-89.9, 35.16), (-89.82, 35.16), (-89.86, 35.11)), ((-89.87, 35.15), (-89.85, 35.15), (-89.86, 35.14)))
)
SEVERAL = Polygons(
    (
        TRIANGLE,
        Polygon((((179.99, 10.0), (180.01, 10.0), (180.0, 10.01)),)),
        Polygon((((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)),)),
    )
)

areas = st.one_of(
    st.tuples(st.floats(0, 90), st.floats(-180, 180), st.floats(-90, 0), st.floats(-180, 180))
    .map(lambda v: Box(*v))
    .filter(lambda box: box.area_m2() > 0.0),
    st.just(TRIANGLE),
    st.just(SEVERAL),
    st.lists(st.tuples(st.floats(-90, 90), st.floats(-180, 180), st.floats(0.01, 1e6)), min_size=1, max_size=3).flatmap(
        lambda v: st.one_of(
            st.just(Points(tuple(v))),
            st.lists(st.floats(-360, 360), min_size=len(v), max_size=len(v)).map(
                lambda yaws: Points(tuple(v), tuple(yaws))
            ),
        )
    ),
)
missions = st.builds(
    Mission,
    area=areas,
    agl_m=st.floats(0.01, 1e6),
    camera=st.builds(Camera, st.floats(0.1, 179), st.floats(0.01, 100)),
    overlap_along=st.floats(0, 0.999),
    overlap_across=st.floats(0, 0.999),
    layout=st.sampled_from(["cover", "paper"]),
    map_types=st.permutations(list(field_named(Imagery, "map_types").choices)).map(lambda v: tuple(v[:2])),
    source=st.text(min_size=1).filter(lambda text: text.isprintable()),
    img_size=st.one_of(st.none(), st.just((64, 48, 1))),
    seed=st.integers(0, 2**31),
    yaw_deg=st.floats(-360, 360),
    tilt_deg=st.floats(-180, 180),
    roll_deg=st.floats(-180, 180),
    ground_height_m=st.floats(-12e3, 9e3),
    error_budget_px=st.floats(1e-9, 100),
    accept_error=st.booleans(),
    frame=st.sampled_from(["auto", "map", "camera"]),
    mesh=st.sampled_from(["auto", "rays"]),
    resampling=st.sampled_from(["nearest", "bilinear", "bicubic", "lanczos"]),
    wind=st.one_of(st.none(), st.builds(Wind, st.floats(0, 10), st.floats(0, 359), st.floats(0, 0.5))),
    row_azimuth_deg=st.floats(0, 360),
    crosshatch=st.booleans(),
    order=st.sampled_from(["serpentine", "one-way"]),
    airspeed_m_per_s=st.floats(11, 340),
    start=st.sampled_from(["2024-06-21T12:00:00Z", "1999-12-31T23:59:59.25Z"]),
    bands=st.sampled_from([(), ("4", "1", "2"), ("nir", "red")]),
    stretch=st.sampled_from(["none", "percentile", "-10 4000.5"]),
    date=st.sampled_from(["", "2024-06-21", "1950-1965", "2024-06-21T12:00:00Z"]),
    takeoff=st.sampled_from([(35.1, -89.8), (-12.5, 179.99)]),
    entry=st.sampled_from(["first", "north-west", "nearest"]),
    turnaround_m=st.floats(0, 1000),
    trigger=st.sampled_from(["waypoint", "distance", "hover"]),
    battery_min=st.one_of(st.none(), st.floats(0.1, 100)),
    drone=st.sampled_from(["mavic-3e", "m300", "dji-fly"]),
    crs=st.sampled_from(["", "EPSG:2056", 'PROJCS["local",GEOGCS["WGS 84"]]']),
)


#: Values of texts, lists and pairs other than their defaults; those of other fields follow from the declaration.
_OTHERS = {
    **dict.fromkeys(("k1", "k2", "k3", "k4", "k5", "k6"), 0.01),
    **dict.fromkeys(("p1", "p2"), 1e-3),
    "facing": "33.5",
    "start": "2024-06-21T12:00:00Z",
    "source": "pattern",
    "date": "2024-06-21",
    "bands": ("4", "1", "2"),
    "stretch": "-10 4000.5",
    "sun": "30 135",
    "crs": "EPSG:2056",
    "imageries": ("old=world@2014", "new=world"),
    "elevation": ("world",),
    "surface": ("world",),
    "buildings": ("houses.geojson",),
    "building_height_field": "HEIGHT",
    "labels": ("fields.gpkg:fields:crop",),
    "label_order": "rank",
    "vary": ("agl_m=uniform(90,150)",),
    "vertical_datum": "EPSG:5773",
    "takeoff": (35.1, -89.8),
    "img_size": (64, 48, 1),
    "skip_rows": "3,7-9",
    "split_after": "120,340",
    "exposure_ms": 2.5,
    "pixel_um": 3.45,
    "image_sensor": "Allied Vision Alvium 1800 C-507m",
    "exposure": "time",
    "shortest_exposure_ms": 0.5,
    "vignetting": "-0.2 0.05",
    "airlight": "200 210 220",
    "camera": Camera(k1=-0.1),
}
#: Fields that others require.
_NEEDED = {
    "surface": ("elevation",),
    "buildings": ("elevation",),
    "battery_min": ("takeoff",),
    "split_after": ("takeoff",),
    "motion_blur": ("exposure_ms",),
    "diffraction": ("pixel_um",),
    "keep_undistorted": ("camera",),
    **dict.fromkeys(
        (
            "quantum_efficiency",
            "full_well_e",
            "read_noise_e",
            "dark_current_e_per_s",
            "dsnu_e",
            "prnu",
            "gain_dn_per_e",
            "black_level_dn",
            "adc_bits",
            "bayer",
            "demosaicing",
        ),
        ("image_sensor",),
    ),
}


def other_value(field):
    """Valid value of a declared field other than its default."""
    if field.name in _OTHERS:
        return _OTHERS[field.name]
    if field.kind is bool:
        return not field.default
    if field.choices:
        other = next(choice for choice in field.choices if choice not in (field.default, *(field.default or ())))
        return (other,) if field.kind is tuple else other
    low = field.least if field.above is None else field.above
    high = field.most if field.below is None else field.below
    low, high = (0.0 if low is None else low), (low or 0.0) + 10.0 if high is None else high
    return next(
        value for value in (field.kind(low + share * (high - low)) for share in (0.25, 0.5)) if value != field.default
    )


def with_other(field):
    """Values by field: a value other than the default of a field, and values of the fields that it requires."""
    return {field.name: other_value(field), **{name: _OTHERS[name] for name in _NEEDED.get(field.name, ())}}


def whole_file(mission):
    """Mapping of a mission file that states every field, also those at their defaults."""
    parts = {name: getattr(mission, name) for name in ("camera", "wind", *FLAT_PARTS)}
    return {**mission.to_dict(), **{name: part and asdict(part) for name, part in parts.items()}}
