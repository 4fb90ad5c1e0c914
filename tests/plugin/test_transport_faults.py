"""Every fault of a server, as in the tests of core, through QGIS's network stack."""

from __future__ import annotations

import pytest
from terrainav.terrainav_plugin.network.transport import QgisTransport

# All of them, with their server, whatever is added there.
from tests.core.imagery.test_faults import *  # noqa: F403
from tests.core.imagery.test_faults import sources_over
from tests.plugin.transports import told_fixture  # noqa: F401  (holds for these as well)

pytestmark = pytest.mark.off_main


@pytest.fixture
def source_of():
    """In place of the fixture of core: the same sources over the other transport."""
    with sources_over(QgisTransport) as make:
        yield make
