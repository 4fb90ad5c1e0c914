"""The paper's coordinate formats, as people type them."""

from __future__ import annotations

import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.areas.coords import parse_coords, parse_points

BOX = Box(35.22, -90.07, 35.06, -89.73)


@pytest.mark.parametrize(
    "text",
    [
        "35.22_-90.07_35.06_-89.73_400",
        "35.22, -90.07, 35.06, -89.73, 400",
        "35.22 \u221290.07 35.06 \u221289.73 400",
        " 35.22_\u221290.07_35.06_-89.73_4e2 ",
    ],
)
def test_a_box_in_every_spelling(text):
    assert parse_coords(text) == (BOX, 400.0)


def test_a_single_capture_and_its_unit():
    assert parse_coords("35.128039_-89.799163_126") == (Points(((35.128039, -89.799163, 126.0),)), 126.0)
    _, agl_m = parse_coords("35.128039_-89.799163_1000", agl_unit="ft")
    assert agl_m == pytest.approx(304.8)


def test_a_single_mission_takes_the_top_left_corner_of_a_box():
    area, _ = parse_coords("35.22_-90.07_35.06_-89.73_400", kind="single")
    assert area == Points(((35.22, -90.07, 400.0),))


def test_a_file_is_a_list(tmp_path):
    file = tmp_path / "sample_coords.txt"
    file.write_text(
        "\ufeff35.1 -89.8 126\n\n# a comment\n35,2; \u221289,9; 80\n".replace(
            "35,2; \u221289,9; 80", "35.2, \u221289.9, 80"
        )
    )
    area, agl_m = parse_coords(str(file))
    assert area == Points(((35.1, -89.8, 126.0), (35.2, -89.9, 80.0)))
    assert agl_m == 126.0
    assert parse_coords(str(file), kind="single")[0] == Points(((35.1, -89.8, 126.0),))


def test_lines_may_have_a_yaw(tmp_path):
    file = tmp_path / "points.txt"
    file.write_text("# lat lon agl yaw\n35.1 -89.8 126 -45.5\n35.2,-89.9,80,\u221290\n")
    area, agl_m = parse_coords(str(file), agl_unit="ft")
    assert agl_m == 126 * 0.3048
    assert area == Points(((35.1, -89.8, 126 * 0.3048), (35.2, -89.9, 80 * 0.3048)), (-45.5, -90.0))
    assert parse_coords(str(file), kind="single")[0] == Points(((35.1, -89.8, 126.0),), (-45.5,))


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        ("1 2 3\n4 5 6 7\n", r"line 2: '4 5 6 7' has 4 numbers and the lines before 3: give every point"),
        ("1 2 3 4\n\n4 5 6\n", r"line 3: '4 5 6' has 3 numbers and the lines before 4"),
        ("1 2 3 361\n", r"line 1: yaw 361.0 deg: must be from -360 to 360"),
        ("1 2 3 4 5\n", r"has 5 numbers; expected lat lon agl \[yaw\]"),
    ],
)
def test_yaws_that_cannot_be_are_named_with_their_line(tmp_path, lines, says):
    file = tmp_path / "points.txt"
    file.write_text(lines)
    with pytest.raises(InvalidInput, match=says):
        parse_coords(str(file))


def test_one_place_is_three_numbers():
    with pytest.raises(InvalidInput, match="4 numbers"):
        parse_coords("35.1_-89.8_126_45")


@pytest.mark.parametrize("unit", ["m", "ft"])
def test_coordinates_without_a_height_take_the_one_given(unit):
    """It is in metres already; a height of their own counts before it."""
    box, point = Box(35.16, -89.9, 35.115, -89.823), (35.1, -89.8)
    assert parse_coords("35.16_-89.90_35.115_-89.823", agl_unit=unit, agl_m=90.0) == (box, 90.0)
    assert parse_coords("35.1, -89.8", agl_unit=unit, agl_m=90.0) == (Points(((*point, 90.0),)), 90.0)
    assert parse_coords("35.16 -89.90 35.115 -89.823", "single", unit, 90.0)[0].poses == ((35.16, -89.9, 90.0),)
    assert parse_coords("35.1_-89.8_120", agl_m=90.0)[1] == 120.0


@pytest.mark.parametrize(
    ("text", "kind", "says"),
    [
        ("", None, "empty"),
        ("35.1_-89.8", None, "2 numbers"),
        ("35.1_-89.8_120_7", None, "4 numbers"),
        ("35.1_-89.8_x", None, "'x'"),
        ("nofile.txt", None, "nofile.txt"),
        ("35.1_-89.8_120", "raster", "two corners"),
        ("91_-89.8_120", None, "latitude 91.0: must be within -90 and 90"),
        ("35_-89.8_0", None, "height above ground 0.0 m: must be above 0"),
        ("35_-89.8_nan", None, "height above ground nan"),
        ("35.06_-90.07_35.22_-89.73_400", None, "south lies above north"),
        ("35.22_-90.07_35.06_-89.73_400", "circle", "must be one of single, list, raster"),
    ],
)
def test_what_cannot_be_read_is_named(text, kind, says):
    with pytest.raises(InvalidInput) as refused:
        parse_coords(text, kind)
    assert says in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("line", "says"),
    [("35.1 -89.8", "has 2 numbers"), ("a b c", "'a'"), ("35.1 -89.8 -5", "-5.0 m"), ("99 0 5", "99.0")],
)
def test_a_bad_line_of_a_file_is_named_by_number(tmp_path, line, says):
    file = tmp_path / "points.txt"
    file.write_text(f"35.1 -89.8 120\n{line}\n")
    with pytest.raises(InvalidInput) as refused:
        parse_coords(str(file))
    assert "points.txt, line 2" in str(refused.value)
    assert says in str(refused.value)


@pytest.mark.parametrize("content", [b"", b"# nothing\n", b"\xff\xfe\x00bad"])
def test_a_file_without_coordinates_is_refused(tmp_path, content):
    file = tmp_path / "points.txt"
    file.write_bytes(content)
    with pytest.raises(InvalidInput, match=r"points\.txt"):
        parse_coords(str(file))


def test_a_text_too_long_for_a_name_is_no_file():
    with pytest.raises(InvalidInput, match="is not a number"):
        parse_coords("x" * 300)


def test_pasted_lines_are_read_as_a_files_are():
    lines = ["# two", "", "35.1 -89.8 100 5", "35.2 -89.9 200 -5"]
    points = parse_points(lines, agl_unit="ft")
    assert points == Points(((35.1, -89.8, 30.48), (35.2, -89.9, 60.96)), (5.0, -5.0))
    with pytest.raises(InvalidInput, match=r"^coordinates, line 2: 'x': 'x' is not a number"):
        parse_points(["1 2 3", "x"])
    with pytest.raises(InvalidInput, match=r"^list: holds no coordinates; expected lines of lat lon agl"):
        parse_points(["# nothing"], "list")


@pytest.mark.parametrize("name", ["gone.txt", "folder/gone.CSV"])
def test_files_that_are_not_there_are_said_to_be_missing(name):
    with pytest.raises(InvalidInput, match="there is no such file"):
        parse_coords(name)
