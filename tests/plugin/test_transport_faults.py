"""Every fault of a server, as in the tests of core, through QGIS's network stack."""

from __future__ import annotations

import pytest
from terrainav.core.imagery.client import Client
from terrainav.core.imagery.xyz import XYZSource
from terrainav.terrainav_plugin.network.transport import QgisTransport

# All of them, with their server, whatever is added there.
from tests.core.imagery.test_faults import *  # noqa: F403
from tests.core.imagery.test_faults import PLACEHOLDER, TIMEOUTS
from tests.plugin.transports import told_fixture  # noqa: F401  (holds for these as well)

pytestmark = pytest.mark.off_main


@pytest.fixture
def source_of():
    """In place of the fixture of core: the same sources over the other transport."""
    opened = []

    def make(server, tries=2, timeouts=TIMEOUTS, template=None, key=None, **options):
        client = Client(
            QgisTransport(4, timeouts),
            "The provider",
            connections=4,
            secrets=(key,) if key else (),
            tries=tries,
            first_wait_s=0.01,
            **options,
        )
        opened.append(
            XYZSource(template or server.url_template, placeholder=PLACEHOLDER, client=client, key=key)
        )
        return opened[-1]

    yield make
    for source in opened:
        source.close()
