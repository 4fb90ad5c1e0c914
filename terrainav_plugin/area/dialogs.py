"""Questions about the layer that an area is taken from."""

from __future__ import annotations

from qgis.core import QgsFieldProxyModel, QgsMapLayer, QgsVectorLayer
from qgis.gui import QgsFieldComboBox, QgsMapLayerComboBox
from qgis.PyQt.QtWidgets import (
    QButtonGroup,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QRadioButton,
    QWidget,
)

from ...core.units import LENGTHS_M
from ..compat import POINT_LAYERS, POLYGON_LAYERS
from ..i18n import number_text, tr
from ..plain import plain_label
from ..widgets import NumberBox, combo, named, ok_and_cancel, row, spin
from .layers import PointFields

_MOST_AGL = 1e9


class LayerDialog(QDialog):
    """Asks for a layer.

    Parameters
    ----------
    active : QgsMapLayer or None
        Chosen at first, where it is one of those to choose from.
    """

    def __init__(self, parent: QWidget, title: str, active: QgsMapLayer | None, kind: object = None) -> None:
        super().__init__(parent)
        self.setObjectName("area_layer_dialog")
        self.setWindowTitle(title)
        self.layer = named(QgsMapLayerComboBox(), "layer", tr("Layer of this project, in any CRS"))
        if kind is not None:
            self.layer.setFilters(kind)
        if active is not None:
            self.layer.setLayer(active)
        if self.layer.currentLayer() is None and self.layer.count():
            # The active layer is none of those to choose from.
            self.layer.setCurrentIndex(0)
        self.words = named(plain_label(), "words")
        self.words.setWordWrap(True)
        self.buttons = ok_and_cancel(self)
        self.form = QFormLayout(self)
        self.form.addRow(tr("&Layer"), self.layer)
        self.form.addRow(self.words)
        self._add_entries()
        self.form.addRow(self.buttons)
        self.layer.layerChanged.connect(self.show_layer)
        self.show_layer(self.layer.currentLayer())

    def chosen(self) -> QgsMapLayer | None:
        """Return the layer."""
        return self.layer.currentLayer()

    def show_layer(self, layer: QgsMapLayer | None) -> None:
        """Show what can be taken from a layer."""
        ok = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        ok.setEnabled(layer is not None)
        self.words.setText(self._words(layer) if layer is not None else tr("The project has no such layer."))

    def _add_entries(self) -> None:
        """Add what else is asked for."""

    def _words(self, layer: QgsMapLayer) -> str:
        return tr(
            "The smallest box of longitudes and latitudes around it ({crs}); its own rectangle, as a polygon, where "
            "the box would be much larger."
        ).format(crs=layer.crs().authid() or tr("no CRS"))


class PolygonDialog(LayerDialog):
    """Asks for the layer of the selected polygon, or of the only one.

    Attributes
    ----------
    select : QPushButton
        Closes the dialog for a polygon of the layer to be selected on the map.
    """

    def __init__(self, parent: QWidget, active: QgsMapLayer | None) -> None:
        super().__init__(parent, tr("Area from a selected polygon"), active, POLYGON_LAYERS)
        rows = range(self.layer.count())
        ready = next((self.layer.layer(row) for row in rows if _has_polygon(self.layer.layer(row))), None)
        if ready is not None and not _has_polygon(self.chosen()):
            self.layer.setLayer(ready)

    def show_layer(self, layer: QgsVectorLayer | None) -> None:
        """Offer only layers that say which polygon; in others one can be selected."""
        super().show_layer(layer)
        if layer is None:
            self.words.setText(tr("The project has no layer of polygons: add one, or draw a box instead."))
        self.buttons.button(QDialogButtonBox.StandardButton.Ok).setEnabled(_has_polygon(layer))
        self.select.setEnabled(layer is not None)

    def _add_entries(self) -> None:
        self.select = named(
            self.buttons.addButton(tr("&Select on the map"), QDialogButtonBox.ButtonRole.ActionRole),
            "select_on_map",
            tr("Click a polygon of this layer on the map; it becomes the area"),
        )

    def _words(self, layer: QgsVectorLayer) -> str:
        count = layer.selectedFeatureCount()
        if count == 0 and _has_polygon(layer):
            return tr("It has one polygon, which is taken.")
        if count == 0:
            return tr("Nothing is selected in it: press “Select on the map”, then click one polygon.")
        return (
            tr("1 polygon is selected.") if count == 1 else tr("{n} polygons are selected.").format(n=count)
        )


def _has_polygon(layer: QgsVectorLayer | None) -> bool:
    """Whether a layer says which of its polygons is meant."""
    return layer is not None and (layer.selectedFeatureCount() > 0 or layer.featureCount() == 1)


class PointsDialog(LayerDialog):
    """Asks for a layer of points, and where their heights and yaws come from."""

    def __init__(self, parent: QWidget, active: QgsMapLayer | None, agl: float, agl_unit: str) -> None:
        self._agl, self._agl_unit = agl, agl_unit
        super().__init__(parent, tr("Points of a layer"), active, POINT_LAYERS)

    def fields(self) -> PointFields:
        """Return where heights and yaws come from."""
        m_per_unit = LENGTHS_M[self.unit.currentData()]
        return PointFields(
            self.agl.value() * m_per_unit,
            self.agl_field.currentField() if self.by_field.isChecked() else "",
            self.yaw_field.currentField(),
            m_per_unit,
        )

    def only_selected(self) -> bool:
        """Return whether features that are not selected are left out."""
        return self.selected.isChecked()

    def show_layer(self, layer: QgsVectorLayer | None) -> None:
        """Show the fields of a layer, and how many points are selected."""
        count = 0 if layer is None else layer.selectedFeatureCount()
        self.selected.setText(tr("&Selected ({n})").format(n=number_text(count)))
        self.selected.setEnabled(count > 0)
        (self.selected if count else self.all).setChecked(True)
        for fields in (self.agl_field, self.yaw_field):
            fields.setLayer(layer)
        self.by_field.setEnabled(self.agl_field.count() > 0)
        if not self.by_field.isEnabled():
            self.by_value.setChecked(True)
        super().show_layer(layer)

    def _add_entries(self) -> None:
        self.all = named(QRadioButton(tr("&All")), "all")
        self.selected = named(QRadioButton(), "selected")
        for button in (self.all, self.selected):
            button.setToolTip(tr("Features that become pictures"))
        self.form.addRow(tr("Features"), row(self.all, self.selected, stretch=1))
        self.by_value, self.by_field = (
            QRadioButton(tr("&Height of all")),
            QRadioButton(tr("Height from &field")),
        )
        self.by_value.setObjectName("by_value")
        self.by_field.setObjectName("by_field")
        self.by_value.setToolTip(tr("The same height above ground (AGL) for all points"))
        self.by_field.setToolTip(
            tr("An attribute holds each point's height above ground (AGL), in the unit below")
        )
        self.agl: NumberBox = spin(
            "agl", 0.0, _MOST_AGL, 4, "", tr("Height above the ground (AGL) in the unit below")
        )
        self.agl.setValue(self._agl)
        self.agl_field = _fields("agl_field", tr("Numbers above 0, in the unit below"))
        self.unit = combo("unit", (("m", tr("m")), ("ft", tr("ft"))), tr("Metres or international feet"))
        self.unit.setCurrentIndex(self.unit.findData(self._agl_unit))
        self.form.addRow(self.by_value, self.agl)
        self.form.addRow(self.by_field, self.agl_field)
        self.form.addRow(tr("&Unit of heights"), self.unit)
        self.yaw_field = _fields(
            "yaw_field", tr("Degrees clockwise from north; empty: the mission's own yaw")
        )
        self.yaw_field.setAllowEmptyFieldName(True)
        self.form.addRow(tr("&Yaw from field"), self.yaw_field)
        # Buttons of one parent are one choice unless they are told apart.
        for pair in ((self.all, self.selected), (self.by_value, self.by_field)):
            choice = QButtonGroup(self)
            for button in pair:
                choice.addButton(button)
        self.by_value.toggled.connect(self.agl.setEnabled)
        self.by_field.toggled.connect(self.agl_field.setEnabled)
        self.agl_field.setEnabled(False)
        self.by_value.setChecked(True)

    def _words(self, layer: QgsVectorLayer) -> str:
        return tr("One picture above each point ({crs}).").format(crs=layer.crs().authid() or tr("no CRS"))


def _fields(name: str, tip: str) -> QgsFieldComboBox:
    fields = named(QgsFieldComboBox(), name, tip)
    # Numbers may stand in fields of text.
    fields.setFilters(QgsFieldProxyModel.Filter.Numeric | QgsFieldProxyModel.Filter.String)
    return fields
