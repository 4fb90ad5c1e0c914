"""Upload of the panel's plan to a vehicle, over MAVLink, in the background."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from qgis.PyQt.QtCore import QObject, pyqtSignal
from qgis.PyQt.QtWidgets import QInputDialog, QLineEdit, QWidget

from ..i18n import capitalized, number_text, tr, translate
from ..settings import Settings
from ..tasks import Task

if TYPE_CHECKING:
    from ...core.errors import Message
    from ...core.mission.plan import Plan
    from ..messages import Messages
    from ..planner import PlannedMission

#: Where vehicles and their simulators send to by default.
_USUAL = "udp:0.0.0.0:14550"


class VehicleTask(Task):
    """Upload a sortie.

    Attributes
    ----------
    items : int
        Number of mission items that the vehicle has accepted.
    notes : sequence of Message
        What the items do not hold.
    """

    def __init__(self, plan: Plan, address: str, sortie: int | None) -> None:
        super().__init__(tr("Sending the flight to {address}").format(address=address))
        self._plan, self.address, self._sortie = plan, address, sortie
        self.items = 0
        self.notes: tuple[Message | str, ...] = ()

    def work(self) -> None:
        """Make the items, and upload them."""
        from ...core.mission.export import plan_texts
        from ...core.mission.export.vehicle import upload, vehicle_text

        texts, notes = plan_texts(self._plan)
        self.items = upload(vehicle_text(texts, self._sortie), self.address)
        self.notes = tuple(notes)


class VehicleExport(QObject):
    """Ask for the vehicle, upload the flight, and report what it has accepted.

    Signals
    -------
    plan_wanted(object, str)
        A function to call with the plan once there is one, and a text to report if planning fails.
    """

    plan_wanted = pyqtSignal(object, str)

    def __init__(self, parent: QWidget, messages: Messages) -> None:
        super().__init__()
        self._parent, self._messages = parent, messages
        self._task: VehicleTask | None = None

    @property
    def busy(self) -> bool:
        """Whether a flight is being uploaded."""
        return self._task is not None

    def close(self) -> None:
        """Stop for good."""
        if self._task is not None:
            self._task.abandon()
            self._task = None

    def ask(self) -> None:
        """Let the user enter the vehicle's address, and upload the flight of the entered mission."""
        if self._task is not None:
            self._messages.info(tr("A flight is being sent to {address}.").format(address=self._task.address))
            return
        settings = Settings()
        address, given = QInputDialog.getText(
            self._parent.window(),
            tr("TerrAInav: export to a vehicle"),
            tr("Address: tcp:HOST:PORT, udp:HOST:PORT (waits there for the vehicle) or udpout:HOST:PORT"),
            QLineEdit.EchoMode.Normal,
            settings.vehicle or _USUAL,
        )
        address = address.strip()
        if given and address:
            settings.vehicle = address
            self.plan_wanted.emit(partial(self._send, address), tr("Nothing to export yet."))

    def _send(self, address: str, planned: PlannedMission) -> None:
        sortie, count = None, len(planned.summary.sorties_s)
        if count > 1:
            sortie, given = QInputDialog.getInt(
                self._parent.window(),
                tr("TerrAInav: export to a vehicle"),
                tr("Sortie, of {count}: a vehicle takes one").format(count=number_text(count)),
                1,
                1,
                count,
            )
            if not given:
                return
        self._task = VehicleTask(planned.plan, address, sortie)
        self._task.begin(self._ended)

    def _ended(self, task: VehicleTask) -> None:
        self._task = None
        if task.error:
            self._messages.failed(translate(task.error), task.trace)
            return
        text = tr("{address}: the vehicle has accepted {count} mission items.").format(
            address=task.address, count=number_text(task.items)
        )
        lines = [translate(note) for note in task.notes]
        said = " ".join(f"{capitalized(line)}." for line in lines)
        self._messages.success(f"{text} {said}".rstrip(), details="\n".join(lines), lasts=bool(lines))
