"""Pictures of every kind come out as 8-bit RGB; what is none, or not whole, does not come out."""

from __future__ import annotations

import io
import struct
import tracemalloc
import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image, ImageFile
from terrainav.core.errors import PartError
from terrainav.core.imagery import decode as decode_module
from terrainav.core.imagery.decode import decode, refuse_flat, refuse_marked
from terrainav.core.imagery.http.client import BrokenPictureError
from terrainav.core.imagery.placeholder import Placeholder

from tests.support.faults import bomb
from tests.support.growth import PROPORTIONAL, growth
from tests.support.patterns import encode_position, to_bytes

PICTURE = encode_position(np.arange(64) * 4, np.arange(48) * 5)
SMOOTH = np.stack(np.broadcast_arrays(np.arange(64) * 4, np.arange(48)[:, None] * 5, 128), axis=-1).astype(np.uint8)
# Of JPEG at quality 95 without chroma subsampling, on a smooth picture.
JPEG_GREY_LEVELS = 4


def encoded(image, kind="png", **options):
    out = io.BytesIO()
    image.save(out, kind, **options)
    return out.getvalue()


@pytest.mark.parametrize("kind", ["png", "webp"])
def test_lossless_pictures_come_out_as_they_were(kind):
    assert np.array_equal(decode(to_bytes(PICTURE, kind), 64, 48), PICTURE)


@pytest.mark.parametrize("options", [{}, {"progressive": True}, {"restart_marker_blocks": 2}], ids=str)
def test_jpeg(options):
    pixels = decode(to_bytes(SMOOTH, "jpg", **options), 64, 48)
    assert pixels.dtype == np.uint8
    assert np.abs(pixels.astype(int) - SMOOTH).max() <= JPEG_GREY_LEVELS


def test_jpeg_with_something_after_its_end():
    assert decode(to_bytes(SMOOTH, "jpg") + b"appended \xff\x12", 64, 48).shape == (48, 64, 3)


def test_cmyk_jpeg():
    pixels = decode(encoded(Image.fromarray(SMOOTH).convert("CMYK"), "jpeg", quality=98, subsampling=0), 64, 48)
    assert np.abs(pixels.astype(int) - SMOOTH).max() <= 2 * JPEG_GREY_LEVELS


def test_grey_and_bilevel():
    grey = SMOOTH[..., 0]
    assert np.array_equal(decode(encoded(Image.fromarray(grey)), 64, 48), np.repeat(grey[..., None], 3, axis=2))
    bilevel = decode(encoded(Image.fromarray(grey > 100)), 64, 48)
    assert np.array_equal(bilevel[..., 0], np.where(grey > 100, 255, 0))


def test_16_bit_grey_keeps_its_high_byte():
    grey = (np.arange(64 * 48).reshape(48, 64) * 21).astype(np.uint16)
    pixels = decode(encoded(Image.fromarray(grey)), 64, 48)
    assert np.array_equal(pixels, np.repeat((grey >> 8).astype(np.uint8)[..., None], 3, axis=2))


def test_palette():
    few = (SMOOTH // 86 * 86).astype(np.uint8)
    assert np.array_equal(decode(encoded(Image.fromarray(few).quantize(256)), 64, 48), few)
    assert np.array_equal(decode(encoded(Image.fromarray(few).quantize(256), "gif"), 64, 48), few)


def test_opaque_alpha_changes_nothing():
    opaque = np.dstack([PICTURE, np.full((48, 64), 255, np.uint8)])
    pixels = decode(encoded(Image.fromarray(opaque)), 64, 48)
    assert np.array_equal(pixels, PICTURE)
    assert pixels.flags.c_contiguous


def test_translucent_pixels_lie_over_white():
    translucent = np.dstack([PICTURE, np.full((48, 64), 51, np.uint8)])
    expected = 255 + (PICTURE.astype(float) - 255) * 51 / 255
    assert np.abs(decode(encoded(Image.fromarray(translucent)), 64, 48) - expected).max() <= 0.5


@pytest.mark.parametrize("kind", ["png", "webp"])
def test_holes_are_told_from_imagery(kind):
    holed = np.dstack([PICTURE, np.full((48, 64), 255, np.uint8)])
    holed[:12] = 0
    lossless = {"lossless": True} if kind == "webp" else {}
    pixels = decode(encoded(Image.fromarray(holed), kind, **lossless), 64, 48)
    assert (pixels[..., 3] == holed[..., 3]).all()
    assert (pixels[12:, :, :3] == PICTURE[12:]).all()
    with pytest.raises(PartError, match="no imagery"):
        decode(encoded(Image.fromarray(np.zeros_like(holed)), kind, **lossless), 64, 48)


def test_a_transparent_palette_entry_is_a_hole():
    image = Image.fromarray((SMOOTH // 86 * 86).astype(np.uint8)).quantize(16)
    pixels = decode(encoded(image, transparency=image.getpixel((0, 0))), 64, 48)
    assert (pixels[..., 3] == np.where(np.asarray(image) == image.getpixel((0, 0)), 0, 255)).all()


@pytest.mark.parametrize("kind", ["png", "jpg", "webp"])
@given(share=st.floats(0.0, 0.98))
def test_a_part_of_a_picture_is_none(kind, share):
    whole = to_bytes(PICTURE, kind)
    try:
        pixels = decode(whole[: int(len(whole) * share)], 64, 48)
    except PartError:
        return
    # The end marker of a PNG may be missing where nothing else is.
    assert kind == "png"
    assert np.array_equal(pixels, PICTURE)


def test_a_part_is_none_even_where_another_program_tells_pillow_so(monkeypatch):
    monkeypatch.setattr(ImageFile, "LOAD_TRUNCATED_IMAGES", True)
    whole = to_bytes(PICTURE, "jpg")
    with pytest.raises(PartError, match="cut off"):
        decode(whole[: len(whole) // 2], 64, 48)


@given(st.integers(8, len(to_bytes(PICTURE, "png")) - 1), st.integers(1, 255))
def test_no_changed_byte_of_a_png_passes(at, change):
    broken = bytearray(to_bytes(PICTURE, "png"))
    broken[at] ^= change
    try:
        pixels = decode(bytes(broken), 64, 48)
    except PartError:
        return
    # A changed byte of the end marker's own checksum, or the like, that leaves every pixel right.
    assert np.array_equal(pixels, PICTURE)


def test_a_picture_of_another_size_is_named():
    with pytest.raises(PartError, match="64x48 px instead of 256x256"):
        decode(to_bytes(PICTURE, "png"), 256, 256)


def test_a_bomb_is_not_unpacked_and_nobody_is_warned():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(PartError, match="40000x40000 px instead of 256x256"):
            decode(bomb(), 256, 256)


@pytest.mark.parametrize(
    ("body", "kind", "message"),
    [
        (b"", "image/png", "an empty answer instead of an image"),
        (
            b"<html><body><p>Sorry &amp; bye</p></body></html>",
            "text/html",
            "text/html instead of an image: Sorry & bye",
        ),
        (
            b'{"errors": [{"message": "No such layer"}]}',
            "application/json",
            "application/json .*: No such layer",
        ),
        (
            b"\x00\x01\x02\x03" * 100,
            "application/octet-stream",
            "application/octet-stream instead of an image$",
        ),
        (b"II*\x00" + bytes(100), "", "something instead of an image$"),
    ],
)
def test_what_is_no_picture_is_quoted(body, kind, message):
    with pytest.raises(PartError, match=message):
        decode(body, 256, 256, kind)


def test_placeholders():
    placeholder = Placeholder(header=(("X-VE-Tile-Info", "no-tile"),), flat_rgb=((255, 255, 255),))
    refuse_marked(b"", {"x-ve-tile-info": "tile"}, placeholder)
    with pytest.raises(PartError, match=r"X-VE-Tile-Info: no-tile"):
        refuse_marked(b"", {"x-ve-tile-info": "no-tile"}, placeholder)
    white = np.full((4, 4, 3), 255, np.uint8)
    with pytest.raises(PartError, match=r"one colour, rgb\(255, 255, 255\)"):
        refuse_flat(white, placeholder)
    refuse_flat(white - 1, placeholder)
    white[3, 3, 0] = 254
    refuse_flat(white, placeholder)


def test_jpeg_with_fill_bytes_before_its_end():
    """Any number of 0xFF may stand before a marker (ITU-T T.81, B.1.1.2)."""
    body = to_bytes(PICTURE, "jpg")
    assert np.array_equal(
        decode(body[:-2] + b"\xff\xff\xff\xd9", *PICTURE.shape[1::-1]), decode(body, *PICTURE.shape[1::-1])
    )


# A head as libjpeg writes it; what follows is what the entropy-coded data would be.
HEAD = to_bytes(SMOOTH, "jpg").partition(b"\xff\xda")[0]
SCAN = b"\xff\xda\x00\x02"


@pytest.mark.parametrize(
    "body",
    [
        HEAD + SCAN + b"\xff" * 300_000,
        HEAD + SCAN + b"\xff\xd0" * 500_000,
        HEAD + SCAN + b"\xff\x00" * 500_000 + b"\xff" * 100_000,
        HEAD + b"\xff" * 1_000_000,
        HEAD + b"\xff\xfe\x00\x02" * 250_000,
        HEAD + SCAN * 200_000,
        b"GIF89a" + bytes([64, 0, 48, 0, 0, 0, 0]) + b"\x21\xfe" + (b"\xff" + b"c" * 255) * 4000,
        b"\x89PNG\r\n\x1a\n" + b"\x00\x00\x00\x00tEXt\x00\x00\x00\x00" * 80_000,
        b"RIFF\xff\xff\xff\xffWEBPVP8X" + b"\xff" * 1_000_000,
        b"<" * 1_000_000,
    ],
    ids="fill restarts zeros head-fill comments scans gif png webp text".split(),
)
def test_a_megabyte_of_anything_is_soon_refused(body):
    def read(size):
        with pytest.raises(PartError):
            decode(body[:size], 64, 48)

    assert growth(read, len(body) // 8) < PROPORTIONAL


@given(st.binary(max_size=200).map(lambda body: body.replace(b"\x01", b"\xff").replace(b"\x02", b"\xd3")))
def test_markers_are_found_as_by_the_letter_of_the_standard(body):
    # ITU-T T.81, B.1.1.2: any number of 0xFF may stand before a marker, and B.1.1.5: 0xFF 0x00 and RSTn are data.
    expected, at = None, 0
    while at < len(body):
        if body[at] == 0xFF:
            follows = next((i for i in range(at, len(body)) if body[i] != 0xFF), len(body))
            if follows < len(body) and body[follows] != 0 and not 0xD0 <= body[follows] <= 0xD7:
                expected = body[follows]
                break
            at = follows
        at += 1
    found = decode_module._JPEG_MARKER.search(body)
    assert (found[0][-1] if found else None) == expected


def test_a_picture_of_more_scans_or_bytes_than_any_is_refused():
    whole = to_bytes(SMOOTH, "jpg", progressive=True)
    first = whole.index(b"\xff\xda")
    second = whole.index(b"\xff\xc4", first)
    scan = whole[first:second]
    assert decode(whole[:second] + scan * 3 + whole[second:], 64, 48).shape == (48, 64, 3)
    with pytest.raises(PartError, match="JPEG of more than 100 scans"):
        decode(whole[:second] + scan * 100 + whole[second:], 64, 48)
    with pytest.raises(PartError, match=r"^4,218,881 bytes, more than the 4,218,880 of 64x48 px at most$"):
        decode(whole.ljust(4_218_881, b"\0"), 64, 48)


def gif_with(notes):
    """A GIF with a transparent colour, and with something before its picture."""
    image = Image.new("P", (64, 48), 1)
    image.putpalette([9, 99, 199, 10, 20, 30])
    image.paste(0, (0, 0, 32, 48))
    gif = encoded(image, "gif", transparency=0)
    colours_end = 13 + (3 << (gif[10] & 7) + 1)
    return gif[:colours_end] + notes + gif[colours_end:]


COMMENT = b"!\xfe" + b"\x01x" * 500_000 + b"\0"


def test_a_long_comment_of_a_gif_takes_as_long_as_many_short_ones():
    """Pillow 9 adds each piece of a comment to a copy of what was there before: 4 MB took it 50 s."""
    read = lambda pieces: decode(gif_with(b"!\xfe" + b"\x01x" * pieces + b"\0"), 64, 48)  # noqa: E731
    assert growth(read, 250_000) < PROPORTIONAL


@pytest.mark.parametrize(
    "notes",
    [
        COMMENT,
        b"\0" + COMMENT,
        b"!\xff\x0bXMP DataXMP" + b"\xffa" * 128 + b"\0" + COMMENT,
        b"!\xfe\x01x\0" * 9,
    ],
)
def test_a_gif_is_read_without_its_notes(notes):
    pixels = decode(gif_with(notes), 64, 48)
    assert np.array_equal(pixels, decode(gif_with(b""), 64, 48))
    assert pixels[0, 0, 3] == 0
    assert pixels[0, 40].tolist() == [10, 20, 30, 255]


@pytest.mark.parametrize("cut", [11, 20, -30])
def test_a_gif_that_is_cut_off_is_a_broken_picture(cut):
    with pytest.raises(BrokenPictureError):
        decode(gif_with(b"!\xfe\x7f" + b"x" * 127 + b"\0")[:cut], 64, 48)


def exif_of_overlapping_values():
    """An Exif segment of 2,600 values, each of which is all that comes behind them: 86 MB for 64 kB."""
    count, length = 2600, 33_000
    data = 14 + 12 * count
    entries = b"".join(struct.pack("<HHII", tag, 7, length, data) for tag in range(count))
    text = b"Exif\0\0II*\0\x08\0\0\0" + struct.pack("<H", count) + entries + bytes(4 + length)
    return b"\xff\xe1" + struct.pack(">H", len(text) + 2) + text


def test_a_jpeg_is_read_without_its_notes():
    """Its colours are said by what is left: Adobe's segment, and none of others."""
    cmyk = encoded(Image.fromarray(PICTURE).convert("CMYK"), "jpeg")
    for whole in (to_bytes(SMOOTH, "jpg"), to_bytes(SMOOTH, "jpg", progressive=True), cmyk):
        at = 4 + int.from_bytes(whole[4:6], "big")
        notes = exif_of_overlapping_values() + b"\xff\xfe\0\x05abc" + b"\xff\xec\0\x05abc"
        with warnings.catch_warnings():
            # Pillow warns of each value that is cut off: as many lines for a tile.
            warnings.simplefilter("error")
            tracemalloc.start()
            pixels = decode(whole[:at] + notes + whole[at:], 64, 48)
            peak = tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
        assert peak < 5_000_000
        assert np.array_equal(pixels, decode(whole, 64, 48))


@pytest.mark.parametrize("error", [AttributeError("no png"), ZeroDivisionError(), AssertionError(), MemoryError()])
def test_whatever_a_reader_of_pillow_raises_is_a_broken_picture(monkeypatch, error):
    def load(_image):
        raise error

    monkeypatch.setattr(ImageFile.ImageFile, "load", load)
    with pytest.raises(BrokenPictureError, match=r"^broken image \((no png|\w+Error)\)$"):
        decode(to_bytes(PICTURE, "png"), 64, 48)


@pytest.mark.parametrize(
    ("version", "bundled", "refused"),
    [
        ("1.2.4", True, True),
        ("1.3.1", True, True),
        ("1.3.2", True, False),
        ("1.10.0", True, False),
        # A distribution keeps the version of what it has mended.
        ("1.2.4", False, False),
    ],
)
def test_webp_is_read_by_a_libwebp_without_the_known_hole(monkeypatch, version, bundled, refused):
    monkeypatch.setattr(decode_module.features, "version", lambda _name: version)
    monkeypatch.setattr(decode_module, "_brings_libraries", lambda: bundled)
    decode_module.webp_problem.cache_clear()
    try:
        if refused:
            with pytest.raises(PartError, match=rf"libwebp {version} .* install Pillow 10\.0\.1 or later"):
                decode(to_bytes(PICTURE, "webp"), 64, 48)
        else:
            assert np.array_equal(decode(to_bytes(PICTURE, "webp"), 64, 48), PICTURE)
    finally:
        decode_module.webp_problem.cache_clear()


def test_picture_of_any_size_is_means_of_the_pixels_beneath():
    pixels = decode(to_bytes(PICTURE, "png"), 32, 24, any_size=True)
    means = PICTURE.reshape(24, 2, 32, 2, 3).mean(axis=(1, 3))
    assert np.abs(pixels - means).max() <= 0.5 + 1e-9
    assert np.array_equal(
        decode(to_bytes(PICTURE, "png"), 128, 96, any_size=True), np.kron(PICTURE, np.ones((2, 2, 1)))
    )
    assert np.array_equal(decode(to_bytes(PICTURE, "png"), 64, 48, any_size=True), PICTURE)


def test_resized_pixel_holds_imagery_where_all_beneath_it_do():
    half = np.dstack([PICTURE, np.full((48, 64), 255, np.uint8)])
    half[:, :31, 3] = 0
    pixels = decode(to_bytes(half, "png"), 32, 24, any_size=True)
    assert np.array_equal(np.unique(pixels[:, :16, 3]), [0])
    assert (pixels[:, 16:, 3] == 255).all()


@pytest.mark.parametrize("size", [(15, 12), (16, 11)])
def test_far_larger_picture_is_refused_whatever_sizes_may_be(size):
    with pytest.raises(PartError, match="64x48 px instead of"):
        decode(to_bytes(PICTURE, "png"), *size, any_size=True)
