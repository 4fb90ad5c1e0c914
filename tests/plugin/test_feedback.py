"""What the panel answers while it works and afterwards: at once, of what is entered now, in names that people know."""

from __future__ import annotations

import threading

import pytest
from qgis.core import QgsApplication, QgsProject, QgsRasterLayer, QgsSettings
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication, QLabel, QScrollArea
from terrainav.core.errors import InvalidInput, Message
from terrainav.terrainav_plugin import planner
from terrainav.terrainav_plugin.i18n import translate
from terrainav.terrainav_plugin.tasks import Task
from terrainav.terrainav_plugin.widgets import WRONG_COLOUR

from tests.support.tileserver import TileServer


@pytest.fixture
def held(monkeypatch):
    """Holds each plan until it is let go."""
    go_on, plan = threading.Event(), planner._plan

    def slow(*arguments):
        go_on.wait(60)
        return plan(*arguments)

    monkeypatch.setattr(planner, "_plan", slow)
    yield go_on
    go_on.set()


def test_estimates_are_grey_while_they_are_those_of_what_was_entered_before(desk, held):
    held.set()
    desk.enter_small_mission()
    shown, estimates = desk.dock.estimates.text(), desk.dock.estimates
    assert estimates.isEnabled()
    held.clear()
    desk.form.agl.setValue(300.0)
    assert estimates.text() == shown
    assert not estimates.isEnabled()
    # What was entered before is planned already.
    held.set()
    desk.wait_planned()
    assert estimates.text() != shown
    assert estimates.isEnabled()


def test_capture_answers_at_once_and_is_not_begun_anew(desk, held, monkeypatch):
    held.set()
    desk.enter_coarse_mission()
    held.clear()
    asked, request = [], desk.session.planner.request
    monkeypatch.setattr(desk.session.planner, "request", lambda *given: (asked.append(given), request(*given)))
    for _ in range(2):
        desk.click(desk.dock.capture)
        assert desk.messages().count("Working out the plan…") == 1
    assert len(asked) == 1
    held.set()
    desk.wait(lambda: bool(desk.session.runs.runs))
    assert "Working out the plan…" not in desk.messages()
    desk.wait_for_run()
    assert len(desk.session.runs.runs) == 1


def test_a_failure_that_is_mended_is_no_longer_said(desk):
    with TileServer() as server:
        desk.enter_coarse_mission()
        desk.use_template(server.url_template)
        plan = desk.wait_planned().plan
        server.fail("404", (plan.zoom, int(plan.windows.left_px[0]) // 256, int(plan.windows.top_px[0]) // 256))
        desk.click(desk.dock.capture)
        desk.wait(lambda: bool(desk.session.runs.runs))
        desk.wait_for_run()
        assert any("could not be captured" in text for text in desk.messages())
        server.heal()
        desk.session.runs.capture_failed(desk.session.runs.runs[-1])
        desk.wait_for_run()
        assert not any("could not be captured" in text for text in desk.messages())
        assert any("images captured" in text or "image captured" in text for text in desk.messages())


@pytest.mark.parametrize("cancelled", [False, True])
def test_no_notice_of_qgis_covers_what_the_plugin_says_of_a_task(desk, iface, cancelled):
    class Work(Task):
        def work(self):
            started.set()
            go_on.wait(60)

    QgsSettings().setValue("minTaskLengthForSystemNotification", 0, QgsSettings.Section.App)
    started, go_on, ended = threading.Event(), threading.Event(), []
    task = Work("Capturing a-mission")

    def tell(task):
        ended.append(task)
        desk.session.messages.warning("2 of 4 images could not be captured")

    try:
        task.begin(tell)
        desk.wait(started.is_set)
        QTest.qWait(1100)
        if cancelled:
            task.cancel()
        go_on.set()
        desk.wait(lambda: bool(ended))
        QTest.qWait(50)
        assert desk.messages() == ["2 of 4 images could not be captured"]
    finally:
        go_on.set()
        QgsSettings().remove("minTaskLengthForSystemNotification", QgsSettings.Section.App)
        desk.wait_for_tasks()
    assert QgsApplication.taskManager().count() == 0


def test_layers_are_named_by_their_titles(desk):
    layer = QgsRasterLayer("type=xyz&url=http://127.0.0.1:9/{z}/{x}/{y}.png", "Aerial 2024", "wms")
    QgsProject.instance().addMapLayer(layer)
    name = f"qgis:layer/{layer.id()}"
    for error in (InvalidInput("source {0}: cannot be read", name), Message("source {0!r} is slow", name)):
        assert layer.id() not in translate(error)
        assert "“Aerial 2024”" in translate(error)
    assert "a layer that is not in the project" in translate(Message("source {0}", "qgis:layer/gone_1"))


def test_a_notice_does_not_come_back_when_a_later_one_goes(desk):
    messages, bar = desk.session.messages, desk.iface.messageBar()
    messages.warning("the first")
    messages.info("of the same event")
    desk.wait(lambda: not messages._event_over.isActive())
    messages.warning("with a way on", action=("Go on", lambda: None))
    desk.wait(lambda: not messages._event_over.isActive())
    messages.info("the last")
    # What offers something stays until it is answered.
    assert sorted(desk.messages()) == ["the last", "with a way on"]
    bar.popWidget()
    assert desk.messages() == ["with a way on"]


def test_figures_being_worked_out_look_it_and_old_problems_go_at_once(desk, held):
    figures = desk.dock.figures
    # Below what people notice.
    assert figures._soon.interval() < 200
    held.set()
    desk.enter_small_mission()
    desk.form.fov.setValue(180.0)
    assert figures.line.text() == ""
    assert figures.warnings.isVisibleTo(desk.dock)
    held.clear()
    desk.form.fov.setValue(78.0)
    # Nothing of what was entered before stands as if it were of this.
    assert not figures.warnings.isVisibleTo(desk.dock)
    assert desk.message("fov_deg") == ""
    assert "Working out" in figures.line.text()
    desk.wait(figures.mark.isVisible)
    held.set()
    desk.wait_planned()
    assert not figures.mark.isVisible()
    assert "images" in figures.line.text()
    assert figures.line.isEnabled()


@pytest.mark.parametrize(("name", "value", "number"), [("airspeed_m_per_s", -1.0, 1), ("yaw_deg", 999.0, 3)])
def test_the_link_leads_to_the_first_wrong_field(desk, name, value, number):
    desk.enter_small_mission()
    entry = next(group.entries[name] for group in desk.form.groups if name in group.entries)
    entry.setValue(value)
    desk.wait(lambda: bool(desk.message(name)))
    desk.dock.figures.warnings.linkActivated.emit("wrong")
    assert desk.form.pages.currentIndex() == number
    desk.wait(entry.isVisible)
    assert desk.dock.window().focusWidget() is entry
    bar = desk.form.pages.tabBar()
    colours = [bar.tabTextColor(at).name().upper() for at in range(bar.count())]
    assert [at for at, colour in enumerate(colours) if colour == WRONG_COLOUR] == [number]
    assert [at for at in range(bar.count()) if not bar.tabIcon(at).isNull()] == [number]


def test_the_links_beside_the_size_do_what_they_say(desk):
    desk.enter_small_mission()
    desk.choose(desk.form.source, "esri-world-imagery")
    desk.form.agl.setValue(30.0)
    desk.wait_planned()
    line = desk.dock.figures.line
    assert "of\N{NO-BREAK SPACE}640" in line.text()
    line.linkActivated.emit("source")
    assert desk.form.pages.currentIndex() == 2
    desk.wait(desk.form.source.isVisible)
    line.linkActivated.emit("higher")
    planned = desk.wait_planned()
    assert planned.summary.width_px == pytest.approx(640, rel=0.01)
    assert "of\N{NO-BREAK SPACE}640" not in line.text()
    assert "<a " not in line.text()


@pytest.mark.parametrize("theme", ["default", "Night Mapping", "Blend of Gray"])
def test_messages_are_read_whole_in_every_theme(desk, theme):
    """In the theme's colour of texts, with a mark of their own, and without a scroll bar."""
    application, usual = QApplication.instance(), QgsApplication.themeName()
    palette, sheet = application.palette(), application.styleSheet()
    QgsApplication.setUITheme(theme)
    try:
        desk.enter_small_mission()
        desk.form.edges["north"].setText("abc")
        desk.wait(lambda: bool(desk.message("north")))
        label = desk.form.findChild(QLabel, "north_message")
        desk.wait_steady(label.height)
        plain = QLabel("abc", label.parentWidget())
        plain.ensurePolished()
        assert label.palette().windowText().color() == plain.palette().windowText().color()
        assert label.grab().toImage().pixelColor(1, label.height() // 2).name().upper() == WRONG_COLOUR
        scroll = desk.dock.figures.findChild(QScrollArea)
        desk.wait(lambda: scroll.verticalScrollBar().maximum() == 0)
    finally:
        QgsApplication.setUITheme(usual)
        application.setPalette(palette)
        application.setStyleSheet(sheet)
