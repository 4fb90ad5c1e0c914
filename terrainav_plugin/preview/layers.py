"""The preview's layers: attributes, styles, map tips and times."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from qgis.core import (
    Qgis,
    QgsCategorizedSymbolRenderer,
    QgsFillSymbol,
    QgsPalLayerSettings,
    QgsRendererCategory,
    QgsVectorLayer,
    QgsVectorLayerSimpleLabeling,
)

from ..compat import LABELS_ALONG_LINE
from ..i18n import number_text, tr
from ..map.mission_group import ROLE
from ..paths import style
from ..plain import escaped_field
from ..tasks import crs_named
from .view import CRS

_POSE = "field=name:string&field=column:integer&field=row:integer&field=lat:double&field=lon:double&field=agl_m:double"
_TIMES = "field=time:datetime&field=time_end:datetime"
FIELDS = {
    "area": "field=north:double&field=west:double&field=south:double&field=east:double",
    "footprints": (
        f"{_POSE}&field=gsd_m:double&field=overlap:integer&field=crowd:integer"
        f"&field=yaw:double&field=tilt:double&field=roll:double&field=horizon:bool&{_TIMES}"
    ),
    "centres": f"{_POSE}&field=gsd_m:double&field=yaw:double&{_TIMES}",
    "flight": (
        "field=length_m:double&field=images:integer&field=first_lat:double&field=first_lon:double"
        "&field=start:datetime&field=end:datetime&field=sortie:integer"
    ),
    "density": "field=images:double",
    "buildings": "field=kind:string&field=number:integer",
    "labels": "field=kind:string&field=number:integer",
}
#: Names of the attributes with start and end of a feature's time, by role.
_WHEN = {"footprints": ("time", "time_end"), "centres": ("time", "time_end"), "flight": ("start", "end")}


def field_names(role: str) -> list[str]:
    """Names of a layer's attributes."""
    return [part.partition("=")[2].partition(":")[0] for part in FIELDS[role].split("&")]


@dataclass(frozen=True)
class PreviewLayer:
    """One of the preview's layers."""

    role: str
    geometry: str

    def new_layer(self, crs: str) -> QgsVectorLayer:
        """Empty layer in a CRS (a code or WKT), with its styles."""
        uri = f"{self.geometry}?crs={CRS}&{FIELDS[self.role]}"
        layer = QgsVectorLayer(uri, title(self.role), "memory")
        layer.setCrs(crs_named(crs))
        # Close projects without QGIS's question about temporary layers: the preview can be recreated at any time.
        layer.setCustomProperty("skipMemoryLayersCheck", 1)
        # Styles contain custom properties: set the role before there are several styles.
        layer.setCustomProperty(ROLE, self.role)
        _dress(layer, self.role, self.role)
        layer.setReadOnly(True)
        return layer

    def add_styles(self, layer: QgsVectorLayer) -> Iterator[None]:
        """Add the further styles that the user may choose to a new layer, step by step."""
        if self.role == "footprints":
            yield from _add_overlap_style(layer)


#: Layers from top to bottom of the group.
KINDS = (
    PreviewLayer("area", "MultiPolygon"),
    PreviewLayer("centres", "Point"),
    PreviewLayer("flight", "MultiLineString"),
    PreviewLayer("footprints", "MultiPolygon"),
    PreviewLayer("density", "MultiPolygon"),
    PreviewLayer("buildings", "MultiPolygon"),
    PreviewLayer("labels", "MultiPolygon"),
)
#: Layers of files that a mission names: their symbols follow what is in the files.
OF_FILES = ("buildings", "labels")
#: Opacities of their fills: the labels of a building's ground are to be seen below it.
_OPACITIES = {"buildings": 50, "labels": 120}
#: Largest number of kinds that have a symbol of their own.
_MOST_KINDS = 100
_GREY = "#808080"


def title(role: str) -> str:
    """Name of a layer in the layer tree."""
    return {
        "area": tr("Area"),
        "centres": tr("Capture centres"),
        "flight": tr("Flight line"),
        "footprints": tr("Planned images"),
        "density": tr("Images per place"),
        "buildings": tr("Buildings"),
        "labels": tr("Labels"),
    }[role]


def drawn_title(role: str, count: int, most: int) -> str:
    """Name of a layer of files, with a note if it has only some of the features."""
    if count <= most:
        return title(role)
    return tr("{title} (the nearest {most} of {count})").format(
        title=title(role), most=number_text(most), count=number_text(count)
    )


def dress_kinds(layer: QgsVectorLayer, role: str, kinds: Sequence[tuple[str, str]]) -> None:
    """Give each kind of feature, by title and colour, a symbol and an entry of the legend; further kinds are grey."""
    opacity = _OPACITIES[role]
    categories = [QgsRendererCategory(title, _symbol(colour, opacity), title) for title, colour in kinds[:_MOST_KINDS]]
    if len(kinds) > _MOST_KINDS:
        more = tr("{count} more classes").format(count=number_text(len(kinds) - _MOST_KINDS))
        # Without a value, it is for all others.
        categories.append(QgsRendererCategory(None, _symbol(_GREY, opacity), more))
    layer.setRenderer(QgsCategorizedSymbolRenderer("kind", categories))
    layer.emitStyleChanged()


def _symbol(colour: str, opacity: int) -> QgsFillSymbol:
    """Translucent fill, of an opacity up to 255, with an opaque outline."""
    red, green, blue = bytes.fromhex(colour[1:])
    return QgsFillSymbol.createSimple(
        {
            "color": f"{red},{green},{blue},{opacity}",
            "outline_color": f"{red},{green},{blue},255",
            "outline_width": "0.4",
            "outline_width_unit": "MM",
        }
    )


def _map_tip(role: str) -> str:
    name = f"<b>{escaped_field('name')}</b><br/>"
    gsd = tr("{gsd} cm per pixel, {height} m above ground").format(
        gsd='[% round(100 * "gsd_m", 1) %]', height='[% round("agl_m", 1) %]'
    )
    time = tr("at {time} UTC").format(time="[% format_date(\"time\", 'yyyy-MM-dd HH:mm:ss') %]")
    yaw = tr("yaw {yaw}°").format(yaw='[% round("yaw", 2) %]')
    if role == "centres":
        return f"{name}{gsd}<br/>{yaw}<br/>{time}"
    if role == "footprints":
        attitude = tr("yaw {yaw}°, tilt {tilt}°, roll {roll}°").format(
            **{angle: f'[% round("{angle}", 2) %]' for angle in ("yaw", "tilt", "roll")}
        )
        overlap = tr("overlap count at the centre: {count}").format(count='[% "overlap" %]')
        horizon = tr("the horizon is in the image").replace("'", "''")
        sky = f"[% CASE WHEN \"horizon\" THEN '<br/>{horizon}' ELSE '' END %]"
        return f"{name}{gsd}<br/>{attitude}{sky}<br/>{overlap}<br/>{time}"
    if role == "flight":
        sortie = _sortie_text()
        which = f"[% CASE WHEN \"sortie\" > 0 THEN '<b>{sortie}</b><br/>' ELSE '' END %]"
        return which + tr("{length} km, {count} images, from {start} to {end} UTC").format(
            length='[% round("length_m" / 1000, 2) %]',
            count='[% "images" %]',
            start="[% format_date(\"start\", 'yyyy-MM-dd HH:mm:ss') %]",
            end="[% format_date(\"end\", 'yyyy-MM-dd HH:mm:ss') %]",
        )
    if role in OF_FILES:
        return f"{escaped_field('kind')}<br/>" + tr("feature {number}").format(number='[% "number" %]')
    if role == "density":
        return tr("mean overlap count here: {count}").format(count='[% "images" %]')
    return ""


def _sortie_text() -> str:
    """Text with the number of a line's sortie, for use inside a string of an expression."""
    return tr("Sortie {number}").replace("'", "''").format(number="' || \"sortie\" || '")


def _dress(layer: QgsVectorLayer, role: str, name: str) -> None:
    """Load a style, and set map tips and times, which a style replaces."""
    if role not in OF_FILES:
        layer.loadNamedStyle(style(name))
    layer.setMapTipTemplate(_map_tip(role))
    _set_times(layer, role)
    if role == "flight":
        _label_sorties(layer)


def _label_sorties(layer: QgsVectorLayer) -> None:
    """Label each of several sorties along its line, as colours repeat and not everyone distinguishes them."""
    labels = QgsPalLayerSettings()
    text = _sortie_text()
    labels.fieldName, labels.isExpression = f"if(\"sortie\" > 0, '{text}', '')", True
    labels.placement = LABELS_ALONG_LINE
    style = labels.format()
    halo = style.buffer()
    halo.setEnabled(True)
    style.setBuffer(halo)
    labels.setFormat(style)
    layer.setLabeling(QgsVectorLayerSimpleLabeling(labels))
    layer.setLabelsEnabled(True)


def _set_times(layer: QgsVectorLayer, role: str) -> None:
    """Make QGIS's temporal controller show features at their time."""
    if role not in _WHEN:
        return
    times = layer.temporalProperties()
    times.setMode(Qgis.VectorTemporalMode.FeatureDateTimeStartAndEndFromFields)
    start, end = _WHEN[role]
    times.setStartField(start)
    times.setEndField(end)
    times.setIsActive(True)


def _add_overlap_style(layer: QgsVectorLayer) -> Iterator[None]:
    """Add a second, named style for footprints, which the user can choose."""
    styles = layer.styleManager()
    plain, overlap = tr("Footprints"), tr("Overlap count")
    styles.renameStyle(styles.currentStyle(), plain)
    styles.addStyleFromLayer(overlap)
    yield None
    styles.setCurrentStyle(overlap)
    yield None
    _dress(layer, "footprints", "overlap")
    yield None
    styles.setCurrentStyle(plain)
    yield None
