"""Raster files that name other data: no request is made and no file is read but those the user has named."""

from __future__ import annotations

import contextlib
import os
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")

from terrainav.core.addresses import is_key_name  # noqa: E402
from terrainav.core.errors import InvalidInput  # noqa: E402
from terrainav.core.geodesy.mercator import HALF_WORLD_M, PixelGrid  # noqa: E402
from terrainav.core.imagery.opening import open_source  # noqa: E402
from terrainav.core.imagery.raster.source import open_raster  # noqa: E402
from terrainav.core.imagery.raster.trust import allowed_drivers, check_virtual  # noqa: E402
from terrainav.core.imagery.source import Window  # noqa: E402
from terrainav.core.imagery.tiles import check_address  # noqa: E402

from tests.support import rasters  # noqa: E402
from tests.support.services import ServiceServer  # noqa: E402

ZOOM, SIZE = 15, 64
SIZE_M = PixelGrid().pixel_size(ZOOM)[0]
ON_GRID = (
    -HALF_WORLD_M + 17_240 * 256 * SIZE_M,
    SIZE_M,
    0.0,
    HALF_WORLD_M - 11_380 * 256 * SIZE_M,
    0.0,
    -SIZE_M,
)
TILE = Window(ZOOM, 17_240 * 256, 11_380 * 256, SIZE, SIZE)
WMS = """<GDAL_WMS><Service name="TMS"><ServerUrl>{url}/${{z}}/${{x}}/${{y}}.png</ServerUrl></Service>
<DataWindow><UpperLeftX>-20037508.34</UpperLeftX><UpperLeftY>20037508.34</UpperLeftY>
<LowerRightX>20037508.34</LowerRightX><LowerRightY>-20037508.34</LowerRightY><TileLevel>3</TileLevel>
<TileCountX>1</TileCountX><TileCountY>1</TileCountY><YOrigin>top</YOrigin></DataWindow>
<Projection>EPSG:3857</Projection><BandsCount>3</BandsCount></GDAL_WMS>"""


@pytest.fixture(autouse=True)
def _no_folders(monkeypatch):
    monkeypatch.delenv("TERRAINAV_RASTER_FOLDERS", raising=False)


@pytest.fixture
def server():
    with ServiceServer(lambda *_: (404, "text/plain", b"")) as running:
        yield running


@pytest.fixture
def outside(tmp_path):
    """A picture of the user that is in another folder than what was downloaded."""
    (tmp_path / "private").mkdir()
    values = np.full((3, SIZE, SIZE), 77, np.uint8)
    return rasters.write(tmp_path / "private" / "own.tif", values, ON_GRID, 3857)


@pytest.fixture
def folder(tmp_path):
    made = tmp_path / "downloaded"
    made.mkdir()
    return made


def vrt_of(path, target):
    """VRT of one file, as GDAL writes it."""
    gdal.BuildVRT(str(path), [str(target)]).FlushCache()
    return path


def naming(path, outside, name, relative="0"):
    """VRT that names something else."""
    text = vrt_of(path, outside).read_text()
    written = f'<SourceFilename relativeToVRT="{relative}">{name}</SourceFilename>'
    path.write_text(re.sub("<SourceFilename.*?</SourceFilename>", lambda _: written, text))
    return path


def refusal(path):
    with pytest.raises(InvalidInput) as raised:
        open_raster(path)
    text = str(raised.value)
    assert "\n" not in text
    return text


def test_files_of_other_folders_are_not_read_unless_the_user_names_them(folder, outside, library, monkeypatch):
    path = vrt_of(folder / "map.vrt", outside)
    text = refusal(path)
    assert "is not beside it; set TERRAINAV_RASTER_FOLDERS=" in text
    monkeypatch.setenv("TERRAINAV_RASTER_FOLDERS", os.pathsep.join(["/nowhere", str(outside.parent)]))
    source = open_raster(path)
    assert (source.fetch("", TILE) == 77).all()
    source.close()


def test_files_beside_and_below_a_vrt_are_read(folder, outside, library, monkeypatch):
    monkeypatch.chdir(folder)
    (folder / "tiles").mkdir()
    (folder / "tiles" / "own.tif").write_bytes(outside.read_bytes())
    inner = vrt_of(folder / "tiles" / "inner.vrt", folder / "tiles" / "own.tif")
    path = vrt_of(folder / "map.vrt", inner)
    for name in (path, path.name):
        source = open_raster(name)
        assert (source.fetch("", TILE) == 77).all()
        source.close()


@pytest.mark.parametrize(
    "name",
    [
        "/etc/hostname",
        "../private/own.tif",
        "x/../../private/own.tif",
        " ../private/own.tif",
        "/vsicurl/{url}/x.tif",
        "/vsicurl_streaming/{url}/x.tif",
        "{url}/x.tif",
        "WMS:{url}/?LAYERS=a",
        "vrt:///etc/hostname",
        "&lt;GDAL_WMS&gt;&lt;Service name='TMS'&gt;",
        "NETCDF:/etc/hostname:a",
        "tiles/../../private/<!-- -->own.tif",
        "<![CDATA[/etc/hostname]]>",
        "<x>a</x>/etc/hostname",
    ],
)
@pytest.mark.parametrize("relative", ["0", "1"])
def test_a_vrt_that_names_what_is_not_beside_it(folder, outside, server, library, name, relative):
    refusal(naming(folder / "map.vrt", outside, name.replace("{url}", server.url), relative))
    assert server.asked == []


NAMED = re.compile("<SourceFilename.*?</SourceFilename>")
END = "</VRTDataset>"
WARPED = "<GDALWarpOptions><SourceDataset>{}</SourceDataset></GDALWarpOptions>"
OVERVIEW = "<Overview><SourceFilename>{}</SourceFilename></Overview></VRTRasterBand>"
PLACE = '<Metadata domain="GEOLOCATION"><MDI key="X_DATASET">{}</MDI></Metadata>'


OPTION = "</SourceFilename><OpenOptions><OOI key='{}'>{}</OOI></OpenOptions>"
CODE = "<PixelFunctionLanguage>Python</PixelFunctionLanguage><PixelFunctionType>os.system</PixelFunctionType>"
OVERVIEWS = '<Metadata domain="OVERVIEWS"><MDI key="{}">{}</MDI></Metadata>'


@pytest.mark.parametrize(
    "change",
    [
        lambda text, out: text.replace(END, OVERVIEWS.format("OVERVIEW_FILE", out) + END),
        lambda text, out: text.replace(
            END, f"<Metadata domain='GEOLOCATION'><MDI><key>X_DATASET</key>{out}</MDI></Metadata>{END}"
        ),
        lambda text, out: text.replace(END, OVERVIEWS.format("Overview&#95;File", ":::BASE:::../" + out) + END),
        lambda text, out: text.replace(
            "</SourceFilename>", OPTION.format("PRELUDE_STATEMENTS", f"ATTACH '{out}' AS other")
        ),
        lambda text, _out: text.replace("<SimpleSource>", f"{CODE}<SimpleSource>"),
        # GDAL takes an attribute for an element, and either in any case.
        lambda text, out: text.replace("<SimpleSource>", f'<SimpleSource sourceFILENAME="{out}">'),
        lambda text, out: NAMED.sub(f"<sourcefilename>{out}</sourcefilename>", text),
        lambda text, out: text.replace(END, WARPED.format(out) + END),
        lambda text, out: text.replace("</VRTRasterBand>", OVERVIEW.format(out), 1),
        lambda text, out: text.replace(END, PLACE.format(out) + END),
        lambda text, out: (
            f'<!DOCTYPE x [<!ENTITY f "{out}">]>' + NAMED.sub("<SourceFilename>&f;</SourceFilename>", text)
        ),
        lambda text, out: text.replace(END, f"<Anything>/vsicurl/http://127.0.0.1:9{out}</Anything>{END}"),
        lambda text, out: text[:-20],
    ],
)
def test_other_places_that_a_vrt_names_data_in(folder, outside, library, change):
    (folder / "own.tif").write_bytes(outside.read_bytes())
    path = vrt_of(folder / "map.vrt", folder / "own.tif")
    path.write_text(change(path.read_text(), str(outside)))
    refusal(path)


@pytest.mark.skipif(os.name == "nt", reason="links need rights there")
def test_a_link_beside_a_vrt_leads_nowhere_else(folder, outside, library):
    (folder / "own.tif").symlink_to(outside)
    assert "is not beside it" in refusal(naming(folder / "map.vrt", outside, "own.tif", "1"))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
@pytest.mark.parametrize("kind", ["pipe", "link to a device", "folder"])
def test_a_vrt_reads_regular_files_alone(folder, outside, library, kind):
    """GDAL waits for a pipe for good, and some of its formats are folders whose descriptions name other files."""
    inside = folder / "odd.tif"
    if kind == "pipe":
        os.mkfifo(inside)
    elif kind == "folder":
        inside.mkdir()
    else:
        inside.symlink_to("/dev/zero")
    text = refusal(naming(folder / "map.vrt", outside, "odd.tif", "1"))
    assert "which is not a regular file" in text or (kind == "link to a device" and "is not beside it" in text)


@pytest.mark.parametrize("ending", [".ovr", ".msk", ".OVR"])
def test_a_folder_in_the_place_of_overviews_is_refused(outside, library, ending):
    """GDAL would look for a format in it, of which some name other files."""
    outside.with_name(outside.name + ending).mkdir()
    assert "is not a regular file, and lies beside" in refusal(outside)


@pytest.mark.skipif(os.name == "nt", reason="links need rights there")
def test_a_link_to_a_vrt_reads_what_is_beside_that(folder, outside, library):
    vrt_of(outside.parent / "own.vrt", outside)
    (folder / "map.vrt").symlink_to(outside.parent / "own.vrt")
    source = open_raster(folder / "map.vrt")
    assert (source.fetch("", TILE) == 77).all()
    source.close()


@pytest.mark.skipif(os.name == "nt", reason="links need rights there")
@pytest.mark.parametrize("name", ["9" * 300 + ".tif", "circle.tif"])
def test_files_that_cannot_be_there_are_left_to_gdal(folder, outside, name):
    """`pathlib` raises for names that are too long and for links that lead in a circle."""
    (folder / "circle.tif").symlink_to("circle.tif")
    assert "VRT" in allowed_drivers(str(naming(folder / "map.vrt", outside, name, "1")))


def test_no_folder_of_the_user_opens_the_network(folder, outside, server, library, monkeypatch):
    monkeypatch.setenv("TERRAINAV_RASTER_FOLDERS", Path.cwd().anchor)
    assert "not a file beside it" in refusal(naming(folder / "map.vrt", outside, f"/vsicurl/{server.url}/x.tif"))
    assert server.asked == []


@pytest.mark.parametrize("hidden", ["own.wms", "map.tif", "by vrt", "overviews", "mask", "in a tiff"])
def test_descriptions_of_services_make_no_request(folder, outside, server, library, hidden):
    body = WMS.format(url=server.url)
    if hidden in ("own.wms", "map.tif"):
        path = folder / hidden
        path.write_text(body)
    elif hidden == "by vrt":
        (folder / "own.tif").write_text(body)
        path = naming(folder / "map.vrt", outside, "own.tif", "1")
    elif hidden == "in a tiff":
        # GDAL takes for a VRT what has its first element anywhere in its beginning.
        (folder / "own.tif").write_bytes(b"II*\0" + b"<VRTDataset><SourceFilename>" + str(outside).encode())
        path = naming(folder / "map.vrt", outside, "own.tif", "1")
    else:
        path = folder / "map.tif"
        path.write_bytes(outside.read_bytes())
        (folder / f"map.tif.{'ovr' if hidden == 'overviews' else 'msk'}").write_text(body)
    text = refusal(path)
    assert "describes a service" in text or "cannot be read" in text
    assert server.asked == []


def test_a_sidecar_that_names_another_file(folder, outside, library):
    path = folder / "map.tif"
    path.write_bytes(outside.read_bytes())
    (folder / "map.tif.aux.xml").write_text(
        f'<PAMDataset><Metadata domain="OVERVIEWS"><MDI key="OVERVIEW_FILE">{outside}</MDI></Metadata></PAMDataset>'
    )
    assert "names other files" in refusal(path)


def test_vrts_that_read_each_other_come_to_an_end(folder, outside, library):
    for number in range(12):
        naming(folder / f"{number}.vrt", outside, f"{number + 1}.vrt", "1")
    assert "within more than 8 others" in refusal(folder / "0.vrt")
    naming(folder / "self.vrt", outside, "self.vrt", "1")
    # GDAL notices that itself; whether it says so is a choice of the process.
    with contextlib.suppress(InvalidInput):
        open_raster(folder / "self.vrt").close()


def tiff_with_overviews(path, named, **options):
    """GeoTIFF that says of itself, in its metadata, where its overviews are."""
    written = gdal.GetDriverByName("GTiff").CreateCopy(
        str(path), gdal.Open(str(named)), options=[f"{name}={value}" for name, value in options.items()]
    )
    written.SetMetadataItem("OVERVIEW_FILE", str(named), "OVERVIEWS")
    written.FlushCache()
    return path


FORMS = [{}, {"BIGTIFF": "YES"}, {"ENDIANNESS": "BIG"}]


@pytest.mark.parametrize("form", FORMS, ids=str)
def test_a_tiff_that_names_its_overviews_is_not_read(folder, outside, library, form):
    path = tiff_with_overviews(folder / "own.tif", outside, **form)
    assert str(outside) in gdal.Info(str(path), format="json")["files"]
    assert "names another file for its overviews" in refusal(path)


@pytest.mark.parametrize("form", FORMS, ids=str)
def test_nor_is_one_within_a_vrt(folder, outside, library, form):
    path = tiff_with_overviews(folder / "own.tif", outside, **form)
    assert "for its overviews" in refusal(vrt_of(folder / "map.vrt", path))


def test_a_tiff_with_metadata_of_any_other_kind_is_read(folder, outside, library):
    path = folder / "own.tif"
    written = gdal.GetDriverByName("GTiff").CreateCopy(str(path), gdal.Open(str(outside)))
    written.SetMetadataItem("DESCRIPTION", "made of /vsizip/x.zip/MAIN_DATASET & an overview")
    written.FlushCache()
    del written
    open_raster(path).close()
    open_raster(vrt_of(folder / "map.vrt", path)).close()


@pytest.mark.parametrize("damage", [slice(0, 6), slice(0, 60), slice(0, -40)])
def test_a_tiff_that_is_cut_off_is_no_fault_of_the_program(folder, outside, library, damage):
    path = tiff_with_overviews(folder / "own.tif", outside)
    path.write_bytes(path.read_bytes()[damage])
    with contextlib.suppress(InvalidInput):
        open_raster(path).close()


def test_a_vrt_elsewhere_is_not_read(folder, outside, library):
    path = vrt_of(folder / "map.vrt", outside)
    refusal(f"/vsisubfile/0_{path.stat().st_size},{path}")


# --- keys in names


@pytest.mark.parametrize(
    "name",
    [
        "/vsicurl/http://me:word@h.example/x.tif",
        "/vsicurl/https://h.example/x.tif?token=word",
        "/vsizip//vsicurl/https://me:word@h.example/x.zip/x.tif",
        "/vsicurl?url=https%3A%2F%2Fme%3Aword%40h.example%2Fx.tif",
        "/vsicurl?header.Authorization=word&url=https%3A%2F%2Fh.example%2Fx.tif",
        "/vsicurl?userpwd=me:word&url=https%3A%2F%2Fh.example%2Fx.tif",
        "/vsicurl/https://h.example/x.tif?X-Amz-Signature=word",
        "/vsicurl/HTTP://me:word@h.example/x.tif",
        "/vsicurl/http:/me:word@h.example/x.tif",
        "/vsicurl/HTTPS://h.example/x.tif?token=word",
        "/vsicurl/ftp://me:word@h.example/x.tif",
        "/vsizip//vsicurl/sftp://me:word@h.example/x.zip/x.tif",
        "/vsicurl?max_retry=2&url=ftp%3A%2F%2Fh.example%2Fx.tif%3Fsig%3Dword",
    ],
)
def test_no_credentials_in_names_of_virtual_files(name):
    with pytest.raises(InvalidInput) as raised:
        open_source(name)
    assert "word" not in str(raised.value)


@pytest.mark.parametrize(
    "name",
    [
        "/vsizip/C:/my maps@home/a.zip/x.tif",
        "/vsicurl/ftp://h.example/x.tif",
        "/vsizip//vsicurl/HTTPS://h.example/a b.zip/x.tif",
    ],
)
def test_names_of_virtual_files_without_credentials(name):
    check_virtual(name)


@pytest.mark.parametrize(
    "name",
    [
        *(
            "pwd",
            "passwd",
            "pass",
            "password",
            "passphrase",
            "jwt",
            "id_token",
            "user_key",
            "userkey",
            "session_token",
        ),
        *(
            "X-Amz-Signature",
            "X-Amz-Security-Token",
            "X-Amz-Credential",
            "X-Goog-Signature",
            "AWSAccessKeyId",
            "bearer",
        ),
        *("key", "api_key", "sig", "token", "access_token", "auth"),
        *(
            "api_token",
            "oauth-token",
            "apitoken",
            "secret_key",
            "private_key",
            "licence-key",
            "MAP_KEY",
            "serviceKey",
        ),
        *(
            "Ocp-Apim-Subscription-Key",
            "x-api-key",
            "api_secret",
            "clientSecret",
            "credentials",
            "accessKeyId",
        ),
    ],
)
def test_names_that_keys_go_by(name):
    assert is_key_name(name)
    with pytest.raises(InvalidInput, match="holds a key in"):
        check_address(f"https://h.example/?{name}=s3cret", "address")


@pytest.mark.parametrize(
    "name",
    [
        "layers",
        "map",
        "format",
        "style",
        "tileset",
        "tokens",
        "keys",
        "bypass",
        "sigma",
        "monkey",
        "layer_key",
        "session",
    ],
)
def test_names_that_are_none_of_keys(name):
    assert not is_key_name(name)


@pytest.mark.parametrize("name", ["map.tif.OVR", "map.tif.Ovr", "MAP.TIF.ovr"])
def test_overviews_are_looked_through_in_any_case_of_letters(tmp_path, server, name):
    """GDAL finds them in a list of the folder, and takes no notice of case there."""
    path = rasters.write(tmp_path / "map.tif", np.full((3, SIZE, SIZE), 77, np.uint8), ON_GRID, 3857)
    assert allowed_drivers(str(path))
    (tmp_path / name).write_text(WMS.format(url=server.url))
    with pytest.raises(InvalidInput, match="describes a service"):
        allowed_drivers(str(path))
    assert server.asked == []


@pytest.mark.parametrize("spelt", [b"<kML", b"<WMs", b"<tileMap"])
def test_pixels_that_spell_a_description_are_pixels(tmp_path, spelt):
    """By chance one small JPEG in a hundred thousand does; a text without a zero byte before it is a description."""
    picture = tmp_path / "picture.jpg"
    pixels = np.random.default_rng(1).integers(0, 255, (24, 24, 3), dtype=np.uint8)
    Image.fromarray(pixels).save(picture, comment=b"\0" + spelt)
    assert picture.read_bytes()[:4096].count(spelt) == 1
    assert "JPEG" in allowed_drivers(str(picture))
    (tmp_path / "text.jpg").write_bytes(b"\xff\xd8\xff" + spelt)
    with pytest.raises(InvalidInput, match="describes a service"):
        allowed_drivers(str(tmp_path / "text.jpg"))


@pytest.mark.parametrize("name", ["map.tif.ovr", "map.tif.msk", "map.tif.aux.xml", "map.tif.aux", "map.tfw", "MAP.wld"])
def test_a_pipe_in_the_place_of_a_file_beside_a_raster_is_refused(tmp_path, name):
    """GDAL would wait for it for good."""
    path = rasters.write(tmp_path / "map.tif", np.full((3, SIZE, SIZE), 77, np.uint8), ON_GRID, 3857)
    os.mkfifo(tmp_path / "other.tif.ovr")
    (tmp_path / "map.tif.gone").symlink_to("nowhere")
    assert allowed_drivers(str(path))
    os.mkfifo(tmp_path / name)
    with pytest.raises(InvalidInput, match=f"{name}: is not a regular file, and lies beside map.tif"):
        allowed_drivers(str(path))
