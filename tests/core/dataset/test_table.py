from __future__ import annotations

import csv
import io

import numpy as np
import pytest
from terrainav.core.dataset import table as table_module
from terrainav.core.dataset.table import HEADERS, Table
from terrainav.core.errors import InvalidInput, OutputError

from tests.support.tables import table_of, text_of

#: Cells with what other readers take for the end of a line.
NOTES = (
    "",
    "plain",
    '"two\nlines"',
    '"a\rb"',
    '"a\r\nb"',
    "x\u2028y\u0085z\x0bw",
    "€ 𐍈",
    '"quoted ""cell"""',
)
PUBLISHED = "img_names,columns,rows,Lat,Lon,Alt,entropies"

#: Numbers that tables have where another column is not empty.
EMPTY = ("west", "north", "pixel_width", "pixel_height", "offset_bytes", "size_bytes")


def make_table(**changes) -> Table:
    count = 3
    numbers = {name: np.array([0.1, 1 / 3, 2.0]) for name in HEADERS}
    values = {
        **numbers,
        "img_names": ("0_0_a.tif", '1,0 "b".tif', "2_0_c.tif"),
        "columns": np.arange(count),
        "rows": np.zeros(count, np.int64),
        "zoom": np.full(count, 18),
        "entropies": np.array([7.123456789012345, 0.0, np.nan]),
        "left_px": np.array([123456789.0, 0.5, 3.0]),
        "crs": ("",) * count,
        "time_utc": ("",) * count,
        "shard": ("",) * count,
        **{name: np.full(count, np.nan) for name in EMPTY},
        "source": ("Synthetic (offline)",) * count,
        "attribution": ("© who, what",) * count,
        "imagery_date": ("2024-06-21",) * count,
        "status": ("done", "done", "failed"),
        "reason": ("", "", "no imagery (404)"),
    }
    return Table(**{**values, **changes})


def assert_same(one: Table, other: Table) -> None:
    for name in HEADERS:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)
    assert dict(one.other) == dict(other.other)


def test_table_survives_a_file_with_all_its_digits(tmp_path):
    table = make_table(other={"split": ("train", "test", "")})
    table.save(tmp_path / "meta_data.csv")
    assert_same(Table.load(tmp_path / "meta_data.csv"), table)


def test_a_crs_of_the_source_s_own_adds_its_columns(tmp_path):
    table = make_table(crs=("EPSG:3031",) * 3, west=np.array([0.1, -2.5, 1 / 3]), north=np.zeros(3))
    table.save(tmp_path / "meta_data.csv")
    assert_same(Table.load(tmp_path / "meta_data.csv"), table)
    headers = (tmp_path / "meta_data.csv").read_text().splitlines()[0].split(",")
    start = headers.index("image_height_px") + 1
    assert headers[start : start + 5] == ["crs", "west", "north", "pixel_width", "pixel_height"]


def test_shards_add_their_columns_with_whole_numbers(tmp_path):
    table = make_table(
        shard=("a-000000.tar", "a-000001.tar", ""),
        offset_bytes=np.array([512.0, 2.0**40, np.nan]),
        size_bytes=np.array([3381.0, 1.0, np.nan]),
    )
    table.save(tmp_path / "meta_data.csv")
    assert_same(Table.load(tmp_path / "meta_data.csv"), table)
    rows = list(csv.reader(io.StringIO((tmp_path / "meta_data.csv").read_text())))
    assert rows[0][-3:] == ["shard", "offset_bytes", "size_bytes"]
    assert rows[2][-3:] == ["a-000001.tar", "1099511627776", "1"]
    assert rows[3][-3:] == ["", "", ""]


def test_columns_are_the_published_ones_and_then_ours():
    rows = list(csv.reader(io.StringIO(text_of(make_table()))))
    assert ",".join(rows[0]) == (
        PUBLISHED
        + ",pose_lat_deg,pose_lon_deg,agl_m,yaw_deg,tilt_deg,roll_deg,height_m,left_px,top_px,width_px,height_px,"
        "image_width_px,image_height_px,fx_px,fy_px,cx_px,cy_px,sky_share,unmapped_share,facade_share,nominal_lat_deg,nominal_lon_deg,nominal_agl_m,"
        "nominal_yaw_deg,nominal_tilt_deg,nominal_roll_deg,source,attribution,imagery_date,status,reason"
    )
    first = dict(zip(rows[0], rows[1]))
    assert (first["columns"], first["Alt"], first["Lat"]) == ("0", "18", "0.1")
    assert first["left_px"] == "123456789"
    assert rows[2][rows[0].index("left_px")] == "0.5"
    assert rows[2][rows[0].index("Lat")] == repr(1 / 3)
    assert dict(zip(rows[0], rows[3]))["entropies"] == ""


def test_published_tables_are_read(tmp_path):
    text = ",img_names,columns,row,Lat,Lon,Alt,entropies\n0,0_1_35_-89_17.jpg,0,1,35.1,-89.9,17.0,5.25\n"
    (tmp_path / "meta_data.csv").write_bytes(b"\xef\xbb\xbf" + text.encode())
    table = Table.load(tmp_path / "meta_data.csv")
    assert table.img_names == ("0_1_35_-89_17.jpg",)
    assert (table.columns[0], table.rows[0], table.zoom[0]) == (0, 1, 17)
    assert (table.lat_deg[0], table.lon_deg[0], table.entropies[0]) == (35.1, -89.9, 5.25)
    assert np.isnan(table.agl_m[0])
    assert table.status == ("",)
    assert dict(table.other) == {}


def test_entropies_may_be_missing():
    table = table_of("img_names,columns,rows,Lat,Lon,Alt\na.jpg,0,1,35.1,-89.9,17\n")
    assert np.isnan(table.entropies).all()
    assert len(table) == 1


def test_tables_of_some_columns_know_nothing_of_the_others():
    known = {
        "img_names": ("a.jpg", "b.jpg"),
        "columns": np.arange(2),
        "rows": np.zeros(2, np.int64),
        "lat_deg": np.array([1.0, 2.0]),
        "lon_deg": np.array([3.0, 4.0]),
        "zoom": np.full(2, 17),
    }
    table = Table.from_columns(known, {"split": ("train", "")})
    assert table.status == ("", "")
    assert np.isnan(table.agl_m).all()
    assert_same(table_of(text_of(table)), table)


def test_an_empty_table_is_a_table():
    empty = make_table(**{n: (() if isinstance(getattr(make_table(), n), tuple) else np.empty(0)) for n in HEADERS})
    assert len(table_of(text_of(empty))) == 0


def test_bad_rows_are_named_by_line():
    rows = [
        "a.tif,0,0,35,-89,17,1",
        "b.tif,0,0,north,-89,17,1",
        "c.tif,0,0,35",
        "d.tif,0.5,0,35,-89,17,",
        "e.tif,0,0,,1,1,1",
    ]
    with pytest.raises(InvalidInput) as caught:
        table_of("\n".join([PUBLISHED, *rows]), "table x.csv")
    assert str(caught.value) == (
        "table x.csv: line 3 has Lat 'north', not a number; line 4 has 4 cells, not 7; "
        "line 5 has columns '0.5', not a whole number; and 1 more"
    )


@pytest.mark.parametrize("column", ["columns", "rows", "Alt"])
@pytest.mark.parametrize("cell", ["1e300", "-1e19", "9007199254740994"])
@pytest.mark.parametrize("quote", ["", '"'])
def test_whole_numbers_that_no_grid_or_zoom_has_are_refused(column, cell, quote):
    """Made a whole number of 64 bits, 1e300 is one of the least there are, or any other."""
    cells = {"columns": "0", "rows": "0", "Alt": "17", column: cell}
    row = f"{quote}a.tif{quote},{cells['columns']},{cells['rows']},35,-89,{cells['Alt']},1"
    with pytest.raises(InvalidInput, match=f"line 2 has {column} '{cell}', not from -"):
        table_of(f"{PUBLISHED}\n{row}\n")


@pytest.mark.parametrize("cell", ["nan", "inf", "", "1_20", "\u0661"])
def test_positions_must_be_finite(cell):
    with pytest.raises(InvalidInput, match="line 2 has Lon"):
        table_of(f"{PUBLISHED}\na.tif,0,0,35,{cell},17,1\n")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "has no column img_names"),
        (
            "img_names,columns,rows,Lat,Lon,entropies\n",
            "has no column Alt; needs img_names,columns,rows,Lat,Lon,Alt$",
        ),
        (f'{PUBLISHED}\n"a.tif,0', "line 2 is not CSV"),
    ],
)
def test_files_that_are_no_table_are_refused(text, message):
    with pytest.raises(InvalidInput, match=message):
        table_of(text)


def test_missing_and_unreadable_files_are_named(tmp_path):
    with pytest.raises(InvalidInput, match=r"table .*nothing\.csv: cannot be read"):
        Table.load(tmp_path / "nothing.csv")
    with pytest.raises(OutputError, match="cannot write"):
        make_table().save(tmp_path / "nowhere" / "meta_data.csv")


@pytest.mark.parametrize("block", [2, 7, 64, 1 << 20])
@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_files_read_in_blocks_are_as_read_at_once(tmp_path, monkeypatch, block, mark, end):
    monkeypatch.setattr(table_module, "_BLOCK_BYTES", block)
    rows = [f"{index}_é.jpg,{index},0,35,-89,17,1,{note}" for index, note in enumerate(NOTES)]
    path = tmp_path / "meta_data.csv"
    path.write_bytes(mark + end.join([f"{PUBLISHED},note", *rows, ""]).encode())
    table = Table.load(path)
    assert len(table) == len(NOTES)
    # Python's own reading of a text file, whole.
    assert_same(table, table_of(path.read_text(encoding="utf-8-sig")))


@pytest.mark.parametrize("bad", [b"\xff", b"\xe2\x82", b"\xc3\n"])
def test_bytes_that_are_no_text_are_told_by_their_place_in_the_file(tmp_path, bad):
    path = tmp_path / "meta_data.csv"
    # The row that is no number comes first, and is not what is told.
    path.write_bytes(f"{PUBLISHED}\na.tif,0,0,north,-89,17,1\n".encode() + b"b\xc3\xa9" + bad)
    with pytest.raises(UnicodeDecodeError) as wrong:
        path.read_text(encoding="utf-8")
    with pytest.raises(InvalidInput) as caught:
        Table.load(path)
    assert str(caught.value) == f"table {path}: cannot be read ({wrong.value})"


def test_columns_of_different_lengths_are_refused():
    with pytest.raises(InvalidInput, match="column lat_deg has 2 rows"):
        make_table(lat_deg=np.zeros(2))


def test_the_text_is_the_same_however_many_rows_are_made_at_a_time(tmp_path, monkeypatch):
    table = make_table()
    whole = text_of(table)
    monkeypatch.setattr("terrainav.core.dataset.table._ROWS_A_BLOCK", 2)
    assert text_of(table) == whole
    table.save(tmp_path / "meta_data.csv")
    assert (tmp_path / "meta_data.csv").read_text(encoding="utf-8") == whole
    assert_same(Table.load(tmp_path / "meta_data.csv"), table)
