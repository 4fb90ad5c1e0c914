"""Random values of images in the panel."""

from __future__ import annotations

from qgis.PyQt.QtWidgets import QLineEdit


def test_random_values_are_entered_as_the_command_takes_them(desk):
    line = desk.dock.findChild(QLineEdit, "vary")
    texts = ("agl_m=uniform(90,150)", "yaw_deg=normal(0,3)within(-9,9)")
    for written in (" ".join(texts), ", ".join(texts), "agl_m=uniform(90, 150), yaw_deg=normal(0,3)within( -9,9 )"):
        line.setText(written)
        assert tuple(one.replace(" ", "") for one in line.words()) == texts
    line.enter(texts)
    assert desk.session.state().vary == texts
