"""The Night Vision supplement's layout."""

from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.dataset.clean import clean
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.table import Table, image_parts, usable_rows
from terrainav.core.dataset.vbn import parse_position
from terrainav.core.errors import InvalidInput

from tests.support.published import picture, write_vbn


def images_of(folder):
    return read_dataset(folder, "VBN").image_sets["camera"]


def test_images_and_texts_belong_together_by_name(tmp_path):
    write_vbn(tmp_path, ["a_2", "a_10", "a_1"])
    images = images_of(tmp_path)
    table = images.table
    # 2 before 10, while each has the text of its own name.
    assert table.img_names == ("a_1.jpg", "a_2.jpg", "a_10.jpg")
    np.testing.assert_allclose(table.lat_deg, [35.02, 35.00, 35.01])
    np.testing.assert_allclose(table.lon_deg, [-89.96, -90.0, -89.98])
    np.testing.assert_array_equal(table.pose_lat_deg, table.lat_deg)
    assert table.other["altitude_m"] == ("1002.5", "1000.5", "1001.5")
    assert table.other["Image_name"] == ("frame 2", "frame 0", "frame 1")
    assert table.other["Platform_orientation"] == ("0 0 2", "0 0 0", "0 0 1")
    assert np.isnan(table.agl_m).all()
    assert images.made.all()
    assert images.path(2) == tmp_path / "JPG2" / "a_10.jpg"
    np.testing.assert_array_equal(images.pixels(0).shape, (48, 64, 3))


def test_the_table_of_a_supplement_survives_a_file(tmp_path):
    write_vbn(tmp_path, ["1", "2"])
    table = images_of(tmp_path).table
    table.save(tmp_path / "meta_data.csv")
    again = Table.load(tmp_path / "meta_data.csv")
    assert again.img_names == table.img_names
    assert dict(again.other) == dict(table.other)
    np.testing.assert_array_equal(again.lat_deg, table.lat_deg)


def test_without_a_name_in_common_the_order_counts_and_one_text_may_be_left(tmp_path):
    images = [f"img{number}" for number in range(1, 12)]
    texts = [f"meta_{number}" for number in range(1, 13)]
    write_vbn(tmp_path, images, texts=texts)
    read = images_of(tmp_path)
    assert read.table.img_names == (*(f"{name}.jpg" for name in images), "meta_12.jpg")
    np.testing.assert_allclose(read.table.lat_deg, 35.0 + np.arange(12) / 100.0)
    assert np.flatnonzero(~read.made).tolist() == [11]
    assert read.table.reason[11] == "no image in JPG2"


def test_a_text_without_its_image_is_a_row_that_failed(tmp_path):
    write_vbn(tmp_path, ["1", "2", "3"])
    (tmp_path / "JPG2" / "2.jpg").unlink()
    table = images_of(tmp_path).table
    assert table.img_names == ("1.jpg", "2.jpg", "3.jpg")
    assert table.status == ("done", "failed", "done")
    assert table.reason == ("", "no image in JPG2", "")


def test_images_without_a_text_are_named(tmp_path):
    write_vbn(tmp_path, ["1", "2", "3", "4", "5"], texts=["5"])
    with pytest.raises(InvalidInput, match=r"1\.jpg, 2\.jpg, 3\.jpg, and 1 more of JPG2 without a text in MetaData2"):
        images_of(tmp_path)


def test_numbers_that_do_not_fit_are_refused_without_names_in_common(tmp_path):
    write_vbn(tmp_path, ["a", "b"], texts=["c", "d", "e", "f"])
    with pytest.raises(InvalidInput, match="has 2 images in JPG2 and 4 texts in MetaData2, with no name in common"):
        images_of(tmp_path)


@pytest.mark.parametrize(
    "value",
    [
        " 35.5 -90.25 1000.0 ",
        " 35.5 -90.25 1000.0 m",
        " degrees 35.5 -90.25 1000.0",
        " degrees 35.5 -90.25 1000.0 end",
        "word 35.5 -90.25 1000.0 end",
        "word 35.5 -90.25 1000.0 ",
        " 35.5 -90.25 1000.0 0",
        " 35.5  -90.25\t1000.0",
        "7 35.5 -90.25 1000.0 ",
    ],
)
def test_positions_between_two_words(value):
    assert parse_position(value) == (35.5, -90.25, 1000.0)


def test_the_paper_program_would_read_the_same_numbers():
    """Its reader cuts at single spaces, and leaves the first and the last piece out."""
    for value in (" 35.5 -90.25 1000.0 ", " 35.5 -90.25 1000.0 0", "word 35.5 -90.25 1000.0 end"):
        assert parse_position(value) == tuple(map(float, value.split(" ")[1:-1]))


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("", "is not a word and latitude"),
        (" 35.5 -90.25 ", "is not a word and latitude"),
        (" 35.5 west 1000 ", "is not a word and latitude"),
        (" 35.5 nan 1000 ", "is not a word and latitude"),
        (" 1 35.5  -90.25 1000 2", "is not a word and latitude"),
        (" 95.5 -90.25 1000 ", "is not on the Earth"),
    ],
)
def test_positions_that_are_none_are_refused(value, said):
    with pytest.raises(InvalidInput, match=said):
        parse_position(value)


def test_texts_that_cannot_be_read_are_all_named(tmp_path):
    write_vbn(tmp_path, ["1", "2", "3", "4", "5", "6"])
    texts = tmp_path / "MetaData2"
    (texts / "1.txt").write_bytes(b"\xff\xfe\x00")
    (texts / "2.txt").write_text("Platform_position_LatLongAlt: 1 2\n")
    (texts / "3.txt").write_text("Image_name: x\n")
    (texts / "5.txt").write_text("nothing of use\n")
    with pytest.raises(InvalidInput) as caught:
        images_of(tmp_path)
    said = str(caught.value)
    assert "1.txt cannot be read" in said
    assert "2.txt: Platform_position_LatLongAlt '1 2' is not a word" in said
    assert "3.txt has no Platform_position_LatLongAlt; and 1 more" in said


@pytest.mark.parametrize("twice", ["JPG2/2.JPG", "MetaData2/2.TXT"])
def test_two_files_of_one_name_are_refused(tmp_path, twice):
    write_vbn(tmp_path, ["1", "2"])
    other = tmp_path / twice
    if other.exists():
        pytest.skip("names differ by more than case on this disk")
    other.write_bytes(b"")
    with pytest.raises(InvalidInput, match=rf"2\{other.suffix.lower()} more than once"):
        images_of(tmp_path)


def test_a_key_twice_is_named(tmp_path):
    write_vbn(tmp_path, ["1", "2"])
    path = tmp_path / "MetaData2" / "2.txt"
    path.write_text(path.read_text() * 2)
    with pytest.raises(InvalidInput, match=r"2\.txt has a key more than once"):
        images_of(tmp_path)


def test_keys_that_are_columns_of_ours_are_kept_under_another_name(tmp_path):
    write_vbn(tmp_path, ["1"])
    path = tmp_path / "MetaData2" / "1.txt"
    path.write_text(path.read_text() + "Alt: 7\nTime: 12:30:05\n")
    table = images_of(tmp_path).table
    assert table.other["VBN Alt"] == ("7",)
    # Neither rejected nor split by words of the supplement's, and none lost to another of its new name.
    more = "row: 5\nrejected: yes\nsplit: north\nVBN Lat: a\nLat: b\nstatus: failed\n"
    path.write_text(path.read_text() + more)
    images = images_of(tmp_path)
    assert images.made.all()
    assert usable_rows(images.table).all()
    assert image_parts(images.table) is None
    images.table.save(tmp_path / "meta_data.csv")
    other = Table.load(tmp_path / "meta_data.csv").other
    assert (other["VBN Lat"], other["VBN VBN Lat"]) == (("a",), ("b",))
    assert [other[f"VBN {key}"] for key in ("row", "rejected", "split")] == [("5",), ("yes",), ("north",)]
    assert table.other["Time"] == ("12:30:05",)
    assert table.zoom.tolist() == [0]


def test_folders_without_images_are_refused(tmp_path):
    write_vbn(tmp_path, [])
    with pytest.raises(InvalidInput, match=r"JPG2: has no \.jpg images"):
        images_of(tmp_path)
    picture(0).save(tmp_path / "JPG2" / "1.JPG", "JPEG")
    (tmp_path / "MetaData2").rmdir()
    with pytest.raises(InvalidInput, match="MetaData2 in it cannot be read"):
        images_of(tmp_path)


def test_what_is_no_file_is_no_image_and_is_never_opened(tmp_path):
    write_vbn(tmp_path, ["1", "2"])
    (tmp_path / "JPG2" / "2.jpg").unlink()
    # A named pipe, which would be waited at without end, is no file either.
    (tmp_path / "JPG2" / "2.jpg").mkdir()
    assert images_of(tmp_path).made.tolist() == [True, False]


def test_cleaning_a_supplement_says_to_convert_it(tmp_path):
    write_vbn(tmp_path, ["1"])
    with pytest.raises(InvalidInput, match="terrainav convert --dataset VBN"):
        clean(tmp_path)
