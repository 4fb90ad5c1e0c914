"""Figures of a plan as text: those that decide in a line, the others folded."""

from __future__ import annotations

import html
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

from qgis.core import QgsSettings
from qgis.PyQt.QtCore import QSize, Qt, pyqtSignal
from qgis.PyQt.QtGui import QIcon, QResizeEvent
from qgis.PyQt.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QScrollArea,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from ...core.mission.estimate import percent, size_text
from ...core.mission.methods import bound_text
from ..dataset.mosaic import MOST_PICTURES
from ..i18n import capitalized, number_text, tr, translate
from ..tasks import single_shot
from ..units import METRES, area_text, duration_text, gsd_text, length_text
from ..widgets import named, tool_button

if TYPE_CHECKING:
    from ...core.imagery.policy import Policy
    from ...core.mission.estimate import Summary
    from ...core.mission.methods import ChosenMethods
    from ...core.mission.mission import Mission
    from ...core.mission.plan import Plan

_FOLDED_KEY = "TerrAInav/folded/estimates"
#: Time after which a mark moves while figures are being worked out: answers are seen as instant below 0.2 s.
_MARK_MS = 100


class Figures(QWidget):
    """The main figures in a line, which unfolds into all figures; and warnings.

    Signals
    -------
    link_followed(str)
        The user has clicked a link of the line or the warnings, to this address, one of `Link`.

    Attributes
    ----------
    line, warnings, estimates, details, problem : QLabel
    fold : QToolButton
        Button that shows and hides all figures.
    mark : QProgressBar
        Moves while figures are being worked out.
    """

    link_followed = pyqtSignal(str)

    def __init__(self) -> None:
        super().__init__()
        self.line = _label("figures")
        self.problem, self.warnings = _label("problem"), _label("warnings")
        self.estimates, self.details = _label("estimates"), _label("details")
        for label in (self.problem, self.warnings):
            label.setProperty("terrainavMark", "true")
        self.problem.setTextFormat(Qt.TextFormat.PlainText)
        for label in (self.line, self.warnings):
            label.linkActivated.connect(self.link_followed)
        tip = tr("All estimates: coverage, overlap, flight, download, methods with their error bounds, and more")
        self.fold = tool_button("fold_estimates", QIcon(), tip)
        self.fold.setAccessibleName(tr("Estimates"))
        self.fold.setCheckable(True)
        self.fold.setAutoRaise(True)
        self.fold.toggled.connect(self._fold)
        self.mark = named(QProgressBar(), "working")
        self.mark.setRange(0, 0)
        self.mark.setTextVisible(False)
        self.mark.setFixedHeight(3)
        policy = self.mark.sizePolicy()
        policy.setRetainSizeWhenHidden(True)
        self.mark.setSizePolicy(policy)
        self.mark.hide()
        self._soon = single_shot(self.mark.show, self, _MARK_MS)
        self._text = TextScroll((self.problem, self.warnings, self.estimates, self.details))
        top = QHBoxLayout()
        top.addWidget(self.fold, 0, Qt.AlignmentFlag.AlignTop)
        top.addWidget(self.line, 1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(2)
        layout.addWidget(self.mark)
        layout.addLayout(top)
        layout.addWidget(self._text)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        self.fold.setChecked(not QgsSettings().value(_FOLDED_KEY, True, type=bool))
        self._fold(self.fold.isChecked())
        self.show_text("")

    def show_readout(self, readout: Readout) -> None:
        """Show the figures of a plan."""
        self._show(
            line=readout.line_html(),
            warnings="<br>".join(html.escape(text) for text in readout.warnings),
            estimates=readout.figures_html(),
            details=readout.details_html(),
        )
        self.details.setToolTip(readout.why)

    def show_working(self, outdated: bool) -> None:
        """Show that figures are being worked out; ``outdated`` figures are greyed, and problems removed."""
        self._soon.start()
        if not outdated:
            return
        if self.estimates.text():
            for part in (self.line, self._text):
                part.setEnabled(False)
        else:
            self.show_text(tr("Working out the plan…"))
            self._soon.start()

    def show_text(self, text: str) -> None:
        """Show a text instead of figures."""
        self._show(line=html.escape(text))

    def show_reading(self, text: str) -> None:
        """Show what is read before the plan can be worked out, with a link that cancels it."""
        self._show(line=f'{html.escape(text)} <a href="{Link.CANCEL}">{html.escape(tr("Cancel"))}</a>')
        self.mark.show()

    def show_cancelled(self) -> None:
        """Show that reading was cancelled, with a link that begins it anew."""
        again = html.escape(tr("Read them"))
        self._show(
            problem=tr("The files of labels and buildings have not been read."),
            warnings=f'<a href="{Link.READ}">{again}</a>',
        )

    def show_problem(self, text: str) -> None:
        """Show why there are no figures; an empty text refers to the marked fields."""
        link = f'<a href="{Link.WRONG}">{html.escape(tr("Fix the highlighted fields."))}</a>'
        self._show(problem=text, warnings="" if text else link)

    def set_room(self, height_px: int) -> None:
        """Note the height of the panel, of which the figures take a part at most."""
        self._room_px = height_px
        self._fit()

    def _show(
        self, line: str = "", problem: str = "", warnings: str = "", estimates: str = "", details: str = ""
    ) -> None:
        for label, text in (
            (self.line, line),
            (self.problem, problem),
            (self.warnings, warnings),
            (self.estimates, estimates),
            (self.details, details),
        ):
            label.setText(text)
        for part in (self.line, self._text):
            part.setEnabled(True)
        self._soon.stop()
        self.mark.hide()
        self._fit()

    def _fold(self, shown: bool) -> None:
        self.fold.setArrowType(Qt.ArrowType.DownArrow if shown else Qt.ArrowType.RightArrow)
        QgsSettings().setValue(_FOLDED_KEY, not shown)
        self._fit()

    #: Height of the panel.
    _room_px = 0

    def _fit(self) -> None:
        """Show the labels that have a text, and those unfolded; warnings take a fifth of the panel, figures two."""
        for label in (self.line, self.problem, self.warnings):
            label.setVisible(bool(label.text()))
        for label in (self.estimates, self.details):
            label.setVisible(bool(label.text()) and self.fold.isChecked())
        self.fold.setVisible(bool(self.estimates.text()))
        self._text.setVisible(not all(label.isHidden() for label in self._text.labels))
        unfolded = not self.estimates.isHidden()
        self._text.most_px = self._room_px * (2 if unfolded else 1) // 5 if self._room_px else 0
        self._text.updateGeometry()


class Link:
    """Addresses of links: what they do."""

    WRONG, HIGHER, UPSAMPLE, SOURCE = "wrong", "higher", "upsample", "source"
    CANCEL, READ = "cancel", "read"


class TextScroll(QScrollArea):
    """Labels one below the other, as high as their text, up to a limit.

    Attributes
    ----------
    most_px : int
        Greatest height; 0 for no limit.
    """

    most_px = 0

    def __init__(self, labels: Sequence[QLabel]) -> None:
        super().__init__()
        self.labels = labels
        contents = QWidget()
        layout = QVBoxLayout(contents)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(2)
        for label in labels:
            layout.addWidget(label)
        self.setWidget(contents)
        self.setWidgetResizable(True)
        for background in (contents, self.viewport()):
            background.setAutoFillBackground(False)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)

    def sizeHint(self) -> QSize:
        """Return the size of the whole text at this width, or the limit."""
        height = self._text_height()
        return QSize(super().sizeHint().width(), min(height, self.most_px) if self.most_px else height)

    def minimumSizeHint(self) -> QSize:
        """Return the size of two lines, or of the whole text if it is shorter."""
        least = 2 * self.fontMetrics().lineSpacing()
        return QSize(super().minimumSizeHint().width(), min(least, self._text_height()))

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Update the height, as lines may break differently."""
        super().resizeEvent(event)
        if event.oldSize().width() != event.size().width():
            self.updateGeometry()

    def _text_height(self) -> int:
        layout = self.widget().layout()
        # Dark themes of QGIS give it a frame.
        frame = 2 * self.frameWidth()
        return frame + layout.totalHeightForWidth(max(self.viewport().width(), layout.minimumSize().width()))


@dataclass(frozen=True)
class Readout:
    """Texts on a plan, the most important first.

    Parameters
    ----------
    warnings : tuple of str
        Shown first.
    figures, details : tuple of (label, value)
        The main figures; the other figures.
    line : tuple of str
        The figures that decide, in short.
    why : str
        Reasons for the choice of methods, as HTML.
    links : tuple of str
        What gives images more pixels where the source is coarser than the camera, of `Link`.
    """

    warnings: tuple[str, ...]
    figures: tuple[tuple[str, str], ...]
    details: tuple[tuple[str, str], ...]
    line: tuple[str, ...] = ()
    why: str = ""
    links: tuple[str, ...] = ()

    def line_html(self) -> str:
        """The figures that decide as a line, with links."""
        titles = {Link.HIGHER: tr("fly higher"), Link.UPSAMPLE: tr("upsample"), Link.SOURCE: tr("another source")}
        # Break lines between figures only.
        parts = [html.escape(part.replace(" ", "\N{NO-BREAK SPACE}")) for part in self.line]
        links = ", ".join(f'<a href="{link}">{html.escape(titles[link])}</a>' for link in self.links)
        if links:
            # Beside the size of the images, before the time.
            parts[-2] += f" ({links})"
        return "\N{NO-BREAK SPACE}· ".join(parts)

    def figures_html(self) -> str:
        """The main figures as an HTML table."""
        return _table(self.figures)

    def details_html(self) -> str:
        """The other figures as an HTML table."""
        return _table(self.details)


def readout(
    plan: Plan,
    summary: Summary,
    unit: str = "m",
    cost: str = "",
    policy: Policy | None = None,
    others: Mapping[str, tuple[int, Policy | None]] = MappingProxyType({}),
) -> Readout:
    """Figures of a plan.

    Parameters
    ----------
    unit : str
        m or ft, for lengths and areas.
    cost : str
        Text on the timing of the methods; empty if unknown.
    policy : Policy or None
        Policy of the source's provider, if any.
    others : mapping of str to (int, Policy or None)
        Number of requests and policy of each further imagery, by its name.
    """
    imageries = 1 + len(others)
    limits = _limit(plan.requests * len(plan.mission.imagery.map_types), policy)
    for name, (requests, own) in others.items():
        limits += [(f"{label}, {name}", text) for label, text in _limit(requests, own)]
    mission, grid, own_m = plan.mission, plan.grid, plan.resolution.source_m_per_px
    # A source that is at most 2 % coarser than requested counts as fine enough.
    coarser = own_m > 1.02 * summary.requested_gsd_m_per_px
    upsampleable = grid.max_zoom > grid.native_zoom and not mission.pixels.upsample
    can_upsample = upsampleable and mission.pixels.zoom is None and mission.pixels.gsd_m_per_px is None
    links = (Link.HIGHER, *((Link.UPSAMPLE,) if can_upsample else ()), Link.SOURCE) if coarser else ()
    return Readout(
        tuple(translate(text) for text in summary.warnings),
        (*_figures(plan, summary, unit, own_m if coarser else None, imageries), *limits),
        tuple(_details(mission, summary, cost)),
        _line(plan, summary, unit, own_m if coarser else None, imageries),
        _why_html(plan.accuracy),
        links if coarser and not mission.pixels.upsample else (),
    )


def _line(plan: Plan, summary: Summary, unit: str, coarser_m: float | None, imageries: int) -> tuple[str, ...]:
    images = tr("1 image") if summary.images == 1 else tr("{n} images").format(n=number_text(summary.images))
    if imageries > 1:
        images = tr("{images} of {count} imageries").format(images=images, count=number_text(imageries))
    covered = summary.covered_share
    # Round down, so that incomplete coverage is never shown as 100 %.
    share = 100.0 if summary.complete or covered is None else int(covered * 1e4) / 1e2
    return (
        images,
        *(() if covered is None else (tr("{share} % covered").format(share=number_text(share, "g")),)),
        tr("GSD {size}").format(size=gsd_text(summary.delivered_gsd_m_per_px, unit)),
        _size(plan.mission, summary, unit, coarser_m),
        tr("{duration} to capture").format(duration=duration_text(summary.seconds + _mosaic_s(plan, summary))),
    )


def _size(mission: Mission, summary: Summary, unit: str, coarser_m: float | None) -> str:
    """Size of the images, and of the camera's where the source is coarser."""
    size = tr("{width} × {height} px").format(
        width=number_text(summary.width_px), height=number_text(summary.height_px)
    )
    if mission.output.img_size is not None:
        width, height = mission.output.img_size[:2]
        whole = tr("{width} × {height} px, resized from {size}")
        return whole.format(width=number_text(width), height=number_text(height), size=size)
    if coarser_m is None or mission.pixels.upsample:
        return size
    longer, ratio = mission.pixels.image_px, mission.camera.aspect_ratio
    wide, high = (longer, round(longer / ratio)) if ratio >= 1.0 else (round(longer * ratio), longer)
    return tr("{size} of {width} × {height}: the source has {gsd}").format(
        size=size, width=number_text(wide), height=number_text(high), gsd=gsd_text(coarser_m, unit)
    )


def _label(name: str) -> QLabel:
    label = named(QLabel(), name)
    label.setWordWrap(True)
    label.setTextFormat(Qt.TextFormat.RichText)
    label.setTextInteractionFlags(
        Qt.TextInteractionFlag.TextSelectableByMouse
        | Qt.TextInteractionFlag.LinksAccessibleByMouse
        | Qt.TextInteractionFlag.LinksAccessibleByKeyboard
    )
    return label


def _figures(plan: Plan, summary: Summary, unit: str, coarser_m: float | None, imageries: int) -> list[tuple[str, str]]:
    mission = plan.mission
    lines = [(tr("Images"), _images(summary, imageries))]
    if summary.images_over_no_fly:
        lost = tr("Images left out: {count}").format(count=number_text(summary.images_over_no_fly))
        if summary.no_fly_m2:
            lost = tr("{lost}; {held} of the area").format(lost=lost, held=area_text(summary.no_fly_m2, unit))
        lines.append((tr("No-fly areas"), lost))
    if summary.covered_share is not None:
        lines.append((tr("Coverage"), _coverage(summary, unit)))
    if summary.imagery_share is not None and summary.imagery_share < 1.0:
        share = tr("The source covers {share} of the area")
        lines.append((tr("Imagery"), share.format(share=translate(percent(summary.imagery_share, exact=False)))))
    if _is_overlapping(mission):
        lines += _overlap(summary)
    lines.append((tr("GSD"), _gsd(summary, unit, coarser_m)))
    lines += _relief(summary, unit)
    flight = tr("{distance}, {duration}").format(
        distance=length_text(summary.flight_distance_m, unit), duration=duration_text(summary.flight_s)
    )
    if summary.path_m is not None and summary.path_s is not None:
        # Pilots need the length of the whole path, not only of the part between images.
        flight = tr("{distance}, {duration} with turns").format(
            distance=length_text(summary.path_m, unit), duration=duration_text(summary.path_s)
        )
    lines += [
        (tr("Flight"), flight),
        *((capitalized(translate(label)), translate(text)) for label, text in summary.piloting()),
        (tr("Download"), _download(summary)),
        (tr("Time"), _time(plan, summary)),
    ]
    return lines


def _relief(summary: Summary, unit: str) -> list[tuple[str, str]]:
    """Relief below the flight; empty over level ground."""
    lowest, highest, clearance = summary.lowest_ground_m, summary.highest_ground_m, summary.clearance_m
    finest, coarsest = summary.finest_gsd_m_per_px, summary.coarsest_gsd_m_per_px
    if lowest is None or highest is None or clearance is None or finest is None or coarsest is None:
        return []
    ground = tr("Ground from {lowest} to {highest}, images at least {clearance} clear").format(
        lowest=length_text(lowest, unit),
        highest=length_text(highest, unit),
        clearance=length_text(clearance, unit),
    )
    pixels = tr("GSD {finest} at the highest point, {coarsest} at the lowest").format(
        finest=gsd_text(finest, unit), coarsest=gsd_text(coarsest, unit)
    )
    return [(tr("Relief"), f"{ground}; {pixels}")]


def _limit(requests: int, policy: Policy | None) -> list[tuple[str, str]]:
    """Number of requests and the provider's limit; empty without a limit."""
    if policy is None or policy.max_tiles is None or policy.bulk_allowed == "yes":
        return []
    if not policy.stops(requests):
        text = tr("{count} of the {most} requests that the provider allows")
    elif policy.bulk_allowed == "ask":
        text = tr("{count} requests. Over {most} requests require accepting the terms: Capture asks you to.")
    else:
        text = tr(
            "{count} requests, but the provider allows {most}: choose a smaller area, a coarser GSD or another source"
        )
    return [(tr("Limit"), text.format(count=number_text(requests), most=number_text(policy.max_tiles)))]


def _details(mission: Mission, summary: Summary, cost: str) -> list[tuple[str, str]]:
    return [
        (tr("Image"), _picture(summary)),
        *([] if _is_overlapping(mission) else _overlap(summary)),
        (tr("Tiles"), _tiles(summary)),
        (tr("On disk"), translate(size_text(summary.output_bytes))),
        *_accuracy_lines(summary.accuracy),
        (tr("Cost"), translate(cost) or tr("Measuring…")),
    ]


def _accuracy_lines(accuracy: ChosenMethods) -> list[tuple[str, str]]:
    """The chosen methods, with the bounds of their errors."""
    methods = "; ".join(
        tr("{stage}: {name}, ≤ {px} px").format(
            stage=translate(choice.method.stage),
            name=choice.method.name,
            px=translate(bound_text(choice.method.bound_px)),
        )
        for choice in accuracy.choices
    )
    terrain = translate(accuracy.terrain_text())
    return [
        (tr("Methods"), _unbroken(methods)),
        (
            tr("Error"),
            tr("≤ {bound} px of a budget of {budget} px").format(
                bound=translate(bound_text(accuracy.bound_px)), budget=number_text(accuracy.budget_px, "g")
            )
            + ("" if accuracy.bound_px <= accuracy.budget_px else tr(", which is exceeded")),
        ),
        (tr("Left out"), ", ".join(translate(what) for what, _ in accuracy.left_out) or tr("Nothing")),
        (tr("Terrain"), _unbroken(terrain)),
    ]


def _unbroken(text: str) -> str:
    """Text with no-break spaces between signs, numbers and units."""
    return text.replace("≤ ", "≤\N{NO-BREAK SPACE}").replace(" px", "\N{NO-BREAK SPACE}px")


def _why_html(accuracy: ChosenMethods) -> str:
    """Reasons for the choice of methods, as an HTML table for a tooltip."""
    lines = []
    for choice in accuracy.choices:
        method, rejected = choice.method, choice.rejected
        text = tr("{name}, ≤ {px} px, {metres} on the ground").format(
            name=method.name, px=translate(bound_text(method.bound_px)), metres=_ground_text(method.bound_m)
        )
        if rejected is not None:
            text += tr("; not {name}: {reason}").format(name=rejected.name, reason=translate(choice.reason))
        lines.append((translate(method.stage).capitalize(), text))
    lines += [(tr("No {what}").format(what=translate(what)), translate(why)) for what, why in accuracy.left_out]
    lines.append((tr("Condition number"), translate(accuracy.condition_text())))
    return _table(lines)


def _ground_text(bound_m: float) -> str:
    return f"≤ {length_text(bound_m, METRES)}" if math.isfinite(bound_m) else tr("unlimited at the horizon")


def _table(lines: Iterable[tuple[str, str]]) -> str:
    rows = (
        f'<tr><td style="padding-right:10px">{html.escape(label)}</td><td><b>{html.escape(value)}</b></td></tr>'
        for label, value in lines
    )
    return f'<table cellspacing="1">{"".join(rows)}</table>'


def _images(summary: Summary, imageries: int) -> str:
    rows = tr("{images} in {rows} rows") if summary.rows != 1 else tr("{images} in one row")
    text = rows.format(images=number_text(summary.images), rows=number_text(summary.rows))
    if imageries > 1:
        return tr("{text}, for each of {count} imageries").format(text=text, count=imageries)
    types = len(summary.map_types)
    return text if types == 1 else tr("{text}, for each of {count} map types").format(text=text, count=types)


def _picture(summary: Summary) -> str:
    width, height = number_text(summary.width_px), number_text(summary.height_px)
    if summary.own_pixels:
        pixels = translate(summary.own_pixels)
        return tr("{width} × {height} px: {pixels}").format(width=width, height=height, pixels=pixels)
    return tr("{width} × {height} px at zoom {zoom}").format(width=width, height=height, zoom=summary.zoom)


def _gsd(summary: Summary, unit: str, coarser_m: float | None) -> str:
    """Ground sample distances; with a hint if the source is coarser, at ``coarser_m``."""
    requested, delivered = (
        gsd_text(value_m, unit) for value_m in (summary.requested_gsd_m_per_px, summary.delivered_gsd_m_per_px)
    )
    text = tr("Requested {requested}, delivered {delivered}").format(requested=requested, delivered=delivered)
    if coarser_m is None:
        return text
    hint = tr("the source's GSD is {source}: images show no finer detail")
    return f"{text} ({hint.format(source=gsd_text(coarser_m, unit))})"


def _coverage(summary: Summary, unit: str) -> str:
    text = _held(summary, unit)
    if not summary.hidden_share:
        return text
    share = number_text(100.0 * summary.hidden_share, ".1f")
    return tr("{text}; relief hides about {share} %").format(text=text, share=share)


def _held(summary: Summary, unit: str) -> str:
    no_fly_m2 = summary.no_fly_m2 or 0.0
    area = area_text(summary.area_m2 - no_fly_m2, unit)
    if no_fly_m2:
        area = tr("{area} outside no-fly areas").format(area=area)
    if summary.complete:
        text = (
            tr("100 % of {area}, except where imagery is missing") if summary.lacks_imagery else tr("100 % of {area}")
        )
        return text.format(area=area)
    # Round down, so that incomplete coverage is never shown as 100 %.
    share = int(summary.covered_share * 1e4) / 1e2
    return tr("{share} % of {area}; {uncovered} not covered").format(
        share=number_text(share, ".2f"), area=area, uncovered=area_text(summary.uncovered_m2, unit)
    )


def _is_overlapping(mission: Mission) -> bool:
    """Whether an overlap is requested; the overlap reached is then one of the main figures."""
    return mission.flight.overlap_along > 0.0 or mission.flight.overlap_across > 0.0


def _overlap(summary: Summary) -> list[tuple[str, str]]:
    """Text on the overlap reached; empty for points."""
    parts = []
    for text, least in (
        (tr("front {share}"), summary.least_overlap_along),
        (tr("side {share}"), summary.least_overlap_across),
    ):
        if least is not None:
            parts.append(text.format(share=number_text(100.0 * least, ".1f") + " %"))
    return [(tr("Overlap"), tr("At least {shares}").format(shares=", ".join(parts)))] if parts else []


def _tiles(summary: Summary) -> str:
    """Number of tiles of all map types together."""
    return tr("{count}, each fetched once").format(count=number_text(summary.unique_tiles * len(summary.map_types)))


def _time(plan: Plan, summary: Summary) -> str:
    """Times of the capture, and of the mosaic, which may take longer."""
    mosaic_s = _mosaic_s(plan, summary)
    text = tr("About {duration}, then {mosaic} for the mosaic") if mosaic_s >= 1.0 else tr("About {duration}")
    return text.format(duration=duration_text(summary.seconds), mosaic=duration_text(mosaic_s))


def _mosaic_s(plan: Plan, summary: Summary) -> float:
    return summary.mosaic_s if len(plan) <= MOST_PICTURES else 0.0


def _download(summary: Summary) -> str:
    count = number_text(summary.unique_tiles * len(summary.map_types))
    if summary.pixels_from == "file" or not summary.download_bytes:
        return tr("No download ({count} local tiles)").format(count=count)
    size = translate(size_text(summary.download_bytes))
    return tr("About {size} in {count} tiles").format(size=size, count=count)
