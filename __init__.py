"""TerrAInav: plan and fly a virtual UAV over real map imagery.

This folder is both the QGIS plugin and the Python package ``terrainav``. ``terrainav.core`` is the library and the
command; it needs no QGIS. ``terrainav.terrainav_plugin`` is the user interface and runs inside QGIS.
"""

from __future__ import annotations

# As `typing` has it, whose import takes longer than all of this.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from qgis.gui import QgisInterface

    from .terrainav_plugin.plugin import TerrAInavPlugin


def classFactory(iface: QgisInterface) -> TerrAInavPlugin:
    """Make the plugin; QGIS calls this when the plugin is enabled.

    Parameters
    ----------
    iface : QgisInterface
        The running application.
    """
    from .terrainav_plugin.plugin import TerrAInavPlugin

    return TerrAInavPlugin(iface)
